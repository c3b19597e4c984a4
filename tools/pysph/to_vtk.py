#!/usr/bin/env python3
"""Writes PySPH's files as legacy VTK, one for each array of particles, for `kappaflow track`.

    python3 tools/pysph/to_vtk.py dam_break_output/*.npz
    kappaflow track 'dam_break_output/dam_break_*_fluid.vtk'

dam_break_0.npz becomes dam_break_0_fluid.vtk, dam_break_0_boundary.vtk and so on, beside it. Needs NumPy, and h5py for
.hdf5. NumPy runs what a .npz asks it to: convert files of your own only.
"""
import os
import sys

import numpy

VTK_TYPES = {"i4": "int", "u4": "unsigned_int", "i8": "vtktypeint64", "u8": "vtktypeuint64", "f4": "float",
             "f8": "double"}


def text(name):
    return name.decode() if isinstance(name, bytes) else str(name)  # bytes from PySPH under Python 2


def with_text_keys(value):
    if isinstance(value, dict):
        return {text(key): with_text_keys(entry) for key, entry in value.items()}
    return value


def load_npz(file):
    """The arrays of each kind of particles, and the time."""
    data = numpy.load(file, allow_pickle=True, encoding="bytes")
    solver = with_text_keys(data["solver_data"].item())
    if "particles" not in data.files:  # version 1
        return with_text_keys(data["arrays"].item()), solver.get("t")
    particles = with_text_keys(data["particles"].item())
    return {name: kind["arrays"] for name, kind in particles.items()}, solver.get("t")


def load_hdf5(file):
    import h5py
    with h5py.File(file, "r") as data:
        particles = {name: {key: numpy.array(values) for key, values in kind["arrays"].items()}
                     for name, kind in data["particles"].items()}
        return particles, data["solver_data"].attrs.get("t")


def field_array(name, values):
    values = numpy.asarray(values)
    kind = f"{values.dtype.kind}{values.dtype.itemsize}"
    return f"{name} 1 {values.size} {VTK_TYPES[kind]}\n".encode() + values.astype(f">{kind}").tobytes() + b"\n"


def vtk_bytes(arrays, time):
    place = numpy.stack([arrays[axis] for axis in "xyz"], axis=1)
    n = len(place)
    kept = [name for name, values in arrays.items() if len(values) == n and name not in ("x", "y", "z")]
    head = b"# vtk DataFile Version 3.0\nPySPH\nBINARY\nDATASET POLYDATA\n"
    if time is not None:
        head += b"FIELD FieldData 1\n" + field_array("TimeValue", [float(time)])
    head += f"POINTS {n} double\n".encode() + place.astype(">f8").tobytes() + b"\n"
    head += f"POINT_DATA {n}\nFIELD FieldData {len(kept)}\n".encode()
    return head + b"".join(field_array(name, arrays[name]) for name in kept)


def main(files):
    if not files:
        sys.exit(__doc__)
    for file in files:
        stem, ending = os.path.splitext(file)
        if ending not in (".npz", ".hdf5"):
            sys.exit(f"{file}: unknown kind of file; expected .npz or .hdf5")
        particles, time = load_npz(file) if ending == ".npz" else load_hdf5(file)
        for name, arrays in particles.items():
            with open(f"{stem}_{name}.vtk", "wb") as out:
                out.write(vtk_bytes(arrays, time))


main(sys.argv[1:])
