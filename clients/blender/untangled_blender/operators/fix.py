"""Repairs the selected objects as they are evaluated now; the result is a shape key of each."""

import bpy

from .. import keys
from ..plain.solve import repair, verdict
from ..plain.world import Unusable, World
from ..sheets import is_body, metres, num_deforming, selected, sheet, up_to
from .check import show
from .jobs import Job

ROUNDS = 4
"""Blender rounds to single precision, and modifiers may bend what a key does: so often is the outcome repaired."""
CACHED = {"CLOTH": "a cloth simulation", "SOFT_BODY": "a soft body", "MESH_CACHE": "a mesh cache",
          "MESH_SEQUENCE_CACHE": "a cache of a file"}  # fmt: skip


class FixOperator(Job, bpy.types.Operator):
    """Move vertices of the selected cloth until nothing intersects, as a shape key"""

    bl_idname = "untangled.fix"
    bl_label = "Fix Cloth"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return context.mode == "OBJECT"

    def work(self, context):
        objects = selected(context)
        for obj in objects:
            for modifier in obj.modifiers if not is_body(obj) else ():
                if modifier.type in CACHED and modifier.show_viewport:
                    what = CACHED[modifier.type]
                    raise Unusable(f"{obj.name}: {what} moves its vertices: repair the shot, or the start state")
        ends = {obj: num_deforming(obj) for obj in objects if not is_body(obj)}
        words = yield from fixed(context, objects, ends, context.scene.untangled.gap)
        tell(self, context, words, words.startswith("clean"))


def tell(operator, context, words, clean):
    """Says how a repair ended. Paths that were found before it are drawn no more."""
    show(context, [], words)
    operator.report({"INFO" if clean else "WARNING"}, words)


def fixed(context, objects, ends, gap):
    """Repairs `objects` as so many of their modifiers leave them, and writes keys. Yields how far it is; its value says
    how it ended. `gap` is in Blender's units.

    After the keys are written, what Blender makes of them is repaired in its turn until it is clean.
    """
    for obj in ends:
        keys.check(obj)
    scale = metres(context.scene)
    options = gap * scale, context.scene.untangled.quality, context.scene.untangled.max_iterations
    written, largest = {}, 0.0
    try:
        with up_to(context, ends):
            world = evaluated(context, objects, scale)
            for number in range(ROUNDS):
                result = yield from _beside(number / ROUNDS, repair(world, *options))
                if (result.vertices == world.vertices).all():
                    break
                _write(context, objects, world, result.vertices, written)
                largest = max(largest, abs(result.vertices - world.vertices).max())
                world = evaluated(context, objects, scale)
                if not verdict(world, options[0]):
                    break
            return outcome(verdict(world, options[0]), result, written, largest)
    except GeneratorExit:
        for obj, key in written.items():
            obj.shape_key_remove(key)
        raise


def evaluated(context, objects, scale):
    return World.of([sheet(context, obj) for obj in objects], scale)


def _beside(share, steps):
    """What a generator of words returns; yields its words beside `share`."""
    try:
        while True:
            yield share, next(steps)
    except StopIteration as end:
        return end.value
    finally:
        steps.close()


def _write(context, objects, world, vertices, written):
    """Moves the keys of all objects so that they come to these `vertices` of the world."""
    for k, obj in enumerate(objects):
        move = world.displacements(k, vertices)
        if not is_body(obj) and move.any():
            if obj not in written:
                written[obj] = keys.add(obj)
            keys.move(context, obj, written[obj], move)


def outcome(left, result, written, largest):
    """How a repair ended, in words."""
    moved = f"moved by up to {1000 * largest:.3g} mm: " + ", ".join(obj.name for obj in written)
    if not left:
        return f"clean; {moved}" if written else "clean: nothing had to move"
    reasons = sorted({reason for *_, reason in [*result.blocked, *result.infeasible]})
    return f"not clean: {left}; {moved if written else 'nothing moved'}" + "".join(f"; {reason}" for reason in reasons)


def register():
    bpy.utils.register_class(FixOperator)


def unregister():
    bpy.utils.unregister_class(FixOperator)
