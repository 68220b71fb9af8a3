"""Displacements as a shape key, so that a repair can be undone and blended."""

import bpy
import numpy as np

from .plain.world import Unusable

NAME = "Untangled"


def check(obj) -> None:
    """Raises `Unusable` where a shape key of this object would not do what it should."""
    mesh = obj.data
    keys = mesh.shape_keys
    if obj.mode != "OBJECT":
        raise Unusable(f"{obj.name}: leave its {obj.mode.lower().replace('_', ' ')} mode first")
    if mesh.library or obj.library:
        raise Unusable(f"{obj.name}: it is linked from another file: make it local first")
    if mesh.users > 1:
        raise Unusable(f"{obj.name}: {mesh.users} objects share its mesh: make it single-user first")
    if keys and not keys.use_relative:
        raise Unusable(f"{obj.name}: its shape keys are absolute: a repair needs relative ones")
    if obj.show_only_shape_key:
        raise Unusable(f"{obj.name}: one of its shape keys is shown alone: end that first")


def add(obj):
    """A new key without displacements, at its full value. A mesh without keys gets a basis first."""
    if obj.data.shape_keys is None:
        obj.shape_key_add(name="Basis", from_mix=False)
    key = obj.shape_key_add(name=NAME, from_mix=False)
    key.value = 1.0
    return key


def move(context, obj, key, displacements) -> None:
    """Moves a key so that the vertices of the evaluated object move by `displacements`, in the space of the object.

    Where modifiers turn a vertex, its displacement is turned back.
    """
    moved = np.flatnonzero(displacements.any(1))
    if not len(moved):
        return
    places = np.empty(3 * len(key.data), np.float32)
    key.data.foreach_get("co", places)
    places = places.reshape(-1, 3)
    places[moved] += _before_modifiers(context, obj, moved, displacements[moved])
    key.data.foreach_set("co", places.ravel())
    obj.data.update_tag()
    context.view_layer.update()


def _before_modifiers(context, obj, moved, displacements):
    if not any(modifier.show_viewport for modifier in obj.modifiers):
        return displacements
    obj.crazyspace_eval(context.evaluated_depsgraph_get(), context.scene)
    try:
        back = obj.crazyspace_displacement_to_original
        return np.array([
            back(vertex_index=int(vertex), displacement=displacement)
            for vertex, displacement in zip(moved, displacements)
        ])  # fmt: skip
    finally:
        obj.crazyspace_eval_clear()
