"""Holds the OBJ, PLY and GLB files of a run against its .vtp files, by meshio (PLY) and trimesh:

    python3 meshes_check.py RUN
"""
import pathlib
import sys

import meshio
import numpy
import trimesh

import expectations
import vtp_arrays
from expectations import expect, expect_equal, fail

surfaces = pathlib.Path(sys.argv[1]) / "surface-regional"


def expect_seamless(texture, triangles, what):
    """The corners of a triangle are near to each other on the texture: edges here are a few hundredths of it."""
    if not numpy.ptp(texture[triangles], axis=1).max() < 0.3:
        fail(f"{what}: a triangle spans a seam of the texture")


def check_ply(stem, surface):
    for points, triangles, reader in (
        (lambda m: (m.points, m.cells_dict["triangle"], "meshio"))(meshio.read(f"{stem}.ply")),
        (lambda m: (m.vertices, m.faces, "trimesh"))(trimesh.load(f"{stem}.ply", process=False)),
    ):
        expect_equal(points, surface["Points"], f"positions of {reader}", 1e-12)
        expect_equal(triangles, surface["triangles"], f"triangles of {reader}", 0)
    arrays = meshio.read(f"{stem}.ply").point_data
    for name, wanted in surface.items():
        if name in ("Points", "triangles", "Normals", "TCoords", "checker"):
            continue
        name = "rest" if name == "rest_position" else name
        vectors = [f"{name}_{axis}" for axis in "xyz"]
        found = numpy.stack([arrays[v] for v in vectors], axis=1) if wanted.ndim == 2 else arrays[name]
        expect_equal(found, wanted, f"{name} of meshio", 0)
    expect_equal(numpy.stack([arrays["s"], arrays["t"]], axis=1), surface["TCoords"], "s, t", 0)
    colours = numpy.stack([arrays[c] for c in ("red", "green", "blue")], axis=1).astype("u1")  # signed in meshio
    expect_equal(colours, surface["checker"], "colours", 0)
    expect_equal(trimesh.load(f"{stem}.ply", process=False).visual.uv, surface["TCoords"], "s, t of trimesh", 0)


def check_obj(stem, surface):
    """meshio wants as many texture coordinates as there are vertices, and refuses the file."""
    mesh = trimesh.load(f"{stem}.obj", process=False)
    where = mesh.vertices[mesh.faces]  # it has a vertex for each of the texture coordinates
    expect_equal(where, surface["Points"][surface["triangles"]], "corners of trimesh", 1e-8)
    expect_seamless(mesh.visual.uv, mesh.faces, "OBJ")


def check_glb(stem, surface):
    mesh = trimesh.load(f"{stem}.glb", process=False, force="mesh")
    corners = surface["triangles"]
    expect_equal(mesh.vertices[mesh.faces], surface["Points"][corners], "corners of GLB", 1e-6)
    for name, array in (("_REST", "rest_position"), ("_VELOCITY", "velocity"), ("_ID", "id"),
                        ("_MEAN_CURVATURE", "mean_curvature")):
        wanted = surface[array].reshape(len(surface["Points"]), -1)[corners].astype("f4")
        found = numpy.asarray(mesh.vertex_attributes[name]).reshape(len(mesh.vertices), -1)[mesh.faces]
        expect_equal(found, wanted, name, 0)


def main():
    for frame in (0, 2):
        stem = surfaces / f"surface_{frame:04}"
        surface = vtp_arrays.read(f"{stem}.vtp")
        expect(len(surface["Points"]) > 0, "there is no surface")
        check_ply(stem, surface)
        check_obj(stem, surface)
        check_glb(stem, surface)
    print(f"{expectations.count} checks: all hold")


main()
