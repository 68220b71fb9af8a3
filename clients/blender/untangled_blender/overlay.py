"""Intersection paths over the viewport, in a colour for each type. They are drawn through the cloth."""

import bpy
import gpu
from gpu_extras.batch import batch_for_shader

from .plain.findings import COLOURS

WIDTH = 4.0
"""Pixels."""
_shown = {}
_batches = None
_handle = None


def show(segments):
    """Draws these ends of segments, type by type, from now on."""
    global _batches
    _shown.clear()
    _shown.update(segments)
    _batches = None
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()


def shown():
    """What is drawn: `2 n x 3` ends of segments for each type."""
    return _shown


def draw():
    """Called by Blender for each view."""
    global _batches
    if not _shown:
        return
    shader = gpu.shader.from_builtin("POLYLINE_UNIFORM_COLOR")
    if _batches is None:
        _batches = {
            kind: batch_for_shader(shader, "LINES", {"pos": ends.astype("f4")}) for kind, ends in _shown.items()
        }
    gpu.state.depth_test_set("NONE")
    gpu.state.blend_set("ALPHA")
    shader.bind()
    shader.uniform_float("viewportSize", gpu.state.viewport_get()[2:])
    shader.uniform_float("lineWidth", WIDTH * bpy.context.preferences.system.ui_scale)
    for kind, batch in _batches.items():
        shader.uniform_float("color", (*COLOURS[kind], 1.0))
        batch.draw(shader)
    gpu.state.blend_set("NONE")


def register():
    global _handle
    if not bpy.app.background:
        _handle = bpy.types.SpaceView3D.draw_handler_add(draw, (), "WINDOW", "POST_VIEW")


def unregister():
    global _handle
    if _handle is not None:
        bpy.types.SpaceView3D.draw_handler_remove(_handle, "WINDOW")
        _handle = None
    _shown.clear()
