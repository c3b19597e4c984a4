"""Reads the .vtp files that kappaflow writes: VTK XML, inline binary, compressed by zlib."""

from __future__ import annotations

import base64
import os
import struct
import zlib
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from kappaflow._meshes import Arrays
from kappaflow.errors import IoError

_TYPES = {"Int8": "i1", "UInt8": "u1", "Int16": "i2", "UInt16": "u2", "Int32": "i4", "UInt32": "u4", "Int64": "i8", "UInt64": "u8",
          "Float32": "f4", "Float64": "f8"}


class PolyData(NamedTuple):
    """What a file holds."""

    positions: NDArray[np.float64]
    triangles: NDArray[np.generic]
    arrays: Arrays
    cell_arrays: Arrays
    fields: Arrays


def read_vtp(path: str | os.PathLike[str]) -> PolyData:
    """The points, triangles and arrays of a file. Raises IoError where it cannot be read or is something else."""
    try:
        root = ElementTree.fromstring(Path(path).read_bytes())
        return _poly_data(root)
    except OSError as error:
        raise IoError(f"{path}: {error.strerror}") from None
    except (ElementTree.ParseError, ValueError, KeyError, AttributeError, zlib.error, struct.error) as error:
        raise IoError(f"{path}: is damaged, or no .vtp file of kappaflow's: {error}") from None


def read_pieces(path: str | os.PathLike[str]) -> PolyData:
    """The same, of points that may lie in several files, the pieces that a .pvtp file lists."""
    if Path(path).suffix != ".pvtp":
        return read_vtp(path)
    try:
        sources = [piece.get("Source", "") for piece in ElementTree.fromstring(Path(path).read_bytes()).iter("Piece")]
    except OSError as error:
        raise IoError(f"{path}: {error.strerror}") from None
    except ElementTree.ParseError as error:
        raise IoError(f"{path}: is damaged, or no .pvtp file of kappaflow's: {error}") from None
    if not sources:
        raise IoError(f"{path}: lists no pieces")
    pieces = [read_vtp(Path(path).parent / source) for source in sources]
    first = pieces[0]
    return first._replace(positions=np.concatenate([piece.positions for piece in pieces]),
                          arrays={name: np.concatenate([piece.arrays[name] for piece in pieces]) for name in first.arrays})


def _poly_data(root: ElementTree.Element) -> PolyData:
    if root.get("type") != "PolyData" or root.get("compressor") != "vtkZLibDataCompressor":
        raise ValueError(f"type {root.get('type')}, compressor {root.get('compressor')}")
    header = _TYPES[root.get("header_type", "UInt32")]
    piece = root.find("PolyData/Piece")
    if piece is None:
        raise ValueError("no piece")
    points = _arrays(piece.find("Points"), header)
    polygons = _arrays(piece.find("Polys"), header)
    if np.any(np.diff(polygons["offsets"], prepend=0) != 3):
        raise ValueError("polygons that are no triangles")
    return PolyData(next(iter(points.values())).astype(np.float64, copy=False), polygons["connectivity"].reshape(-1, 3),
                    _arrays(piece.find("PointData"), header), _arrays(piece.find("CellData"), header),
                    _arrays(root.find("PolyData/FieldData"), header))


def _arrays(parent: ElementTree.Element | None, header: str) -> Arrays:
    return {} if parent is None else {array.get("Name", ""): _array(array, header) for array in parent.iter("DataArray")}


def _array(element: ElementTree.Element, header: str) -> NDArray[np.generic]:
    """The numbers of a DataArray; a row a tuple where it has components."""
    components = int(element.get("NumberOfComponents", "1"))
    numbers = np.frombuffer(_decoded((element.text or "").strip(), np.dtype("<" + header)), "<" + _TYPES[element.get("type", "")])
    return numbers if components == 1 else numbers.reshape(-1, components)


def _decoded(text: str, header: np.dtype) -> bytearray:
    """Base64 of the number of blocks, the size of a block, that of the last, and the compressed size of each; then of the
    blocks."""
    size = header.itemsize
    blocks = int(np.frombuffer(base64.b64decode(text[:_characters(size)])[:size], header)[0])
    end = _characters(size * (3 + blocks))
    sizes = np.frombuffer(base64.b64decode(text[:end])[:size * (3 + blocks)], header)[3:]
    data, start, out = base64.b64decode(text[end:]), 0, bytearray()
    for length in sizes.tolist():
        out += zlib.decompress(data[start:start + length])
        start += length
    return out


def _characters(size: int) -> int:
    """Of base64 for so many bytes."""
    return 4 * ((size + 2) // 3)
