"""A picture (.png or .jpg) of a run's surface by Blender, with a checker on its rest positions and motion blur.

    build/python/bin/python3 tools/blender/picture.py out/staircase regional 45 picture.jpg

of a run with USD files (run --format usd, or kappaflow convert); build/python is what tools/setup --blender installs. In
Blender itself: blender --background --python tools/blender/picture.py -- out/staircase regional 45 picture.jpg
"""
import pathlib
import sys

import bpy
from mathutils import Vector

CREAM, BLUE = (0.91, 0.78, 0.58, 1), (0.03, 0.14, 0.36, 1)


def imported(run, method):
    """The surface's and the walls' objects, in a scene that holds nothing else."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    for part in (f"surface-{method}.usda", "boundary.usda"):
        if (run / part).exists():
            bpy.ops.wm.usd_import(filepath=str(run / part))
    surface = bpy.data.objects["surface_" + method.replace("-", "_")]
    return surface, [o for o in bpy.data.objects if o.name.startswith("wall_")]


def new_material(name, objects):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    for thing in objects:
        thing.data.materials.clear()
        thing.data.materials.append(material)
    return material.node_tree.nodes, material.node_tree.links, material.node_tree.nodes["Principled BSDF"]


def add_checker(surface, cubes_per_metre):
    """A checker in space, turned so that none of its planes lies in a face of the liquid at rest."""
    nodes, links, shader = new_material("checker on rest", [surface])
    rest, turned, checker = (nodes.new("ShaderNode" + kind) for kind in ("Attribute", "Mapping", "TexChecker"))
    rest.attribute_name = "rest"
    turned.inputs["Rotation"].default_value = (0.3, 0.2, 0.5)
    checker.inputs["Scale"].default_value = cubes_per_metre
    checker.inputs["Color1"].default_value, checker.inputs["Color2"].default_value = CREAM, BLUE
    links.new(rest.outputs["Vector"], turned.inputs["Vector"])
    links.new(turned.outputs["Vector"], checker.inputs["Vector"])
    links.new(checker.outputs["Color"], shader.inputs["Base Color"])
    shader.inputs["Roughness"].default_value = 0.25
    shader.inputs["Coat Weight"].default_value = 0.6
    shader.inputs["Coat Roughness"].default_value = 0.08


def add_stone(walls):
    nodes, links, shader = new_material("stone", walls)
    noise, ramp = nodes.new("ShaderNodeTexNoise"), nodes.new("ShaderNodeValToRGB")
    noise.inputs["Scale"].default_value, noise.inputs["Detail"].default_value = 3, 12
    ramp.color_ramp.elements[0].color, ramp.color_ramp.elements[1].color = (0.20, 0.19, 0.18, 1), (0.36, 0.34, 0.32, 1)
    place = nodes.new("ShaderNodeTexCoord")
    links.new(place.outputs["Object"], noise.inputs["Vector"])
    links.new(noise.outputs["Fac"], ramp.inputs["Fac"])
    links.new(ramp.outputs["Color"], shader.inputs["Base Color"])
    shader.inputs["Roughness"].default_value = 0.8


def box_of(surface):
    """Middle and largest extent of the surface in the current frame."""
    shown = surface.evaluated_get(bpy.context.evaluated_depsgraph_get())
    corners = [shown.matrix_world @ Vector(corner) for corner in shown.bound_box]
    lower, upper = (Vector(side(c[a] for c in corners) for a in range(3)) for side in (min, max))
    return (lower + upper) / 2, max(upper - lower)


def aimed(name, data, location, target):
    thing = bpy.data.objects.new(name, data)
    thing.location = location
    thing.rotation_euler = (target - location).to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(thing)
    return thing


def add_studio(surface):
    """Camera, a sun that makes treads bright and sides dark, a soft light from the front, and a grey sky."""
    scene = bpy.context.scene
    middle, size = box_of(surface)
    camera = bpy.data.cameras.new("camera")
    camera.lens = 60
    target = middle + Vector((-0.3, 0, 0.1)) * size
    scene.camera = aimed("camera", camera, middle + Vector((1.3, -3.3, 1.5)) * size, target)
    sun = aimed("sun", bpy.data.lights.new("sun", "SUN"), middle + Vector((0.6, -0.35, 1.6)) * size, middle)
    sun.data.energy, sun.data.angle = 2.2, 0.15
    soft = aimed("soft", bpy.data.lights.new("soft", "AREA"), middle + Vector((2.5, -2, 2)) * size, middle)
    soft.data.size, soft.data.energy = 2 * size, 60 * size**2
    scene.world = bpy.data.worlds.new("sky")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.30, 0.38, 0.50, 1)
    scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.4


def render(picture, samples):
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.device, scene.cycles.samples = "CYCLES", "CPU", samples
    scene.cycles.use_denoising = True
    scene.render.use_motion_blur, scene.render.motion_blur_shutter = True, 0.15
    scene.view_settings.view_transform, scene.view_settings.look = "AgX", "AgX - Medium High Contrast"
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 960, 540, 100
    if picture.suffix == ".jpg":
        scene.render.image_settings.file_format, scene.render.image_settings.quality = "JPEG", 93
    scene.render.filepath = str(picture)
    bpy.ops.render.render(write_still=True)


def main():
    words = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    if len(words) != 4:
        sys.exit(__doc__)
    run, method, frame, picture = pathlib.Path(words[0]).resolve(), words[1], int(words[2]), pathlib.Path(words[3]).resolve()
    surface, walls = imported(run, method)
    bpy.context.scene.frame_set(frame)
    add_checker(surface, cubes_per_metre=4)
    add_stone(walls)
    add_studio(surface)
    render(picture, samples=64)


main()
