"""Before a simulation: a start state that is clean, with a gap, as a shape key."""

import bpy

from ..plain.world import Unusable
from ..sheets import is_body, num_deforming, selected
from .fix import fixed, tell
from .jobs import Job


class StartOperator(Job, bpy.types.Operator):
    """Make the state that the selected cloth simulations start from clean, with a gap, as a shape key"""

    bl_idname = "untangled.start"
    bl_label = "Clean Start State"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return context.mode == "OBJECT"

    def work(self, context):
        objects = selected(context)
        simulations = {obj: simulation(obj) for obj in objects if not is_body(obj)}
        frames = {modifier.point_cache.frame_start for modifier in simulations.values()}
        if len(frames) > 1:
            raise Unusable("the selected simulations start in different frames: repair one after the other")
        for frame in frames:
            context.scene.frame_set(frame)
        ends = {obj: min(num_deforming(obj), index(obj, modifier)) for obj, modifier in simulations.items()}
        gap = context.scene.untangled.gap or max((own_gap(modifier) for modifier in simulations.values()), default=0.0)
        words = yield from fixed(context, objects, ends, gap)
        tell(self, context, f"gap of {gap:.4g}: {words}", words.startswith("clean"))


def simulation(obj):
    """The cloth simulation of an object that is no body."""
    for modifier in obj.modifiers:
        if modifier.type == "CLOTH":
            if modifier.point_cache.is_baked:
                raise Unusable(f"{obj.name}: its simulation is baked, and would not start anew: delete the bake first")
            return modifier
    raise Unusable(f"{obj.name}: it has no cloth simulation: give it one, or the role of a body")


def index(obj, modifier):
    return next(k for k, other in enumerate(obj.modifiers) if other == modifier)


def own_gap(modifier):
    """The distance within which a simulation takes parts of its cloth for touching."""
    collisions = modifier.collision_settings
    return collisions.self_distance_min if collisions.use_self_collision else 0.0


def register():
    bpy.utils.register_class(StartOperator)


def unregister():
    bpy.utils.unregister_class(StartOperator)
