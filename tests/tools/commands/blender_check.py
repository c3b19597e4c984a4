"""Imports the files of a run in Blender and holds what it has against the .vtp files:

    python3 blender_check.py RUN

Vertices, triangles, texture coordinates and all arrays in several frames, walls where they move to, which way up OBJ and
PLY come, and that pictures of Cycles with motion blur are blurred.
"""
import math
import pathlib
import sys

import bpy
import numpy

import expectations
import vtp_arrays
from expectations import expect, expect_equal

run = pathlib.Path(sys.argv[1])
METHOD = "regional"
VECTORS = {"rest": "rest_position", "velocity": "velocity", "rest_1": "rest_1", "rest_2": "rest_2"}
NUMBERS = ("mean_curvature", "gaussian_curvature", "confidence", "material_slip", "rest_2_weight")


def values(collection, name, components, kind="f4"):
    array = numpy.zeros(len(collection) * components, kind)
    collection.foreach_get(name, array)
    return array.reshape(-1, components) if components > 1 else array


def attribute(mesh, name, components=1, kind="f4"):
    expect(name in mesh.attributes, f"no attribute {name}; there are {', '.join(mesh.attributes.keys())}")
    return values(mesh.attributes[name].data, "vector" if components == 3 else "value", components, kind)


def surface_now():
    """The surface's object, and its mesh as it is in the current frame."""
    surface = bpy.data.objects[f"surface_{METHOD}"]
    return surface, surface.evaluated_get(bpy.context.evaluated_depsgraph_get()).data


def check_surface(frame):
    bpy.context.scene.frame_set(frame)
    surface = vtp_arrays.read(run / f"surface-{METHOD}/surface_{frame:04}.vtp")
    mesh = surface_now()[1]
    expect_equal(values(mesh.vertices, "co", 3), surface["Points"], f"positions in frame {frame}", 1e-6)
    expect(all(p.loop_total == 3 for p in mesh.polygons), "some polygons are no triangles")
    corners = values(mesh.loops, "vertex_index", 1, "i4")
    expect_equal(corners, surface["triangles"].ravel(), "triangles", 0)
    for name, array in VECTORS.items():
        expect_equal(attribute(mesh, name, 3), surface[array], name, 1e-6)
    for name in NUMBERS:
        expect_equal(attribute(mesh, name), surface[name].astype("f4"), name, 0)
    for name in ("id", "source"):
        expect_equal(attribute(mesh, name, kind="i4"), surface[name], name, 0)
    colours = values(mesh.attributes["displayColor"].data, "color_srgb", 4)[:, :3]
    expect_equal(colours, surface["checker"] / 255, "displayColor", 2e-3)
    texture = values(mesh.uv_layers["st"].data, "uv", 2).reshape(-1, 3, 2)
    expect(numpy.ptp(texture, axis=1).max() < 0.4, "a triangle spans a seam of the texture")
    per_vertex = surface["TCoords"][surface["triangles"]]
    same = (numpy.abs(texture - per_vertex).max(axis=(1, 2)) < 1e-5).mean()
    expect(same > 0.6, f"only {same:.0%} of the triangles have the .vtp's texture coordinates")
    return len(mesh.vertices)


def check_single_files(frame):
    """OBJ and PLY files stand upright where the import is told that z is up, as it is in this scene."""
    stem = run / f"surface-{METHOD}/surface_{frame:04}"
    surface = vtp_arrays.read(f"{stem}.vtp")
    for kind, load in (("obj", bpy.ops.wm.obj_import), ("ply", bpy.ops.wm.ply_import)):
        load(filepath=f"{stem}.{kind}", forward_axis="Y", up_axis="Z")
        thing = bpy.context.object
        to_world = numpy.array(thing.matrix_world)
        points = values(thing.data.vertices, "co", 3) @ to_world[:3, :3].T + to_world[:3, 3]
        expect_equal(points, surface["Points"], f"positions of .{kind}", 1e-6)
        expect(len(thing.data.uv_layers) == 1, f".{kind} has {len(thing.data.uv_layers)} texture coordinates")
        if kind == "ply":
            expect_equal(attribute(thing.data, "rest_x"), surface["rest_position"][:, 0], "rest_x", 1e-6)
            expect_equal(attribute(thing.data, "velocity_z"), surface["velocity"][:, 2], "velocity_z", 0)
        bpy.data.objects.remove(thing)


def check_walls(frame):
    bpy.context.scene.frame_set(frame)
    walls = vtp_arrays.read(run / f"boundary/boundary_{frame:04}.vtp")
    graph = bpy.context.evaluated_depsgraph_get()
    for w in range(walls["wall"].max() + 1):
        wall = bpy.data.objects[f"wall_{w}"].evaluated_get(graph)
        local = bpy.data.objects["World"].evaluated_get(graph).matrix_world.inverted() @ wall.matrix_world
        points = values(wall.data.vertices, "co", 3) @ numpy.array(local)[:3, :3].T + numpy.array(local)[:3, 3]
        corners = values(wall.data.loops, "vertex_index", 1, "i4")
        wanted = walls["Points"][walls["triangles"][walls["wall"] == w].ravel()]
        expect_equal(points[corners], wanted, f"wall {w} in frame {frame}", 1e-5)


def add_camera(surface, frame):
    bpy.context.scene.frame_set(frame)
    mesh = surface_now()[1]
    points = values(mesh.vertices, "co", 3) @ numpy.array(surface.matrix_world)[:3, :3].T
    middle, size = points.mean(axis=0), numpy.ptp(points, axis=0).max()
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.type, camera.data.ortho_scale = "ORTHO", 1.4 * size
    camera.location = middle + [0, -5 * size, 0]
    camera.rotation_euler = (math.pi / 2, 0, 0)
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera


def add_light():
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.rotation_euler = (0.9, 0.2, 0.4)
    bpy.context.scene.collection.objects.link(sun)


def set_checker(surface):
    material = bpy.data.materials.new("checker on rest")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    rest, checker = nodes.new("ShaderNodeAttribute"), nodes.new("ShaderNodeTexChecker")
    rest.attribute_name = "rest"
    checker.inputs["Scale"].default_value = 20
    links.new(rest.outputs["Vector"], checker.inputs["Vector"])
    links.new(checker.outputs["Color"], nodes["Principled BSDF"].inputs["Base Color"])
    surface.data.materials.clear()
    surface.data.materials.append(material)


def picture(name, blurred):
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device, scene.cycles.samples, scene.cycles.seed = "CPU", 64, 1
    scene.render.resolution_x = scene.render.resolution_y = 160
    scene.render.use_motion_blur, scene.render.motion_blur_shutter = blurred, 1.0
    scene.render.filepath = str(run / name)
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    pixels = numpy.zeros(160 * 160 * 4, "f4")
    image.pixels.foreach_get(pixels)
    return pixels.reshape(160, 160, 4)[:, :, :3].mean(axis=2)


def check_blur():
    surface = surface_now()[0]
    for other in bpy.data.objects:
        other.hide_render = other.name.startswith(("wall", "particles"))
    add_camera(surface, 2)
    add_light()
    set_checker(surface)
    sharp, again, blurred = picture("sharp.png", False), picture("again.png", False), picture("blurred.png", True)
    expect(sharp.std() > 0.05, "the picture is empty")
    noise, changed = (numpy.abs(sharp - other).mean() for other in (again, blurred))
    edges = [numpy.square(numpy.diff(p, axis=1)).sum() for p in (sharp, blurred)]  # across the motion
    expect(changed > 0.01 and changed > 100 * noise, f"motion blur changes a pixel by {changed:.5f}, noise by {noise:.5f}")
    expect(edges[1] < 0.7 * edges[0], f"edges are {edges[1] / edges[0]:.2f} as sharp")
    print(f"motion blur changes a pixel by {changed:.3f}, noise by {noise:.6f}; edges are {edges[1] / edges[0]:.2f} as sharp")


def main():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.usd_import(filepath=str(run / "run.usda"))
    bpy.context.scene.render.fps = 40
    counts = {check_surface(frame) for frame in (0, 2, 4, 3)}
    expect(len(counts) > 1, "the number of vertices never changes: nothing was tested")
    for frame in (0, 2, 4):
        check_walls(frame)
    up = bpy.data.objects["World"].matrix_world.to_3x3()
    expect(abs(up[2][2] - 1) < 1e-6, "z does not point up")
    particles = bpy.data.objects["particles"].evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    frame = bpy.context.scene.frame_current
    wanted = vtp_arrays.read(run / f"particles/particles_{frame:04}.vtp")["Points"]
    expect_equal(values(particles.attributes["position"].data, "vector", 3), wanted, "particles", 1e-6)
    check_single_files(frame)
    check_blur()
    print(f"Blender {bpy.app.version_string}: {expectations.count} checks: all hold")


main()
