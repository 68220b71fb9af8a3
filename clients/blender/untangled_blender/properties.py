"""What a user chooses: the part of each object, and how to repair."""

import bpy
from bpy.props import CollectionProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty, StringProperty

ROLES = [
    ("CLOTH", "Cloth", "It is repaired"),
    ("BODY", "Body", "It stays as it is, and cloth ends outside of it"),
]
QUALITIES = [
    ("fast", "Fast", "Fewer trials in each iteration"),
    ("balanced", "Balanced", "For most garments"),
    ("accurate", "Accurate", "More trials in each iteration"),
]


class ObjectSettings(bpy.types.PropertyGroup):
    """The part of one object."""

    role: EnumProperty(name="Role", items=ROLES)
    layer: IntProperty(
        name="Layer",
        description="1 is innermost; each layer ends outside of those before it. 0 has no order with others",
        min=0,
    )
    pins: StringProperty(name="Pins", description="Vertices of this group with a weight above 0.5 stay where they are")


class SceneSettings(bpy.types.PropertyGroup):
    """How to repair."""

    gap: FloatProperty(
        name="Gap",
        description="Set apart what is nearer than this; 0 only ends intersections",
        min=0,
        precision=5,
        subtype="DISTANCE",
        unit="LENGTH",
    )
    quality: EnumProperty(name="Quality", items=QUALITIES, default="balanced")
    max_iterations: IntProperty(name="Iterations", description="Give up after so many", default=100, min=1)


class FoundPath(bpy.types.PropertyGroup):
    """A line of the list of paths."""

    objects: StringProperty()
    length: FloatProperty(description="Metres")
    centre: bpy.props.FloatVectorProperty(size=3)
    radius: FloatProperty()


class Found(bpy.types.PropertyGroup):
    """What the last check found. It belongs to the session, not to the file."""

    summary: StringProperty()
    paths: CollectionProperty(type=FoundPath)
    active: IntProperty()


CLASSES = ObjectSettings, SceneSettings, FoundPath, Found


def register():
    for found in CLASSES:
        bpy.utils.register_class(found)
    bpy.types.Object.untangled = PointerProperty(type=ObjectSettings)
    bpy.types.Scene.untangled = PointerProperty(type=SceneSettings)
    bpy.types.WindowManager.untangled = PointerProperty(type=Found)


def unregister():
    del bpy.types.WindowManager.untangled, bpy.types.Scene.untangled, bpy.types.Object.untangled
    for found in reversed(CLASSES):
        bpy.utils.unregister_class(found)
