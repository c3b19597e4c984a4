"""What users hand over, as the compiled half takes it: arrays of the right shape and type, which are not copied where they
are that already."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kappaflow import _core
from kappaflow.errors import InvalidInput


def _array(name: str, values: ArrayLike, dtype: type[np.generic], tail: tuple[int, ...], count: int | None) -> NDArray[Any]:
    needed = "(" + ", ".join(["n" if count is None else str(count), *map(str, tail)]) + ("," if not tail else "") + ")"
    try:
        array = np.asarray(values)
        if array.dtype != dtype and not np.can_cast(array.dtype, dtype, "same_kind"):
            raise TypeError
    except (TypeError, ValueError):
        raise InvalidInput(f"{name}: no array of {np.dtype(dtype)}; one of shape {needed} is needed") from None
    if array.ndim != 1 + len(tail) or array.shape[1:] != tail or count not in (None, array.shape[0]):
        raise InvalidInput(f"{name}: an array of shape {array.shape}; {needed} is needed")
    result = np.ascontiguousarray(array, dtype)
    if array.dtype != dtype and np.issubdtype(dtype, np.integer) and np.any(result != array):
        raise InvalidInput(f"{name}: a number does not fit into {np.dtype(dtype)}")
    return result


def vectors(name: str, values: ArrayLike, count: int | None = None) -> NDArray[np.float64]:
    return _array(name, values, np.float64, (3,), count)


def numbers(name: str, values: ArrayLike, count: int | None = None) -> NDArray[np.float64]:
    return _array(name, values, np.float64, (), count)


def integers(name: str, values: ArrayLike, count: int | None = None) -> NDArray[np.int32]:
    return _array(name, values, np.int32, (), count)


def triangles(values: ArrayLike, vertices: int) -> NDArray[np.int32]:
    array = _array("triangles", values, np.int32, (3,), None)
    if array.size and (array.min() < 0 or array.max() >= vertices):
        raise InvalidInput(f"triangles: vertices {array.min()} to {array.max()}; 0 to {vertices - 1} are there")
    return array


def particles(positions: ArrayLike, velocities: ArrayLike | None = None, ids: ArrayLike | None = None, *, time: float,
              sources: ArrayLike | None = None,
              scales: ArrayLike | None = None) -> tuple[_core.Particles, NDArray[np.int32] | None]:
    """Particles by ascending id, and their sources in the same order. ids: None: the numbers of the rows."""
    position = vectors("positions", positions)
    count = len(position)
    velocity = np.zeros_like(position) if velocities is None else vectors("velocities", velocities, count)
    source = None if sources is None else integers("sources", sources, count)
    scale = np.empty(0) if scales is None else numbers("scales", scales, count)
    if ids is None:
        return _core.Particles(float(time), np.arange(count), position, velocity, scale), source
    id_ = _array("ids", ids, np.int64, (), count)
    if np.any(id_[1:] < id_[:-1]):
        order = np.argsort(id_, kind="stable")
        id_, position, velocity = id_[order], position[order], velocity[order]
        source = None if source is None else source[order]
        scale = scale if scales is None else scale[order]
    return _core.Particles(float(time), id_, position, velocity, scale), source
