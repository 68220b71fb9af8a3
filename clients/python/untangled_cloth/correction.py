"""A correction, read in place in shared memory."""

from __future__ import annotations

from typing import Any, Dict, Iterator, NamedTuple, Optional, Sequence, overload

import numpy as np
from numpy.typing import NDArray

from ._native import Error, NativeCorrection

KINDS = ("force", "acceleration", "velocity", "displacement")
PAIR_TYPES = ("CLOSED/CLOSED", "EIGHT", "LL", "BLI", "BLB", "BLLB", "CROSS", "BB/II", "BB/BI", "BB/BB", "BI/BI")
PATH_TYPES = ("CLOSED", "LL", "BLI", "BLB", "BB", "BI", "II")
PATH_STATES = ("unknown", "region", "no region", "left out")


class Path:
    """One intersection path. Arrays are read-only views into shared memory."""

    def __init__(
        self, record: NDArray[np.uint32], points: NDArray[np.float64], faces: NDArray[np.uint32]
    ) -> None:
        pair, pair_type, path_type, partner, closed, first, count, state = (int(word) for word in record)
        # The daemon wrote these numbers; slices stay within the points that were received, for any numbers.
        self.points = points[first : first + count]
        """World positions in metres, `num_points x 3`."""
        self.faces = faces[first : first + count]
        """The face that the path runs through after each point, and the partner's, `num_points x 2`."""
        self.pair = pair
        """Which pair it belongs to."""
        self.pair_type = PAIR_TYPES[pair_type] if pair_type < len(PAIR_TYPES) else "?"
        """Type of that pair, as in `untangled_cloth.correction.PAIR_TYPES`."""
        self.type = PATH_TYPES[path_type] if path_type < len(PATH_TYPES) else "?"
        """Type of this path, as in `untangled_cloth.correction.PATH_TYPES`."""
        self.partner = partner
        """Index of the corresponding path; its own where it is its own."""
        self.closed = closed != 0
        """Whether it is a loop on the cloth."""
        self.state = PATH_STATES[state] if state < len(PATH_STATES) else "?"
        """What became of it, as in `untangled_cloth.correction.PATH_STATES`: `unknown` but for observers.

        `region`: its pair has vertices inside; `no region`: it has none; `left out`: time was up before.
        """

    def __repr__(self) -> str:
        return f"<untangled_cloth.Path {self.type} of {self.pair_type}, {len(self.points)} points>"


class Paths(Sequence[Path]):
    """The intersection paths of a frame. Arrays are read-only views into shared memory."""

    def __init__(
        self, records: NDArray[np.uint32], points: NDArray[np.float64], faces: NDArray[np.uint32]
    ) -> None:
        self.records = records
        """`num_paths x 8`, as on the wire.

        Pair, pair type, path type, partner, closed, first point, number of points, state.
        """
        self.points = points
        """Points of all paths in metres, `num_points x 3`."""
        self.faces = faces
        """Faces at all points, `num_points x 2`."""

    def __len__(self) -> int:
        return len(self.records)

    @overload
    def __getitem__(self, index: int) -> Path: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Path]: ...
    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return [self[k] for k in range(*index.indices(len(self)))]
        return Path(self.records[index], self.points, self.faces)

    def __iter__(self) -> Iterator[Path]:
        return (self[k] for k in range(len(self)))


class Entries(NamedTuple):
    """The vertices that have a value or a flag other than pinned, ascending."""

    vertices: NDArray[np.uint32]
    """Their indices, `num_entries` of uint32."""
    values: NDArray[np.float32]
    """Their corrections in the unit of `kind`, `num_entries x 3` of float32."""
    flags: NDArray[np.uint32]
    """Their flags, `num_entries` of uint32: `untangled_cloth.INSIDE` and so on."""


class Correction:
    """The correction of one frame.

    `value`, `force`, `flags` and `paths` are read-only views into shared memory, without a copy. A session lends three
    corrections at a time, and an array that is a view of one holds it: copy what is to be kept
    or changed (`correction.force.copy()`). Views stay valid for as long as they live, even after the session is closed
    and the daemon has ended. As a context manager a correction releases its own views at the end.
    """

    def __init__(self, native: NativeCorrection) -> None:
        self._native: Optional[NativeCorrection] = native
        self._header: Dict[str, Any] = native.header()
        self._cache: Dict[str, Any] = {}

    def _view(self, name: str, make: Any) -> Any:
        if self._native is None:
            raise Error("the correction was released")
        if name not in self._cache:
            self._cache[name] = make(self._native)
        return self._cache[name]

    @property
    def value(self) -> NDArray[np.float32]:
        """The correction of each vertex in the unit of `kind`, `num_vertices x 3` of float32. A read-only view."""
        return self._view("value", lambda native: np.asarray(native.values()))

    @property
    def force(self) -> NDArray[np.float32]:
        """`value` of a session with `correction="force"`, in newtons; else an error. A read-only view."""
        if self.kind != "force":
            hint = 'use `value`, or Session(..., correction="force")'
            raise Error(f"the session asked for {self.kind}, not for force: {hint}")
        return self.value

    @property
    def flags(self) -> NDArray[np.uint32]:
        """Flags of each vertex, `num_vertices` of uint32: `untangled_cloth.INSIDE` and so on. A read-only view."""
        return self._view("flags", lambda native: np.asarray(native.flags()))

    @property
    def entries(self) -> Entries:
        """The vertices that have a value or a flag other than pinned.

        Of a session with `sparse=True` or `labels=True` read-only views into shared memory; otherwise picked from
        `value` and `flags` once. `value` and `flags` of such a session are views of memory that the entries were
        written into when they were first asked for.
        """

        def make(native: NativeCorrection) -> Entries:
            parts = native.entries()
            if parts is not None:
                return Entries(*(np.asarray(part) for part in parts))
            pinned = np.uint32(8)
            chosen = np.flatnonzero(((self.flags & ~pinned) != 0) | (self.value.view(np.uint32) != 0).any(axis=1))
            return Entries(chosen.astype(np.uint32), self.value[chosen], self.flags[chosen])

        return self._view("entries", make)

    @property
    def labels(self) -> NDArray[np.uint32]:
        """Labels of vertices, `num_labels x 2` of uint32 (vertex, label), for :class:`untangled_cloth.ContactFilter`.

        Empty without `Session(..., labels=True)`, or from a daemon that is too old. A read-only view.
        """
        return self._view("labels", lambda native: np.asarray(native.labels()))

    @property
    def inside(self) -> NDArray[np.bool_]:
        """Whether each vertex is inside, `num_vertices` of bool. Made from `flags` once, writable."""
        return self._view("inside", lambda _: (self.flags & 1) != 0)

    @property
    def mask(self) -> NDArray[np.bool_]:
        """Where the host's self-collision has to be off, `num_vertices` of bool. Made from `flags` once, writable."""
        return self._view("mask", lambda _: (self.flags & 3) != 0)

    @property
    def paths(self) -> Optional[Paths]:
        """The intersection paths; None without `Session(..., paths=True)`, or where shared memory did not hold them."""

        def make(native: NativeCorrection) -> Optional[Paths]:
            parts = native.paths()
            return None if parts is None else Paths(*(np.asarray(part) for part in parts))

        return self._view("paths", make)

    @property
    def frame(self) -> int:
        """The frame that it is for."""
        return self._header["frame"]

    @property
    def kind(self) -> str:
        """What the values are: force, acceleration, velocity or displacement."""
        return KINDS[self._header["kind"]]

    @property
    def being_repaired(self) -> bool:
        """Whether a repair of the frame is going to come: see `Session.wait_repair`."""
        return self._header["being_repaired"]

    @property
    def num_intersections(self) -> int:
        """Number of edges that pierce a face."""
        return self._header["num_edge_face_intersections"]

    @property
    def num_inside(self) -> int:
        """Number of vertices inside."""
        return self._header["num_inside"]

    @property
    def summary(self) -> Dict[str, Any]:
        """Counts, times, and force and torque left over, by name: the header of `proto/PROTOCOL.md`."""
        return dict(self._header)

    def release(self) -> None:
        """Releases the views that this object keeps; those of the caller stay valid."""
        self._native = None
        self._cache.clear()

    def __enter__(self) -> "Correction":
        return self

    def __exit__(self, *_: Any) -> None:
        self.release()

    def __repr__(self) -> str:
        counts = f"{self.num_intersections} intersections, {self.num_inside} inside"
        return f"<untangled_cloth.Correction of frame {self.frame}: {counts}>"
