"""A repair of one state in a thread, watched and not waited for. Nothing here needs Blender."""

from __future__ import annotations

import threading
import time

import untangled_cloth as untangled

from .world import Unusable, World

PAUSE_S = 0.01
GAP_MARGIN = 1e-4
"""Share of a gap that is added to it, so that what is rounded afterwards keeps it."""


def repair(world: World, gap: float, quality: str, max_iterations: int):
    """A generator: yields words while it works; its value is what `untangled_cloth.fix` returns. `close` stops it.

    `gap` is in metres, 0 for none.
    """
    state = {"words": "looking for intersections", "stop": False}

    def progress(now):
        state["words"] = f"iteration {now.num_iterations}: {now.num_intersections} edges pierce a face"
        return not state["stop"]

    def run():
        try:
            state["result"] = untangled.fix(
                world.vertices,
                world.triangles,
                **world.roles(),
                gap=gap * (1 + GAP_MARGIN) if gap > 0 else None,
                quality=quality,
                max_iterations=max_iterations,
                progress=progress,
            )
        except Exception as error:
            state["error"] = error

    thread = threading.Thread(target=run)
    thread.start()
    try:
        while thread.is_alive():
            yield state["words"]
            time.sleep(PAUSE_S)
    finally:
        state["stop"] = True
        thread.join()
    if "error" in state:
        raise Unusable(str(state["error"])) from state["error"]
    return state["result"]


def verdict(world: World, gap: float) -> str:
    """What is not clean in a state, in words, by a check that shares no code with the repair; empty where all is."""
    judged = untangled.fix(
        world.vertices, world.triangles, **world.roles(), gap=gap if gap > 0 else None, max_iterations=0
    )
    words = {
        "edges pierce a face": judged.num_intersections,
        "vertices are inside of a body": judged.num_inside_body,
        "vertices are behind an inner layer": judged.num_behind,
        "pairs are nearer than the gap": judged.num_pairs_below,
    }
    return ", ".join(f"{number} {what}" for what, number in words.items() if number)
