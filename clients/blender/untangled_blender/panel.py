"""The sidebar of the 3D viewport."""

import bpy

from .plain.findings import LEGEND
from .sheets import is_body


class PathList(bpy.types.UIList):
    """One line for each pair of paths."""

    bl_idname = "UNTANGLED_UL_paths"

    def draw_item(self, context, layout, data, item, icon, active_data, active_property, index=0, flt_flag=0):
        row = layout.row()
        row.label(text=f"{item.name}  {1000 * item.length:.3g} mm")
        row.label(text=item.objects)
        row.operator("untangled.jump", text="", icon="VIEWZOOM").index = index


class Panel(bpy.types.Panel):
    """Check and repair cloth."""

    bl_idname = "UNTANGLED_PT_panel"
    bl_label = "Untangled Cloth"
    bl_space_type, bl_region_type, bl_category = "VIEW_3D", "UI", "Untangled"

    def draw(self, context):
        layout, obj = self.layout, context.object
        if obj is not None and obj.type == "MESH":
            box = layout.box()
            box.label(text=obj.name, icon="MESH_DATA")
            box.prop(obj.untangled, "role", expand=True)
            if not is_body(obj):
                box.prop(obj.untangled, "layer")
                box.prop_search(obj.untangled, "pins", obj, "vertex_groups")
        layout.operator("untangled.check", icon="VIEWZOOM")
        self.draw_found(context, layout)
        column = layout.column()
        for name in ("gap", "quality", "max_iterations"):
            column.prop(context.scene.untangled, name)
        layout.operator("untangled.fix", icon="MOD_CLOTH")
        layout.operator("untangled.start", icon="PLAY")
        shot = layout.operator("untangled.shot", icon="RENDER_ANIMATION")
        shot.first, shot.last = context.scene.frame_start, context.scene.frame_end

    def draw_found(self, context, layout):
        found = context.window_manager.untangled
        if not found.summary:
            return
        layout.label(text=found.summary)
        if found.paths:
            layout.template_list(PathList.bl_idname, "", found, "paths", found, "active", rows=4)
            row = layout.row()
            row.operator("untangled.curves")
            row.operator("untangled.clear")
            column = layout.column(align=True)
            for kind, colour in LEGEND.items():
                column.label(text=f"{kind}: {colour}")


CLASSES = PathList, Panel


def register():
    for found in CLASSES:
        bpy.utils.register_class(found)


def unregister():
    for found in reversed(CLASSES):
        bpy.utils.unregister_class(found)
