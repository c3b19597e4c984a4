"""Reads kappaflow's .vtp files without VTK, for the tests that hold other programs' formats against them."""
import base64
import struct
import xml.etree.ElementTree
import zlib

import numpy

TYPES = {"Int32": "<i4", "Int64": "<i8", "UInt8": "u1", "Float32": "<f4", "Float64": "<f8"}


def numbers(array):
    """The numbers of a DataArray: inline binary, blocks compressed by zlib; a tuple a row."""
    text = "".join(array.text.split())
    if array.get("format") == "ascii":
        values = numpy.array(array.text.split(), TYPES[array.get("type")])
    else:
        blocks = struct.unpack("<I", base64.b64decode(text[:8])[:4])[0]
        header_size = 4 * (3 + blocks)
        header_text = 4 * ((header_size + 2) // 3)
        sizes = struct.unpack(f"<{3 + blocks}I", base64.b64decode(text[:header_text])[:header_size])[3:]
        data, raw, at = base64.b64decode(text[header_text:]), b"", 0
        for size in sizes:
            raw += zlib.decompress(data[at : at + size])
            at += size
        values = numpy.frombuffer(raw, TYPES[array.get("type")])
    components = int(array.get("NumberOfComponents", "1"))
    return values.reshape(-1, components) if components > 1 else values


def read(path):
    """All arrays by name; Points, and the triangles (n, 3) as "triangles"."""
    piece = xml.etree.ElementTree.parse(path).getroot().find("PolyData/Piece")
    arrays = {"triangles": numpy.zeros((0, 3), int)}
    for owner in ("PointData", "CellData", "Points"):
        for array in piece.findall(f"{owner}/DataArray"):
            arrays[array.get("Name")] = numbers(array)
    corners = piece.find("Polys/DataArray[@Name='connectivity']")
    if int(piece.get("NumberOfPolys")) > 0:
        arrays["triangles"] = numbers(corners).reshape(-1, 3)
    return arrays
