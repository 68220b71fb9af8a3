"""Renders the picture of the manual: `python clients/blender/picture.py FOLDER` writes check.png and fixed.png.

The paths of a check, as curve objects, and the same scene after a repair. Needs bpy and the package, as the tests do.
"""

import os
import pathlib
import sys

sys.path[:0] = [str(pathlib.Path(__file__).resolve().parent), str(pathlib.Path(__file__).resolve().parent / "tests")]
import bpy
import mathutils
import numpy as np
from conftest import Scene, curled, standing

import untangled_blender

SIZE = 480, 300
FROM, TO = (1.0, -0.75, 0.75), (0.35, 0.15, 0.03)


def stage():
    """An empty scene with a camera and a sun."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.samples = "CYCLES", 16
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    scene.view_settings.view_transform = "Standard"
    scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs[0].default_value = 0.8, 0.8, 0.85, 1
    scene.camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    scene.camera.location = FROM
    way = mathutils.Vector(TO) - mathutils.Vector(FROM)
    scene.camera.rotation_euler = way.to_track_quat("-Z", "Y").to_euler()
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.data.energy, sun.rotation_euler = 2, (0.5, 0.4, 0)
    for obj in (scene.camera, sun):
        bpy.context.collection.objects.link(obj)
    return Scene(bpy)


def colour(obj, shade):
    material = bpy.data.materials.new(obj.name)
    material.use_nodes = True
    material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = *shade, 1
    obj.data.materials.append(material)


def render(path):
    bpy.context.scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)


def main(folder):
    untangled_blender.register()
    scene = stage()
    vertices, faces = standing()
    cloth = scene.add("cloth", curled(60))
    flap = scene.add("flap", (vertices * np.float32([0.5, 1, 1]) + np.float32([0, -0.06, 0]), faces))
    colour(cloth, (0.55, 0.55, 0.55))
    colour(flap, (0.5, 0.42, 0.32))
    scene.ops.check()
    scene.ops.curves(radius=0.006)
    render(folder / "check.png")
    for curve in bpy.data.collections["Untangled paths"].objects:
        curve.hide_render = True
    scene.ops.fix()
    render(folder / "fixed.png")
    # After a rendering this Blender does not always end by itself.
    sys.stdout.flush()
    os._exit(0)


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]).resolve())
