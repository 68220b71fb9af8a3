"""Progress and Esc, with a window that is made up: this Blender has none."""

from types import SimpleNamespace

import pytest


class Window:
    """What a job uses of a context."""

    def __init__(self):
        self.told, self.timers, self.window = [], 0, None
        self.window_manager = self.workspace = self
        self.screen = SimpleNamespace(areas=[SimpleNamespace(tag_redraw=lambda: None)])
        self.progress_begin = lambda *_: None
        self.progress_end = lambda: None
        self.modal_handler_add = lambda job: None
        self.progress_update = self.told.append
        self.status_text_set = self.told.append

    def event_timer_add(self, *_, **__):
        self.timers += 1

    def event_timer_remove(self, timer):
        self.timers -= 1


@pytest.fixture
def job(registered, monkeypatch):
    from untangled_blender.operators import jobs

    class Made(jobs.Job):
        bl_label = "Made"
        ended = False
        fails = None

        def work(self, context):
            try:
                yield 0.5, "half"
                if self.fails:
                    raise self.fails
                yield 1.0, "all"
            finally:
                self.ended = True

        def report(self, kind, words):
            self.reported = kind, words

    monkeypatch.setattr(jobs, "bpy", SimpleNamespace(app=SimpleNamespace(background=False)))
    return Made()


def tick(kind):
    return SimpleNamespace(type=kind)


def test_job_shows_how_far_it_is_and_ends_with_its_work(job):
    window = Window()
    assert job.invoke(window, None) == {"RUNNING_MODAL"} and window.timers == 1
    assert job.modal(window, tick("TIMER")) == {"RUNNING_MODAL"}
    assert window.told == [50, "Made: half (Esc cancels)"]
    assert job.modal(window, tick("MOUSEMOVE")) == {"RUNNING_MODAL"} and len(window.told) == 2
    job.modal(window, tick("TIMER"))
    assert job.modal(window, tick("TIMER")) == {"FINISHED"}
    assert window.timers == 0 and window.told[-1] is None


def test_job_is_ended_by_esc_and_cleans_up(job):
    window = Window()
    job.invoke(window, None)
    job.modal(window, tick("TIMER"))
    assert job.modal(window, tick("ESC")) == {"CANCELLED"}
    assert job.ended and window.timers == 0 and "cancelled" in job.reported[1]


def test_job_that_fails_says_so_and_leaves_no_timer(job):
    from untangled_blender.plain.world import Unusable

    window = Window()
    job.fails = Unusable("cloth: it has no faces")
    job.invoke(window, None)
    job.modal(window, tick("TIMER"))
    assert job.modal(window, tick("TIMER")) == {"CANCELLED"}
    assert job.reported == ({"ERROR"}, "cloth: it has no faces") and window.timers == 0
    job.fails = ZeroDivisionError()
    job.invoke(window, None)
    job.modal(window, tick("TIMER"))
    with pytest.raises(ZeroDivisionError):
        job.modal(window, tick("TIMER"))
    assert window.timers == 0
