"""Which contacts of the simulator's own have to be off while a tangle comes apart."""

from __future__ import annotations

from typing import Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays
from ._native import NativeContactFilter
from .correction import Correction


class ContactFilter:
    """Says of contacts whether they have to be off: those between the two sides of one tangle, and no others.

    A simulator's self-contact defends a tangle. The flags of a correction switch off all contacts of a vertex, and what
    leans on it falls through; labels switch off no more than the tangle. The contact between two ends (a vertex and a
    triangle, or two edges) is off where both ends, each with the labels of all its vertices, have labels of one pair
    whose sides, or-ed, give 3. A label is `4 * pair + side`; 0xFFFFFFFF is of both sides of every pair.

    ::

        session = untangled.Session(triangles, masses=masses, labels=True)
        contacts = untangled.ContactFilter(session.num_vertices)
        correction = session.exchange(positions)
        contacts.set(correction)
        pairs = pairs[~contacts.vertex_face_off(pairs[:, 0], triangles[pairs[:, 1]])]

    Arrays are numpy's, or what has them as memory of the host (`wp.array`, PyTorch). Indices below zero or beyond the
    cloth have no labels: so lists with holes can be passed as they are. Any thread may use it, one at a time; it works
    without the interpreter's lock.
    """

    def __init__(self, num_vertices: int) -> None:
        self.num_vertices = num_vertices
        """Number of vertices."""
        self._native = NativeContactFilter(num_vertices)

    def set(self, labels: Union[Correction, ArrayLike]) -> None:
        """Takes the labels of a correction, or an array of them (`n x 2`: vertex, label), in place of those before."""
        given = labels.labels if isinstance(labels, Correction) else _arrays.indices("labels", labels, 2)
        self._native.set(given.tobytes())

    def vertex_face_off(self, vertices: ArrayLike, faces: ArrayLike) -> NDArray[np.bool_]:
        """Whether contacts of a vertex each with a triangle each are off.

        `vertices` holds `n` indices, `faces` `n x 3`, the corners. Returns `n` of bool, writable.
        """
        ends = _arrays.contact_ends("vertices", vertices, 1), _arrays.contact_ends("faces", faces, 3)
        return _bools(self._native.vertex_faces_off(*ends))

    def edge_edge_off(self, first: ArrayLike, second: ArrayLike) -> NDArray[np.bool_]:
        """Whether contacts of two edges each are off; `first` and `second` hold `n x 2` indices of vertices."""
        ends = _arrays.contact_ends("first", first, 2), _arrays.contact_ends("second", second, 2)
        return _bools(self._native.edge_edges_off(*ends))


def _bools(off: bytes) -> NDArray[np.bool_]:
    return np.frombuffer(off, np.bool_).copy()
