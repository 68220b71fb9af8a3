"""A repair, read in place in shared memory."""

from __future__ import annotations

from typing import Any, Dict

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._native import NativeRepair


class Repair:
    """The displacement of every vertex of one frame to a state without intersections.

    Or to the best state that was reached in its time. `displacement` is a read-only view into shared memory; a session
    lends one repair at a time, and an array that is a view of one holds it. What was handed out is taken as added:
    repairs of frames that were published before are dropped.
    """

    def __init__(self, native: NativeRepair) -> None:
        self._header: Dict[str, Any] = native.header()
        self.displacement: NDArray[np.floating[Any]] = np.asarray(native.displacements())
        """Metres, `num_vertices x 3`, in the precision of the session. A read-only view."""

    def repaired(self, positions: ArrayLike) -> NDArray[np.floating[Any]]:
        """`positions` (metres, `num_vertices x 3`) plus the displacement, added in the precision of the session.

        Of the positions of its frame, these are the bits that were checked.
        """
        return np.asarray(positions, dtype=self.displacement.dtype) + self.displacement

    @property
    def frame(self) -> int:
        """The frame whose positions the displacements are added to."""
        return self._header["frame"]

    @property
    def certified(self) -> bool:
        """Whether an exact check found no crossing in the repaired positions, and no cloth on the wrong side.

        The wrong side is the inside of a body, or behind an inner layer.
        """
        return self._header["certified"]

    @property
    def truncated(self) -> bool:
        """Whether its time was up: it leads to the best state so far."""
        return self._header["truncated"]

    @property
    def num_intersections(self) -> int:
        """Edges that pierce a face in the repaired state."""
        return self._header["num_edge_face_intersections"]

    @property
    def summary(self) -> Dict[str, Any]:
        """Counts, times, and how much the cloth changes, by name: the header of `proto/PROTOCOL.md`."""
        return dict(self._header)

    def __repr__(self) -> str:
        num_wrong = self._header["num_inside_body"] + self._header["num_behind"]
        left = f"{self.num_intersections} intersections left, {num_wrong} vertices on the wrong side"
        state = "certified" if self.certified else left
        return f"<untangled_cloth.Repair of frame {self.frame}: {state}>"
