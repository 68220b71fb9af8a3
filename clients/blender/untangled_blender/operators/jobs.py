"""Operators whose work goes on while the user sees how far it is, and may press Esc.

The work is a generator: it yields how far it is, from 0 to 1, and words, and cleans up in `finally`. What it changes
of the scene, it changes at its end, so that Esc leaves all as it was.
"""

import bpy

from ..plain.world import Unusable

TICK_S = 0.05


class Job:
    """Mixin of operators: `work(context)` is the generator."""

    def invoke(self, context, event):
        """Works modally: a tick of a timer is a step of the generator."""
        if bpy.app.background:
            return self.execute(context)
        self._steps = self.work(context)
        self._timer = context.window_manager.event_timer_add(TICK_S, window=context.window)
        context.window_manager.progress_begin(0, 100)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC":
            self._steps.close()
            self.report({"INFO"}, f"{self.bl_label}: cancelled, nothing was changed")
            return self._end(context, {"CANCELLED"})
        if event.type != "TIMER":
            # Nothing else may change the scene meanwhile.
            return {"RUNNING_MODAL"}
        try:
            share, words = next(self._steps)
        except StopIteration:
            return self._end(context, {"FINISHED"})
        except Unusable as error:
            self.report({"ERROR"}, str(error))
            return self._end(context, {"CANCELLED"})
        except BaseException:
            self._end(context, {"CANCELLED"})
            raise
        context.window_manager.progress_update(int(100 * share))
        context.workspace.status_text_set(f"{self.bl_label}: {words} (Esc cancels)")
        return {"RUNNING_MODAL"}

    def _end(self, context, result):
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        context.workspace.status_text_set(None)
        for area in context.screen.areas:
            area.tag_redraw()
        return result

    def execute(self, context):
        """Works until it is done, as scripts want it."""
        try:
            for _ in self.work(context):
                pass
        except Unusable as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}
