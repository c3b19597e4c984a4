"""A scene in motion."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from kappaflow import _core
from kappaflow._meshes import Mesh, Particles, mesh_of
from kappaflow.errors import InvalidInput


class Simulation:
    """Liquid, and on it one tracked surface for each velocity method: what simulate() returns.

    Raises SolverFailure where the liquid fails; particles() then shows where, and nothing goes on."""

    def __init__(self, handle: _core.SimulationHandle) -> None:
        self._handle = handle

    def frames(self) -> Iterator[int]:
        """The numbers of the frames, from the one that is reached to the last; advances to each before it yields it."""
        yield self.frame
        while not self.done:
            self.advance()
            yield self.frame

    def advance(self) -> None:
        """Goes to the next frame, where particles and surfaces are those of `kappaflow run`, to the bit. Ctrl-C ends it
        after the current step; the next call goes on. Raises InvalidInput at the scene's end."""
        self._handle.advance()

    def step(self) -> _core.FluidStep:
        """One time step of the liquid towards the next frame; where it arrives, `frame` is one more, and the bits are those
        of advance(). On the way surfaces may lag behind. Raises InvalidInput at the scene's end."""
        return self._handle.step()

    def particles(self) -> Particles:
        """Of the liquid now, by ascending id."""
        time, arrays = self.time, self._handle.particles()
        return Particles(time, arrays.pop("positions"), arrays)

    def mesh(self, method: str | None = None) -> Mesh:
        """The surface of a velocity method, the first one's unless given; mesh.time is when."""
        methods = self.methods
        method = methods[0] if method is None else method
        if method not in methods:
            raise InvalidInput(f"no surface moves by '{method}'; there are {', '.join(methods)}")
        return mesh_of(self._handle.surface_time, self._handle.surface(methods.index(method)))

    def walls(self) -> list[tuple[NDArray[np.float64], NDArray[np.int32]]]:
        """Vertices (n, 3) [m] and triangles (m, 3) of each wall, then of each rigid body, where it is now."""
        return self._handle.walls()

    @property
    def methods(self) -> list[str]:
        """Velocity methods, one a surface."""
        return self._handle.methods

    @property
    def title(self) -> str:
        """Of the scene."""
        return self._handle.title

    @property
    def time(self) -> float:
        """That the liquid has reached [s]."""
        return self._handle.time

    @property
    def frame(self) -> int:
        """The last one that was reached, from 0."""
        return self._handle.frame

    @property
    def last_frame(self) -> int:
        """The one at the scene's end."""
        return self._handle.last_frame

    @property
    def done(self) -> bool:
        """Whether the scene's end is reached."""
        return self.frame == self.last_frame

    @property
    def sigma(self) -> float:
        """Support radius of Eq. 12 [m]."""
        return self._handle.sigma

    @property
    def threshold(self) -> float:
        """T of Eq. 12 [1]."""
        return self._handle.threshold


def simulate(scene: str | os.PathLike[str], *, methods: Sequence[str] | None = None,
             duration: float | None = None) -> Simulation:
    """Makes a scene ready, at t = 0.

    scene: a file (docs/scene-files.md), or the text of one; meshes that a text names lie in the working folder.
    methods: velocity methods in place of the scene's. duration: in its place [s].

    Raises InvalidInput for a mistake in the scene, with file, line, column and what is allowed."""
    text = scene if isinstance(scene, str) and "\n" in scene else None
    file = "scene.toml" if text else os.fspath(scene)
    names = None if methods is None else [methods] if isinstance(methods, str) else list(methods)
    return Simulation(_core.SimulationHandle(file, text, names, duration))
