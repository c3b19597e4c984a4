"""Frames: what there is at one instant."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from kappaflow.errors import InvalidInput

Arrays = dict[str, NDArray[np.generic]]


@dataclass(frozen=True, eq=False)
class Points:
    """Points with arrays: `points["velocity"]` is `points.arrays["velocity"]`."""

    time: float
    """[s]"""
    positions: NDArray[np.float64]
    """(n, 3) [m]"""
    arrays: Arrays = field(repr=False)
    """One entry a point, by the names that docs/outputs.md explains."""

    def __getitem__(self, name: str) -> NDArray[np.generic]:
        """The array of that name. Raises InvalidInput where there is none."""
        if name not in self.arrays:
            raise InvalidInput(f"no array '{name}'; there are {', '.join(self.arrays)}")
        return self.arrays[name]

    def __len__(self) -> int:
        """How many points there are."""
        return len(self.positions)


@dataclass(frozen=True, eq=False)
class Particles(Points):
    """Particles: `id`, `velocity` [m/s] and, where known, `density` [kg/m3], `pressure` [Pa], `source`."""


@dataclass(frozen=True, eq=False)
class Mesh(Points):
    """A surface: its vertices with their arrays, and triangles.

    The arrays have the names of surface files (docs/outputs.md): `Normals`, `velocity` [m/s], `confidence`,
    `mean_curvature` [1/m], `gaussian_curvature` [1/m2], `rest_position` [m], `id`, `source`, `material_slip` [m/s],
    `unprojected`, those that were added, and of a scene with a `rest_interval` `rest_1`, `rest_2` and `rest_2_weight`. From
    a Tracker or a Simulation they are in double precision, and `area` [m2] and `material_velocity` [m/s] are there too;
    from files most are in single precision, and `TCoords` and `checker` are there too."""

    triangles: NDArray[np.generic]
    """(m, 3) vertices, counter-clockwise seen from outside"""


def mesh_of(time: float, arrays: Arrays) -> Mesh:
    """positions and triangles are among the arrays, and are taken out."""
    positions, triangles = arrays.pop("positions"), arrays.pop("triangles")
    return Mesh(time, positions.astype(np.float64, copy=False), arrays, triangles)
