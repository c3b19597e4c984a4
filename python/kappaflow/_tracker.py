"""The surface of particles, followed from one instant to the next."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kappaflow import _core, _inputs
from kappaflow._field import VelocityMethod, all_as_core
from kappaflow._meshes import Mesh, mesh_of
from kappaflow.errors import InvalidInput


class Tracker:
    """Follows the surface of particles through time, with one velocity method or with several side by side.

    positions: (n, 3) [m]. velocities: (n, 3) [m/s]. ids: (n,) whole numbers that say which particle is which at the next
    instant, in any order; without them row i is particle i at every instant. Particles may come and go.
    Without velocities (and ids) the particles are a point cloud: the surface follows the change of its field, and may move by
    0.1 sigma from one instant to the next at most (docs/track.md). time: [s].
    sources: (n,) whole numbers, which block or tap a particle comes from; vertices take that of the nearest.
    scales: (n,) how large each particle is beside those that sigma is meant for, > 0.
    next: the arguments of the advance() that follows, as a dict, where they are known: the rates of the first frame of a point
    cloud come from it. The mesh does not depend on it.

    methods: a velocity method, or several for as many surfaces: names of velocity_methods() or functions (see
    VelocityFunction), or `fresh-nearest`, `fresh-particles` and `fresh-grid`, which do not track; `material`, or `regional` for a
    point cloud, unless given.
    anchor: "particles" gives the vertices of tracked surfaces, at every instant, the rest position that the particles around
    have by their first ones: no drift, whatever the method; it takes ids or rows that stay. "none": as carried along.
    sigma, threshold, weights, kernels: as for Field. edge_length: of the mesh where it is flat, in units of sigma.
    remesh, topology: whether the mesh's connectivity and its topology follow the surface.
    motion_per_step: the fast particles move by this at most in one step, in units of sigma; np.inf: a step an instant.
    damping, speed_limit: of the velocity methods, see VelocityOptions.

    Raises InvalidInput for arrays and options that are not sound, and where the surface is empty. After an exception of
    advance() the tracker can go no further. Different trackers may work in different threads; one is for one at a time."""

    def __init__(self, positions: ArrayLike, velocities: ArrayLike | None = None, ids: ArrayLike | None = None, *,
                 time: float = 0, sources: ArrayLike | None = None, scales: ArrayLike | None = None,
                 next: Mapping[str, Any] | None = None,
                 methods: VelocityMethod | Sequence[VelocityMethod] | None = None, anchor: str = "none",
                 sigma: float | None = None, threshold: float | None = None, weights: str = "uniform",
                 kernels: str = "round", edge_length: float = 0.5,
                 remesh: bool = True, topology: bool = True, motion_per_step: float = 1.0, damping: float = 0.1,
                 speed_limit: float = 1) -> None:
        self._is_cloud = velocities is None
        self._new_ids = 0
        self._methods = all_as_core(methods)  # kept here: the handle does not
        options = _core.surface_choices(
            _core.field_choices(sigma, threshold, weights, kernels), self._methods, anchor, self._is_cloud, edge_length, remesh,
            topology, motion_per_step, _core.VelocityOptions(damping, speed_limit))
        first, source = self._particles(positions, velocities, ids, time=time, sources=sources, scales=scales)
        second = None if next is None else self._particles(**next)[0]
        self._handle = _core.TrackerHandle(first, second, options)
        self._find_sources(source)

    def advance(self, positions: ArrayLike, velocities: ArrayLike | None = None, ids: ArrayLike | None = None, *, time: float,
                sources: ArrayLike | None = None, scales: ArrayLike | None = None) -> None:
        """Goes to the next instant, in as many steps as motion_per_step asks for. Arrays as at the start; time: [s], later.

        Raises InvalidInput for arrays that are not sound, a time that is not later, and a point cloud that moves too far;
        TopologyError; and what the velocity methods raise."""
        particles, source = self._particles(positions, velocities, ids, time=time, sources=sources, scales=scales)
        self._handle.advance(particles, self._is_cloud)
        self._find_sources(source)

    def mesh(self, surface: int = 0) -> Mesh:
        """A surface now, with all its arrays: a copy, which stays as it is. surface: counts the methods from 0."""
        return mesh_of(self.time, self._handle.surface(self._checked(surface)))

    def add_array(self, name: str, fresh: ArrayLike, carry: str = "interpolate") -> None:
        """Registers an array over the vertices of all surfaces, which the edits of their meshes carry along.

        fresh: a number, a whole number or 3 numbers: the start, and what vertices get that come with a new piece.
        carry: what a new vertex gets: "interpolate", a blend of those around it; "nearest", the entry of the nearest (for
        whole numbers); "recompute", `fresh`, until set_array(). Raises InvalidInput for a name that is taken."""
        value = np.asarray(fresh)
        if value.shape == (3,):
            self._handle.add_vectors(name, value.astype(float).tolist(), carry)
        elif value.shape == () and value.dtype.kind in "iu":
            self._handle.add_integers(name, int(value), carry)
        elif value.shape == () and value.dtype.kind == "f":
            self._handle.add_numbers(name, float(value), carry)
        else:
            raise InvalidInput(f"array '{name}': {fresh!r}; a number or 3 numbers are needed")

    def set_array(self, name: str, values: ArrayLike, surface: int = 0) -> None:
        """Fills an array that add_array() has registered: one entry a vertex of the surface, whose mesh() has them."""
        array = np.asarray(values)
        surface = self._checked(surface)
        if array.ndim == 2:
            self._handle.set_vectors(name, _inputs.vectors(name, array), surface)
        elif array.dtype.kind in "iu":
            self._handle.set_integers(name, _inputs.integers(name, array), surface)
        else:
            self._handle.set_numbers(name, _inputs.numbers(name, array), surface)

    def take_report(self) -> list[dict[str, float]]:
        """What happened since the last call, an entry a surface: vertices that are `unprojected`, the largest
        `residual_max` [sigma], `regions_replaced` and `regions_refused` by changes of topology, `splits`, `collapses` and
        `flips` of edges."""
        return self._handle.take_report()

    @property
    def time(self) -> float:
        """[s]"""
        return self._handle.time

    @property
    def sigma(self) -> float:
        """Support radius of Eq. 12 [m]."""
        return self._handle.sigma

    @property
    def threshold(self) -> float:
        """T of Eq. 12 [1]."""
        return self._handle.threshold

    def __len__(self) -> int:
        """How many surfaces there are."""
        return self._handle.surfaces

    def _particles(self, positions: ArrayLike, velocities: ArrayLike | None = None, ids: ArrayLike | None = None,
                   **others: Any) -> tuple[_core.Particles, NDArray[np.int32] | None]:
        if (velocities is None) != self._is_cloud:
            raise InvalidInput("velocities: they are given at some instants and not at others")
        if self._is_cloud:
            if ids is not None:
                raise InvalidInput("ids: they need velocities, at least differences of positions")
            count = len(_inputs.vectors("positions", positions))
            ids = np.arange(self._new_ids, self._new_ids + count)  # they pair no particle with itself
            self._new_ids += count
        return _inputs.particles(positions, velocities, ids, **others)

    def _find_sources(self, source: NDArray[np.int32] | None) -> None:
        if source is not None:
            self._handle.find_sources(source)

    def _checked(self, surface: int) -> int:
        if not 0 <= surface < len(self):
            raise InvalidInput(f"surface {surface}: there are {len(self)}, from 0")
        return surface
