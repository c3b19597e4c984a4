#!/usr/bin/env python3
"""Writes frames of a cube of particles in pieces, to measure how much memory `kappaflow track` takes:
  large_frames.py FOLDER SIDE [PIECES [FRAMES]]
SIDE^3 particles a frame, a millimetre apart and jittered, with ids and velocities, in double precision, as .pvtp with .vtp pieces
(raw appended data, 56 bytes a particle). The cube moves by a spacing a frame and turns slowly.
"""
import array
import math
import random
import struct
import sys

SPACING, FRAME_TIME, SPIN, SPEED = 0.001, 0.04, 0.05, 0.025


def vtp(position, velocity, ids, time):
    """A file of these arrays."""
    blobs = [array_.tobytes() for array_ in (position, velocity, ids)]
    offsets = [0, 8 + len(blobs[0]), 16 + len(blobs[0]) + len(blobs[1])]
    arrays = [f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{n}" format="appended" offset="{offset}"/>'
              for (kind, name, n), offset in zip((("Float64", "Points", 3), ("Float64", "velocity", 3), ("Int64", "id", 1)), offsets)]
    head = (f'<VTKFile type="PolyData" byte_order="LittleEndian" header_type="UInt64"><PolyData><FieldData><DataArray type="Float64" '
            f'Name="TimeValue">{time}</DataArray></FieldData><Piece NumberOfPoints="{len(ids)}"><PointData>{arrays[1]}{arrays[2]}'
            f'</PointData><Points>{arrays[0]}</Points></Piece></PolyData><AppendedData encoding="raw">_')
    return head.encode() + b"".join(struct.pack("<Q", len(blob)) + blob for blob in blobs) + b"</AppendedData></VTKFile>\n"


def write_piece(file, side, planes, time):
    """The planes of the cube, which are numbered from below."""
    position, velocity, ids = array.array("d"), array.array("d"), array.array("q")
    c, s = math.cos(SPIN * time), math.sin(SPIN * time)
    for k in planes:
        jitter = random.Random(k).random
        for j in range(side):
            for i in range(side):
                x, y, z = (SPACING * (n - side / 2 + 0.3 * jitter()) for n in (i, j, k))
                x, y = c * x - s * y, s * x + c * y
                position.extend((x + SPEED * time, y, z))
                velocity.extend((SPEED - SPIN * y, SPIN * x, 0))
                ids.append((k * side + j) * side + i)
    with open(file, "wb") as out:
        out.write(vtp(position, velocity, ids, time))


def main():
    folder, side = sys.argv[1], int(sys.argv[2])
    pieces, frames = (int(sys.argv[n]) if len(sys.argv) > n else default for n, default in ((3, 8), (4, 4)))
    for frame in range(frames):
        names = [f"frame_{frame}_{piece}.vtp" for piece in range(pieces)]
        for piece, name in enumerate(names):
            planes = range(piece * side // pieces, (piece + 1) * side // pieces)
            write_piece(f"{folder}/{name}", side, planes, frame * FRAME_TIME)
        with open(f"{folder}/frame_{frame}.pvtp", "w", encoding="utf-8") as out:
            out.write('<VTKFile type="PPolyData"><PPolyData GhostLevel="0">'
                      + "".join(f'<Piece Source="{name}"/>' for name in names) + "</PPolyData></VTKFile>\n")


if __name__ == "__main__":
    main()
