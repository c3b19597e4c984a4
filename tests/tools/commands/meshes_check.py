"""Holds the OBJ, PLY and GLB files of a run against its .vtp files, every array by meshio (PLY) and trimesh:

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

ARRAYS = {"velocity", "rest_position", "rest_1", "rest_2", "texture_1", "id", "source", "mean_curvature", "confidence"}
surfaces = pathlib.Path(sys.argv[1]) / "surface-regional"


def expect_seamless(texture, triangles, what):
    """The corners of a triangle are near to each other on the texture: edges here are a few hundredths of it."""
    if not numpy.ptp(texture[triangles], axis=1).max() < 0.3:
        fail(f"{what}: a triangle spans a seam of the texture")


def in_files(name):
    """The name of a surface's array in PLY and GLB files."""
    return "rest" if name == "rest_position" else name


def properties(name, wanted):
    """In which properties of a PLY file an array's components are."""
    if wanted.ndim == 1:
        return [in_files(name)]
    prefix = "n" if name == "Normals" else in_files(name) + "_"
    return [prefix + axis for axis in "xyz"[: wanted.shape[1]]]


def check_ply(stem, surface):
    by_meshio, by_trimesh = meshio.read(f"{stem}.ply"), trimesh.load(f"{stem}.ply", process=False)
    columns = by_trimesh.metadata["_ply_raw"]["vertex"]["data"]
    for reader, points, triangles, arrays in (
        ("meshio", by_meshio.points, by_meshio.cells_dict["triangle"], by_meshio.point_data),
        ("trimesh", by_trimesh.vertices, by_trimesh.faces, {name: columns[name] for name in columns.dtype.names}),
    ):
        expect_equal(points, surface["Points"], f"positions of {reader}", 1e-12)
        expect_equal(triangles, surface["triangles"], f"triangles of {reader}", 0)
        for name, wanted in surface.items():
            if name in ("Points", "triangles", "TCoords", "checker"):
                continue
            found = numpy.stack([arrays[p] for p in properties(name, wanted)], axis=1)
            expect_equal(found, wanted.reshape(len(wanted), -1), f"{name} of {reader}", 0)
        expect_equal(numpy.stack([arrays["s"], arrays["t"]], axis=1), surface["TCoords"], f"s, t of {reader}", 0)
        colours = numpy.stack([arrays[c] for c in ("red", "green", "blue")], axis=1).astype("u1")  # signed in meshio
        expect_equal(colours, surface["checker"], f"colours of {reader}", 0)
    expect_equal(by_trimesh.visual.uv, surface["TCoords"], "s, t as texture coordinates", 0)


def check_obj(stem, surface):
    """meshio wants as many texture coordinates as there are vertices, and refuses the file."""
    mesh = trimesh.load(f"{stem}.obj", process=False)
    corners = surface["triangles"]  # it has a vertex for each of the texture coordinates
    expect_equal(mesh.vertices[mesh.faces], surface["Points"][corners], "corners of OBJ", 1e-8)
    expect_equal(mesh.vertex_normals[mesh.faces], surface["Normals"][corners], "normals of OBJ", 1e-5)
    expect_equal(mesh.vertex_attributes["color"][mesh.faces], surface["checker"][corners] / 255, "colours of OBJ", 1e-3)
    expect_seamless(mesh.visual.uv, mesh.faces, "OBJ")


def check_glb(stem, surface):
    """trimesh keeps no colours where there are texture coordinates. The scene's z points up, and the format's y."""
    scene = trimesh.load(f"{stem}.glb", process=False)
    (mesh,) = scene.geometry.values()
    turned = scene.graph[scene.graph.nodes_geometry[0]][0][:3, :3]
    expect_equal(turned @ [[1, 0], [0, 0], [0, 1]], [[1, 0], [0, 1], [0, 0]], "where GLB turns x and z", 1e-6)
    corners = surface["triangles"]
    expect_equal(mesh.vertices[mesh.faces], surface["Points"][corners], "corners of GLB", 1e-6)
    expect_seamless(mesh.visual.uv, mesh.faces, "GLB")
    for name, wanted in surface.items():
        if name in ("Points", "triangles", "Normals", "TCoords", "checker"):
            continue
        wanted = wanted.reshape(len(surface["Points"]), -1)[corners].astype("f4")
        found = mesh.vertex_attributes["_" + in_files(name).upper()]
        expect_equal(numpy.asarray(found).reshape(len(mesh.vertices), -1)[mesh.faces], wanted, f"{name} of GLB", 0)


def main():
    for frame in (0, 2):
        stem = surfaces / f"surface_{frame:04}"
        surface = vtp_arrays.read(f"{stem}.vtp")
        expect(len(surface["Points"]) > 0, "there is no surface")
        expect(surface.keys() >= ARRAYS, f"the surface lacks {ARRAYS - surface.keys()}: nothing was tested")
        check_ply(stem, surface)
        check_obj(stem, surface)
        check_glb(stem, surface)
    print(f"{expectations.count} checks: all hold")


main()
