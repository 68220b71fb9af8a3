"""What adapters do with repairs: they wait for that of this frame, or take one that came late where it still helps."""

from __future__ import annotations

from typing import Any, Dict, Optional

import numpy as np
from numpy.typing import NDArray

from .. import Missed, Session, count_intersections
from ..correction import Correction

REPAIRS = ("never", "auto", "always")

_Array = NDArray[np.floating[Any]]


def with_repair(settings: Any, repair: str) -> Dict[str, Any]:
    """The settings of a session whose frames are repaired `never`, `always`, or where a tangle does not shrink."""
    if repair not in REPAIRS:
        raise ValueError(f"repair must be one of {', '.join(REPAIRS)}, not {repair!r}")
    return {**({} if repair == "never" else {"repair": repair}), **(settings or {})}


def displacement(
    session: Session, triangles: NDArray[Any], correction: Correction, positions: _Array, deadline: float
) -> Optional[_Array]:
    """The displacement to add to `positions`, which were the frame of `correction`; None where there is no repair.

    Waits up to `deadline` seconds for the repair of this frame. One of an earlier frame that came too late, or one that
    is not certified, is taken only if fewer edges pierce a face with it than without.
    """
    if not session.has_repairs:
        return None
    if correction.being_repaired:
        try:
            repair = session.wait_repair(correction.frame, deadline=deadline)
        except Missed:
            return None
    else:
        repair = session.poll_repair()
    if repair is None:
        return None
    moves = np.array(repair.displacement)
    if not (repair.certified and repair.frame == correction.frame):
        moved = repair.repaired(positions)
        if count_intersections(moved, triangles) >= count_intersections(positions, triangles):
            return None
    return moves


def slowed(velocities: _Array, moves: _Array, dt: float) -> _Array:
    """Velocities after a repair: what leads back along the displacement goes, up to what would undo it within `dt`.

    All else is kept, so that cloth that falls goes on falling, and a vertex that was hardly moved is hardly slowed.
    """
    length = np.linalg.norm(moves, axis=1, keepdims=True)
    direction = np.divide(moves, length, out=np.zeros_like(moves), where=length > 0)
    back = np.maximum(-(velocities * direction).sum(axis=1, keepdims=True), 0)
    return velocities + np.minimum(back, length / dt) * direction
