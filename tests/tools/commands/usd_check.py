"""Holds the USD files of a run against its .vtp files, by the USD library of Pixar (usd-core):

    python3 usd_check.py RUN FOLDER_OF_USD

Counts and values, in the first frames, one in the middle and the last: a file that validates may hold nothing.
"""
import json
import pathlib
import sys

import numpy
from pxr import Gf, Usd, UsdGeom

import expectations
import vtp_arrays
from expectations import expect, expect_equal

run, usd = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])


def vtp(series, frame):
    kind = series.split("-")[0]
    return vtp_arrays.read(run / series / f"{kind}_{frame:04}.vtp")


def frames_of(series):
    return len(list((run / series).glob("*.vtp")))


def expect_stage(stage, frames):
    expect(stage.GetDefaultPrim().GetPath() == "/World", "the default prim is not /World")
    expect(stage.GetStartTimeCode() == 0 and stage.GetEndTimeCode() == frames - 1, "another range of frames")
    times = [float(line.split('"')[1]) for line in (run / "run.pvd").read_text().splitlines() if "timestep" in line]
    step = sorted(set(times))[1]
    expect(abs(stage.GetTimeCodesPerSecond() * step - 1) < 1e-6, "time codes are not frames")
    expect(stage.GetFramesPerSecond() == stage.GetTimeCodesPerSecond(), "frames are not time codes")
    expect(UsdGeom.GetStageMetersPerUnit(stage) == 1, "lengths are not in metres")
    up = json.loads((run / "run.json").read_text())["view"]["up"]
    expect(UsdGeom.GetStageUpAxis(stage) == "XYZ"[numpy.abs(up).argmax()], "another axis is up")


def projected(rest, box, triangles):
    """Texture coordinates of the corners (t, 3, 2): each triangle on the face of the box nearest to its centroid."""
    r = (rest - box.mean(axis=0)) / (0.5 * (box[1] - box[0]))
    corners = r[triangles]
    face = numpy.abs(corners.sum(axis=1)).argmax(axis=1)
    u, v = numpy.array([2, 0, 0])[face], numpy.array([1, 2, 1])[face]
    pick = lambda axis: numpy.take_along_axis(corners, axis[:, None, None].repeat(3, 1), 2)[:, :, 0]
    return 0.5 + 0.5 * numpy.stack([pick(u), pick(v)], axis=2), corners


def linear(colour):
    c = colour / 255.0
    return numpy.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def expect_texture(mesh, surface, time, box):
    primvar = UsdGeom.PrimvarsAPI(mesh).GetPrimvar("st")
    expect(primvar.GetInterpolation() == "faceVarying", "st is not faceVarying")
    expect(primvar.IsIndexed(), "st is not indexed")
    values, indices = numpy.array(primvar.Get(time)), numpy.array(primvar.GetIndices(time))
    expect(len(indices) == surface["triangles"].size, "st has another number of indices than there are corners")
    expect(len(values) < 1.5 * len(surface["Points"]), "st has too many values")
    corners = values[indices].reshape(-1, 3, 2)
    wanted, _ = projected(surface["rest_position"], box, surface["triangles"])
    expect_equal(corners, wanted, "st", 1e-6)
    per_vertex = surface["TCoords"][surface["triangles"]]
    spans = numpy.ptp(per_vertex, axis=1).max(axis=1) > 0.5
    expect(spans.any(), "no triangle would have spanned a seam: nothing was tested")
    same = (numpy.abs(corners - per_vertex).max(axis=(1, 2)) < 1e-6).mean()
    expect(same > 0.6, f"only {same:.0%} of the triangles have the .vtp's texture coordinates")


def expect_surface(stage, method, frame, box):
    surface, time = vtp(f"surface-{method}", frame), Usd.TimeCode(frame)
    mesh = UsdGeom.Mesh(stage.GetPrimAtPath("/World/surface_" + method.replace("-", "_")))
    expect(bool(mesh), f"no mesh of {method}")
    expect(mesh.GetSubdivisionSchemeAttr().Get() == "none", "the mesh would be subdivided")
    points = numpy.array(mesh.GetPointsAttr().Get(time))
    expect_equal(points, surface["Points"].astype("f4"), "points")
    expect_equal(mesh.GetFaceVertexIndicesAttr().Get(time), surface["triangles"].ravel(), "corners")
    expect_equal(mesh.GetFaceVertexCountsAttr().Get(time), numpy.full(len(surface["triangles"]), 3), "counts")
    expect_equal(mesh.GetVelocitiesAttr().Get(time), surface["velocity"], "velocities")
    expect_equal(mesh.GetNormalsAttr().Get(time), surface["Normals"], "normals", 1e-5)
    expect(mesh.GetNormalsInterpolation() == "vertex", "normals are not the vertices'")
    expect_equal(mesh.GetExtentAttr().Get(time), [points.min(axis=0), points.max(axis=0)], "extent")
    arrays = {"rest": surface["rest_position"].astype("f4"), "id": surface["id"]}
    for name in ("source", "mean_curvature", "gaussian_curvature", "confidence", "material_slip", "rest_1", "rest_2",
                 "rest_2_weight"):
        if name in surface:
            arrays[name] = surface[name].astype("f4")
    for name, wanted in arrays.items():
        primvar = UsdGeom.PrimvarsAPI(mesh).GetPrimvar(name)
        expect(primvar.GetInterpolation() == "vertex", f"{name} is not the vertices'")
        expect(primvar.GetAttr().GetNumTimeSamples() == frames_of(f"surface-{method}"), f"samples of {name}")
        expect_equal(primvar.Get(time), wanted, name)
    colour = UsdGeom.PrimvarsAPI(mesh).GetPrimvar("displayColor").Get(time)
    expect_equal(colour, linear(surface["checker"]), "displayColor", 1e-4)
    expect_texture(mesh, surface, time, box)


def expect_particles(stage, frame):
    particles, time = vtp("particles", frame), Usd.TimeCode(frame)
    points = UsdGeom.Points(stage.GetPrimAtPath("/World/particles"))
    expect_equal(points.GetPointsAttr().Get(time), particles["Points"].astype("f4"), "particles")
    expect_equal(points.GetVelocitiesAttr().Get(time), particles["velocity"], "velocities of particles")
    expect_equal(points.GetIdsAttr().Get(time), particles["id"], "ids of particles")
    expect_equal(points.GetWidthsAttr().Get(time), particles["sigma"] / 2, "widths", 1e-8)


def expect_walls(stage, frame, moving):
    walls = vtp_arrays.read(run / (f"boundary/boundary_{frame:04}.vtp" if moving else "boundary.vtp"))
    prim = stage.GetPrimAtPath("/World/boundary")
    expect(len(prim.GetChildren()) == walls["wall"].max() + 1, "another number of walls")
    for w, child in enumerate(prim.GetChildren()):
        mesh = UsdGeom.Mesh(child)
        to_world = numpy.array(UsdGeom.XformCache(frame).GetLocalToWorldTransform(child))
        points = numpy.array(mesh.GetPointsAttr().Get()) @ to_world[:3, :3] + to_world[3, :3]
        corners = numpy.array(mesh.GetFaceVertexIndicesAttr().Get())
        wanted = walls["Points"][walls["triangles"][walls["wall"] == w].ravel()]
        normals = numpy.array(mesh.GetNormalsAttr().Get()) @ to_world[:3, :3]
        sides = wanted.reshape(-1, 3, 3)
        outward = numpy.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0])
        outward /= numpy.linalg.norm(outward, axis=1)[:, None]
        expect(mesh.GetNormalsInterpolation() == "uniform", "normals of walls are not the faces'")
        expect_equal(normals, outward, f"normals of wall {w} in frame {frame}", 2e-5)
        expect_equal(points[corners], wanted, f"wall {w} in frame {frame}", 1e-5)


def main():
    methods = [file.stem[8:] for file in usd.glob("surface-*.usda")]
    expect(len(methods) > 0, "there are no surfaces")
    frames = frames_of(f"surface-{methods[0]}")
    moving = (run / "boundary").is_dir() and any((run / "boundary").glob("*.vtp"))
    stage = Usd.Stage.Open(str(usd / "run.usda"))
    expect_stage(stage, frames)
    rest = vtp(f"surface-{methods[0]}", 0)["rest_position"]
    box = numpy.array([rest.min(axis=0), rest.max(axis=0)])
    for frame in sorted({0, 1, frames // 2, frames - 1}):
        for method in methods:
            expect_surface(stage, method, frame, box)
            expect_surface(Usd.Stage.Open(str(usd / f"surface-{method}.usda")), method, frame, box)
        expect_particles(stage, frame)
        if moving or (run / "boundary.vtp").exists():
            expect_walls(stage, frame, moving)
    counts = {len(vtp(f"surface-{methods[0]}", frame)["Points"]) for frame in range(frames)}
    expect(len(counts) > 1, "the number of vertices never changes: nothing was tested")
    flat = usd / "flat.usdc"
    stage.Flatten().Export(str(flat))
    expect_surface(Usd.Stage.Open(str(flat)), methods[0], frames - 1, box)
    print(f"{expectations.count} checks of {frames} frames, {', '.join(methods)}{', walls move' if moving else ''}: all hold")


main()
