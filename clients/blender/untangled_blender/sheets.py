"""Objects of the scene as sheets: what deforming modifiers make of their meshes."""

from contextlib import contextmanager

import bpy
import numpy as np

from .plain.world import Sheet, Unusable

DEFORMS = {
    "ARMATURE", "CAST", "CLOTH", "COLLISION", "CORRECTIVE_SMOOTH", "CURVE", "DATA_TRANSFER", "DISPLACE", "HOOK",
    "LAPLACIANDEFORM", "LAPLACIANSMOOTH", "LATTICE", "MESH_CACHE", "MESH_DEFORM", "MESH_SEQUENCE_CACHE",
    "NORMAL_EDIT", "SHRINKWRAP", "SIMPLE_DEFORM", "SMOOTH", "SOFT_BODY", "SURFACE", "SURFACE_DEFORM", "UV_PROJECT",
    "UV_WARP", "VERTEX_WEIGHT_EDIT", "VERTEX_WEIGHT_MIX", "VERTEX_WEIGHT_PROXIMITY", "VOLUME_DISPLACE", "WARP", "WAVE",
    "WEIGHTED_NORMAL",
}  # fmt: skip
"""Modifiers that leave vertices and faces what they are. All others, and those after them, come after the sheet."""
PIN_WEIGHT = 0.5
"""Vertices of the group of pins with more weight than this are pinned."""


def metres(scene) -> float:
    """Metres in one of Blender's units."""
    units = scene.unit_settings
    return units.scale_length if units.system != "NONE" else 1.0


def num_deforming(obj) -> int:
    """How many of its modifiers, from the first on, only move vertices."""
    for k, modifier in enumerate(obj.modifiers):
        if modifier.type not in DEFORMS and modifier.show_viewport:
            return k
    return len(obj.modifiers)


@contextmanager
def up_to(context, ends):
    """Within it, each object of `ends` is evaluated with so many of its modifiers only."""
    hidden = [modifier for obj, end in ends.items() for modifier in obj.modifiers[end:] if modifier.show_viewport]
    for modifier in hidden:
        modifier.show_viewport = False
    try:
        yield
    finally:
        for modifier in hidden:
            modifier.show_viewport = True
        if hidden:
            context.view_layer.update()


def selected(context):
    """Selected objects with a mesh, in a fixed order."""
    found = sorted((obj for obj in context.selected_objects if obj.type == "MESH"), key=lambda obj: obj.name)
    if not found:
        raise Unusable("no mesh object is selected")
    return found


def is_body(obj) -> bool:
    return obj.untangled.role == "BODY"


def sheet(context, obj) -> Sheet:
    """What is evaluated of an object now, with all modifiers: of cloth, the caller hides those after the sheet."""
    evaluated = obj.evaluated_get(context.evaluated_depsgraph_get())
    mesh = evaluated.to_mesh()
    try:
        if not is_body(obj) and len(mesh.vertices) != len(obj.data.vertices):
            raise Unusable(f"{obj.name}: its modifiers make other vertices than its mesh has")
        mesh.calc_loop_triangles()
        return Sheet(
            name=obj.name,
            vertices=array(mesh.vertices, "co", 3, np.float32),
            triangles=array(mesh.loop_triangles, "vertices", 3, np.int32),
            matrix=np.array(evaluated.matrix_world, float),
            body=is_body(obj),
            layer=obj.untangled.layer,
            pins=None if is_body(obj) else pins(obj),
        )
    finally:
        evaluated.to_mesh_clear()


def sheets(context, objects):
    """What is evaluated of several objects now, of cloth the sheets."""
    with up_to(context, {obj: num_deforming(obj) for obj in objects if not is_body(obj)}):
        return [sheet(context, obj) for obj in objects]


def array(collection, name, width, dtype) -> np.ndarray:
    """An attribute of all elements of a collection, `n x width`."""
    values = np.empty(len(collection) * width, dtype)
    collection.foreach_get(name, values)
    return values.reshape(-1, width)


def polygons(mesh):
    """The vertices of each polygon of a mesh."""
    corners = array(mesh.loops, "vertex_index", 1, np.int32).ravel()
    starts = array(mesh.polygons, "loop_start", 1, np.int32).ravel()
    return np.split(corners, starts[1:]) if len(starts) else []


def pins(obj):
    """Pinned vertices of a cloth; none where it names no group."""
    name = obj.untangled.pins
    if not name:
        return None
    group = obj.vertex_groups.get(name)
    if group is None:
        raise Unusable(f"{obj.name}: it has no vertex group '{name}' for its pins")
    weights = (
        (vertex.index, weight.weight) for vertex in obj.data.vertices for weight in vertex.groups
        if weight.group == group.index
    )  # fmt: skip
    return np.array([index for index, weight in weights if weight > PIN_WEIGHT], np.int64)
