"""Colours and texture coordinates that stick to the liquid: functions of `rest_position` alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kappaflow import _core, _inputs


def texture_coordinates(rest_positions: ArrayLike, first_positions: ArrayLike, projection: str = "box") -> NDArray[np.float64]:
    """(n, 2) texture coordinates in [0, 1]^2, the `TCoords` of files.

    rest_positions: (n, 3) [m], of any mesh. first_positions: (m, 3) [m] of the first mesh, whose bounding box counts.
    projection: "planar", (x, y) over the box; "spherical", longitude about +y and latitude, seen from its centre; "box", onto
    the face that the point is nearest to. Raises InvalidInput for another one."""
    return _core.texture_coordinates(_inputs.vectors("rest_positions", rest_positions),
                                     _inputs.vectors("first_positions", first_positions), projection)


def checker_colours(rest_positions: ArrayLike, edge: float, origin: ArrayLike = (0, 0, 0)) -> NDArray[np.uint8]:
    """(n, 3) RGB, 0 to 255: the colours of cubes in which points lay in the first mesh, in turns cream and blue.

    rest_positions: (n, 3) [m]. edge: of a cube [m], > 0. origin: a corner of cubes [m]; put it between the first mesh's
    flat faces, or a face of the checker in a face of the liquid is noise. Raises InvalidInput for an edge that is not > 0."""
    corner = _inputs.numbers("origin", origin, 3).tolist()
    return _core.checker_colours(_inputs.vectors("rest_positions", rest_positions), corner, edge)
