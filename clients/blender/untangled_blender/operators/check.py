"""Checks the selected objects: paths to draw and to list, and vertices on the wrong side."""

import bpy
import numpy as np
import untangled_cloth as untangled

from .. import overlay
from ..plain.findings import findings, segments_by_type, summary, wrong_vertices
from ..plain.world import Unusable, World
from ..sheets import is_body, metres, selected, sheets

GROUP = "Untangled inside"
"""Vertex group of vertices on the wrong side."""


class CheckOperator(bpy.types.Operator):
    """Find where the selected objects pass through themselves and each other"""

    bl_idname = "untangled.check"
    bl_label = "Check Cloth"
    bl_options = {"REGISTER", "UNDO"}

    mark: bpy.props.BoolProperty(
        name="Mark Vertices",
        description=f"Select vertices on the wrong side, and put them into the vertex group '{GROUP}'",
        default=True,
    )

    @classmethod
    def poll(cls, context):
        return context.mode == "OBJECT"

    def execute(self, context):
        try:
            objects = selected(context)
            world = World.of(sheets(context, objects), metres(context.scene))
            analysis = untangled.analyse(world.vertices, world.triangles, **world.roles())
        except (Unusable, ValueError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        found = findings(world, analysis)
        words = summary(found, analysis)
        show(context, found, words)
        if self.mark:
            for k, obj in enumerate(objects):
                if not is_body(obj):
                    mark(obj, wrong_vertices(world, analysis, k))
        self.report({"WARNING" if not words.startswith("clean") else "INFO"}, words)
        return {"FINISHED"}


def show(context, found, words):
    """Fills the list and the overlay."""
    listed = context.window_manager.untangled
    listed.summary = words
    listed.paths.clear()
    for finding in found:
        entry = listed.paths.add()
        entry.name, entry.objects, entry.length = finding.pair_type, finding.objects, finding.length
        entry.centre, entry.radius = finding.centre, finding.radius
    listed.active = 0
    overlay.show(segments_by_type(found))


def mark(obj, wrong):
    """Selects these vertices of an object, and no others, and makes them its vertex group; none, and it loses it."""
    group = obj.vertex_groups.get(GROUP)
    if group is not None:
        obj.vertex_groups.remove(group)
    if len(wrong):
        obj.vertex_groups.new(name=GROUP).add(wrong.tolist(), 1.0, "REPLACE")
    chosen = np.zeros(len(obj.data.vertices), bool)
    chosen[wrong] = True
    obj.data.vertices.foreach_set("select", chosen)
    # An edge or a face that stays selected would select its vertices again. Without these attributes none is selected;
    # to set them all crashes Blender 5.0 where there are none.
    for name in (".select_edge", ".select_poly"):
        attribute = obj.data.attributes.get(name)
        if attribute is not None:
            obj.data.attributes.remove(attribute)


class JumpOperator(bpy.types.Operator):
    """Look at this place, and put the 3D cursor there"""

    bl_idname = "untangled.jump"
    bl_label = "Jump to Path"
    bl_options = {"REGISTER", "UNDO"}

    index: bpy.props.IntProperty()

    def execute(self, context):
        paths = context.window_manager.untangled.paths
        if not 0 <= self.index < len(paths):
            return {"CANCELLED"}
        place = paths[self.index]
        context.window_manager.untangled.active = self.index
        context.scene.cursor.location = place.centre
        view = getattr(context, "region_data", None)
        if view is not None:
            view.view_location = place.centre
            view.view_distance = max(4 * place.radius, 0.05)
        return {"FINISHED"}


class ClearOperator(bpy.types.Operator):
    """Draw and list nothing any more"""

    bl_idname = "untangled.clear"
    bl_label = "Clear Paths"

    def execute(self, context):
        show(context, [], "")
        return {"FINISHED"}


CLASSES = CheckOperator, JumpOperator, ClearOperator


@bpy.app.handlers.persistent
def forget(*_):
    """What was found in one file says nothing of the next."""
    show(bpy.context, [], "")


def register():
    for found in CLASSES:
        bpy.utils.register_class(found)
    bpy.app.handlers.load_post.append(forget)


def unregister():
    bpy.app.handlers.load_post.remove(forget)
    for found in reversed(CLASSES):
        bpy.utils.unregister_class(found)
