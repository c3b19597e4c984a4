"""The implicit surface at one instant (Eq. 12), at points of one's own."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kappaflow import _core, _inputs
from kappaflow.errors import InvalidInput

Floats = NDArray[np.float64]


class Jets(NamedTuple):
    """f and its derivatives at n points; f > 0 inside, so the outward normal is -g/|g|."""

    f: Floats
    """(n,) the value, threshold subtracted [1]"""
    g: Floats
    """(n, 3) gradient [1/m]"""
    A: Floats
    """(n, 3, 3) Hessian [1/m2]"""
    C: Floats
    """(n, 3, 3, 3) third derivatives [1/m3]"""
    f_t: Floats
    """(n,) time derivative at a fixed point [1/s]"""
    g_t: Floats
    """(n, 3) of the gradient [1/(m s)]"""
    A_t: Floats
    """(n, 3, 3) of the Hessian [1/(m2 s)]"""
    length_scale: Floats
    """(n,) sigma, averaged over what is in reach [m]; 0: nothing is"""
    fastest_in_reach: Floats
    """(n,) largest speed of what makes the field here [m/s]"""


class Curvatures(NamedTuple):
    """Of the level sets through n points; nan where f has no gradient. H > 0 on a sphere."""

    K: Floats
    """(n,) Gaussian curvature [1/m2]"""
    H: Floats
    """(n,) mean curvature [1/m]"""
    grad_K: Floats
    """(n, 3) [1/m3]"""
    grad_H: Floats
    """(n, 3) [1/m2]"""
    K_t: Floats
    """(n,) time derivative at a fixed point [1/(m2 s)]"""
    H_t: Floats
    """(n,) [1/(m s)]"""


class Velocities(NamedTuple):
    """How fast n points of the surface move."""

    velocity: Floats
    """(n, 3) [m/s]; zero where the field has no gradient"""
    confidence: Floats
    """(n,) how well the tangential part is determined, 0 to 1"""


class Projected(NamedTuple):
    """n points, moved onto f = 0."""

    positions: Floats
    """(n, 3) on the surface where it converged, else where they were [m]"""
    gradients: Floats
    """(n, 3) there [1/m]"""
    residuals: Floats
    """(n,) |f|/|g| there over the smallest sigma [1]"""
    converged: NDArray[np.bool_]
    """(n,)"""


VelocityFunction = Callable[["SurfaceField", _core.SurfacePoints, _core.VelocityOptions], tuple[ArrayLike, ArrayLike]]
"""A velocity method of one's own, velocity (n, 3), confidence (n,) = method(field, points, options).

It is called once for all points at every stage of a time step, must be a function of its arguments alone, and may keep no
`field` beyond the call. `velocity` [m/s] is to have the normal part of Eq. 4, v_n = -f_t g/|g|^2; `confidence` says how well
the rest is determined, 0 to 1. What it raises ends the step."""

VelocityMethod = Union[str, VelocityFunction]
"""The name of one of velocity_methods(), or a function."""


def as_core(method: VelocityMethod) -> str | Callable[..., tuple[Floats, Floats]]:
    """What the compiled half takes."""
    if isinstance(method, str):
        return method
    if not callable(method):
        raise InvalidInput(f"{method!r} is no velocity method; it takes a name or a function")
    function = method

    def call(handle: _core.FieldHandle, points: _core.SurfacePoints, options: _core.VelocityOptions) -> tuple[Floats, Floats]:
        answer = function(SurfaceField(handle), points, options)
        if not (isinstance(answer, tuple) and len(answer) == 2):
            raise InvalidInput(f"the velocity method {_name_of(function)} returned {type(answer).__name__}; "
                               "velocity, confidence is needed")
        count = len(points.positions)
        return _inputs.vectors("velocity", answer[0], count), _inputs.numbers("confidence", answer[1], count)

    return call


def _name_of(function: VelocityFunction) -> str:
    return getattr(function, "__name__", type(function).__name__)


def all_as_core(methods: VelocityMethod | Sequence[VelocityMethod] | None) -> list[str | Callable[..., tuple[Floats, Floats]]]:
    if methods is None:
        return []
    if isinstance(methods, str) or callable(methods):
        methods = [methods]
    return [as_core(method) for method in methods]


class SurfaceField:
    """An implicit surface f(x) = 0 at one instant, f > 0 inside: a Field, or what a velocity method is given.

    All functions take points as an (n, 3) array [m], run in parallel and without the interpreter's lock; results do not
    depend on the number of threads. They raise InvalidInput for arrays of another shape."""

    def __init__(self, handle: _core.FieldHandle) -> None:
        self._handle = handle

    @property
    def time(self) -> float:
        """[s]"""
        return self._handle.time

    @property
    def length_scale(self) -> float:
        """The smallest length on which the field varies: the smallest sigma [m]."""
        return self._handle.length_scale

    def values(self, points: ArrayLike) -> Floats:
        """(n,) f, the threshold subtracted [1]."""
        return self._handle.values(_inputs.vectors("points", points))

    def jets(self, points: ArrayLike) -> Jets:
        """f with all its derivatives up to the third, and their rates."""
        return Jets(*self._handle.jets(_inputs.vectors("points", points)))

    def curvatures(self, points: ArrayLike) -> Curvatures:
        """K = g^T adj(A) g/|g|^4, H = -(tr(A) |g|^2 - g^T A g)/(2 |g|^3), with gradients and rates."""
        return Curvatures(*self._handle.curvatures(_inputs.vectors("points", points)))

    def material_velocities(self, points: ArrayLike) -> Floats:
        """(n, 3) velocity of the liquid [m/s], by affine moving least squares of the particles'; nan where it is unknown."""
        return self._handle.material_velocities(_inputs.vectors("points", points))

    def velocities(self, points: ArrayLike | _core.SurfacePoints, method: VelocityMethod = "curvature", *,
                   triangles: ArrayLike | None = None, damping: float = 0.1, speed_limit: float = 1) -> Velocities:
        """How fast the surface moves at points on it, by one of velocity_methods() or a function.

        triangles: (m, 3) of the points, for methods with a neighbourhood (`regional`); without them every point is alone.
        points: also what a velocity method was given. damping, speed_limit: see VelocityOptions.

        Raises InvalidInput for an unknown method, and what a function raises."""
        if not isinstance(points, _core.SurfacePoints):
            position = _inputs.vectors("points", points)
            alone = np.empty((0, 3), np.int32)
            corners = alone if triangles is None else _inputs.triangles(triangles, len(position))
            points = _core.surface_points(position, corners)
        options = _core.VelocityOptions(damping, speed_limit)
        return Velocities(*self._handle.velocities(points, as_core(method), options))

    def project(self, points: ArrayLike) -> Projected:
        """Moves points onto f = 0 by Eq. 11, x <- x - f g/|g|^2, to a distance of 1e-4 of the smallest sigma."""
        positions, gradients, residuals, converged = self._handle.project(_inputs.vectors("points", points))
        return Projected(positions, gradients, residuals, converged.astype(bool))

    def surface(self, edge_length: float | None = None) -> tuple[Floats, NDArray[np.int32]]:
        """f = 0 as a closed mesh of well-shaped triangles: positions (n, 3) [m], triangles (m, 3), outward.

        edge_length: [m], half the smallest sigma unless given. Raises InvalidInput where the lattice would be too large."""
        return self._handle.surface(0.5 * self.length_scale if edge_length is None else edge_length)


class Field(SurfaceField):
    """Eq. 12 of particles: f(x, t) = sum_i w_i (1 - |x - x_i(t)|^2/sigma^2)^3 - T over those within sigma.

    positions: (n, 3) [m]. velocities: (n, 3) [m/s], for the rates; at rest unless given. time: [s].
    sigma: support radius [m]; 2 particle spacings, which are measured, unless given (2.5 for anisotropic kernels). scales: (n,) how large each particle is
    beside those that sigma is meant for, > 0: sigma_i = scale_i sigma.
    threshold: T; half the median of the field at the particles unless given.
    weights: "uniform", w_i = 1, or "normalised", w_i = 1/sum_j (1 - r_ij^2)^3, which keeps thin sheets and lone drops.
    kernels: "round", those of Eq. 12, or "anisotropic", which follow the liquid and make its surface smooth.

    Raises InvalidInput for arrays of other shapes, numbers that are not finite, and where no spacing can be measured."""

    def __init__(self, positions: ArrayLike, velocities: ArrayLike | None = None, *, time: float = 0,
                 sigma: float | None = None, threshold: float | None = None, weights: str = "uniform",
                 kernels: str = "round",
                 scales: ArrayLike | None = None) -> None:
        particles, _ = _inputs.particles(positions, velocities, time=time, scales=scales)
        handle, self._sigma, self._threshold = _core.make_field(particles, _core.field_choices(sigma, threshold, weights, kernels))
        super().__init__(handle)

    @property
    def sigma(self) -> float:
        """Support radius [m]."""
        return self._sigma

    @property
    def threshold(self) -> float:
        """T of Eq. 12 [1]."""
        return self._threshold
