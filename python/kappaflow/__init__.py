"""Viscous SPH liquids, and their surface as one mesh that moves along: kappaflow from Python.

Tracker follows the surface of particles of one's own; Field is the implicit surface at one instant; simulate() runs a scene;
read_run() reads what `kappaflow run` or `kappaflow track` wrote. Units are SI. docs/python.md has worked examples."""

from kappaflow import errors
from kappaflow._core import FluidStep, SurfacePoints, VelocityOptions
from kappaflow._core import set_threads as _set_threads
from kappaflow._core import velocity_methods
from kappaflow._core import version as __version__
from kappaflow._field import Curvatures, Field, Jets, Projected, SurfaceField, Velocities, VelocityFunction, VelocityMethod
from kappaflow._meshes import Mesh, Particles, Points
from kappaflow._run import Run, read_run
from kappaflow._simulation import Simulation, simulate
from kappaflow._texture import checker_colours, texture_coordinates
from kappaflow._tracker import Tracker
from kappaflow.errors import Error, InvalidInput, IoError, SolverFailure, TopologyError


def set_threads(count: int | None) -> None:
    """How many threads work, from now on; None: one a core. Results are the same bits for any number of them."""
    if count is not None and count < 1:
        raise InvalidInput(f"threads: {count}; at least 1 is needed")
    _set_threads(count or 0)


__all__ = [
    "Curvatures", "Error", "Field", "FluidStep", "InvalidInput", "IoError", "Jets", "Mesh", "Particles", "Points", "Projected",
    "Run", "Simulation", "SolverFailure", "SurfaceField", "SurfacePoints", "TopologyError", "Tracker", "Velocities",
    "VelocityFunction", "VelocityMethod", "VelocityOptions", "checker_colours", "errors", "read_run", "set_threads", "simulate",
    "texture_coordinates", "velocity_methods",
]
