"""A session: one cloth, its frames and its corrections."""

from __future__ import annotations

import json
from contextlib import contextmanager
from typing import Any, Dict, Iterator, Mapping, Optional

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from . import _arrays
from ._native import FrameRefused, NativeSession
from ._native import status as _status
from .correction import KINDS, Correction
from .repair import Repair


class Session:
    """One cloth that the daemon knows.

    It connects to the daemon of `domain` (else the environment variable `UNTANGLED_DOMAIN`, else `default`), waiting
    up to `timeout` seconds for it to start, and registers the cloth. When the daemon died or was restarted, that frame
    raises :class:`untangled_cloth.Missed`, and a later one registers the session again.

    Any thread may use it, one at a time; it waits without the interpreter's lock.

    Args:
        triangles: vertex indices, `num_triangles x 3`.
        uv: texture coordinates, `n x 2`; one for each vertex unless `uv_triangles` says otherwise.
        uv_triangles: the texture coordinate of each corner, `num_triangles x 3`.
        num_vertices: by default the length of `masses`, `rest_positions` or `layers`, and at least the highest index
            plus one.
        rest_positions: unstrained positions in metres, `num_vertices x 3`.
        masses: kilograms, `num_vertices`; needed for forces.
        pins: vertices that the simulator does not let move.
        layers: of each vertex, from the body outwards.
        body: vertices of bodies: the simulator alone moves them, cloth belongs outside of them, and they get no
            corrections. A triangle has all of its corners among them, or none.
        correction: "force" (N), "acceleration" (m/s^2), "velocity" (change, m/s) or "displacement" (m); by default
            force where there are masses, else displacement.
        dtype: float32 or float64: the precision in which positions are sent.
        paths: whether corrections bring the intersection paths.
        repairs: whether frames may be repaired, see :meth:`repair`. Takes shared memory for four frames more.
        sparse: whether corrections list only the vertices that have a value or a flag (`correction.entries`): an
            untangled frame then costs nothing for each vertex. They read the same either way.
        labels: whether corrections have labels, by which :class:`untangled_cloth.ContactFilter` says of single contacts
            whether they have to be off; makes them sparse as well.
        weld: whether vertices with exactly one place in `rest_positions` are one along seams, for meshes that were
            split for texture coordinates or normals; see :attr:`num_welded_vertices`. They have to be in one place in
            each state, and corrections keep them there. Without rest positions, give those with which the motion
            begins, and the same ones whenever the cloth is registered again.
        settings: by name, as in `untangled config`, section `settings`; besides, `quality`. Numbers of numpy are
            taken for what they are.
        dt: length of a step in seconds, where a call does not say another; 1e-9 to 1e9.

    Raises:
        NoDaemon, Refused (the message names the element at fault), ValueError, TypeError.
    """

    def __init__(
        self,
        triangles: ArrayLike,
        uv: Optional[ArrayLike] = None,
        *,
        uv_triangles: Optional[ArrayLike] = None,
        num_vertices: Optional[int] = None,
        rest_positions: Optional[ArrayLike] = None,
        masses: Optional[ArrayLike] = None,
        pins: Optional[ArrayLike] = None,
        layers: Optional[ArrayLike] = None,
        body: Optional[ArrayLike] = None,
        correction: Optional[str] = None,
        dtype: DTypeLike = np.float32,
        paths: bool = False,
        repairs: bool = False,
        sparse: bool = False,
        labels: bool = False,
        weld: bool = False,
        settings: Optional[Mapping[str, Any]] = None,
        dt: float = 1 / 60,
        domain: Optional[str] = None,
        timeout: float = 5.0,
    ) -> None:
        if num_vertices is None:
            num_vertices = _arrays.count_vertices(triangles, masses, rest_positions, layers)
        if correction is None:
            correction = "displacement" if masses is None else "force"
        if correction not in KINDS:
            raise ValueError(f"correction must be one of {', '.join(KINDS)}, not {correction!r}")
        self.dtype = np.dtype(dtype)
        """Precision in which positions are sent."""
        if self.dtype not in (np.float32, np.float64):
            raise TypeError(f"dtype must be float32 or float64, not {self.dtype}")
        self.num_vertices = num_vertices
        """Number of vertices."""
        self.correction = correction
        """What corrections are."""
        self.dt = dt
        """Length of a step in seconds, where a call does not say another."""
        self.time = 0.0
        """Simulated time in seconds of the next frame; each frame that was published, and not refused, adds its `dt`.
        """
        self._time_before = 0.0
        cloth = _arrays.cloth(num_vertices, triangles, uv, uv_triangles, rest_positions, pins, layers, body)
        weights = None if masses is None else _arrays.numbers("masses", masses, 1, num_vertices).tobytes()
        self._native = NativeSession(
            domain=domain,
            timeout_s=timeout,
            num_vertices=num_vertices,
            masses=weights,
            double=self.dtype == np.float64,
            kind=correction,
            paths=paths,
            repairs=repairs,
            sparse=sparse,
            labels=labels,
            weld=weld,
            settings=_arrays.document(settings),
            **cloth,  # type: ignore[arg-type]
        )

    def exchange(
        self,
        positions: ArrayLike,
        dt: Optional[float] = None,
        *,
        time: Optional[float] = None,
        deadline: Optional[float] = None,
    ) -> Correction:
        """Publishes `positions` (metres, `num_vertices x 3`) and waits up to `deadline` seconds for their correction.

        This is lock step. Positions of any precision and strides are written directly into shared memory. Without a
        `deadline`, :attr:`default_deadline` holds.

        Raises:
            Missed: no correction this time. Go on without it; the next call tries again.
            FrameRefused: a position is not finite, or `dt` or `time` can't be used. :attr:`time` is as before.
        """
        given = _arrays.host("positions", positions)
        if given.shape != (self.num_vertices, 3):
            raise ValueError(f"positions must be of shape {(self.num_vertices, 3)}, not {given.shape}")
        deadline = self._checked(deadline)
        with self.frame(dt, time=time) as slots:
            np.copyto(slots, given, casting="same_kind")
        return self.wait(deadline=deadline)

    @contextmanager
    def frame(self, dt: Optional[float] = None, *, time: Optional[float] = None) -> Iterator[NDArray[np.floating[Any]]]:
        """Lends the memory of the next frame, `num_vertices x 3`: write every position in it, in metres.

        The end of the block publishes the frame, an exception drops it. The array can't be written after that; other
        views of it must not be.

        Raises:
            Missed: the daemon went away; this frame is lost.
            FrameRefused: `dt` or `time` can't be used; nothing was lent.
        """
        step = self.dt if dt is None else dt
        now = self.time if time is None else time
        slots = np.asarray(self._native.begin(now, step))
        try:
            yield slots
        except BaseException:
            slots.flags.writeable = False
            self._native.abandon()
            raise
        slots.flags.writeable = False
        self._native.send()
        self._time_before, self.time = self.time, now + step

    def wait(self, frame: Optional[int] = None, *, deadline: Optional[float] = None) -> Correction:
        """The correction of a frame, by default of the last one that was published. See :meth:`exchange`."""
        deadline = self._checked(deadline)
        try:
            return Correction(self._native.wait(self._native.frame if frame is None else frame, deadline))
        except FrameRefused as refusal:
            self._take_back(refusal)
            raise

    def newest(self) -> Optional[Correction]:
        """The newest correction that has come since the last call, if any: free running. Does not wait."""
        try:
            native = self._native.newest()
        except FrameRefused as refusal:
            self._take_back(refusal)
            raise
        return None if native is None else Correction(native)

    def repair(
        self,
        positions: ArrayLike,
        dt: Optional[float] = None,
        *,
        time: Optional[float] = None,
        deadline: float = 60.0,
    ) -> Repair:
        """Publishes `positions` (metres, `num_vertices x 3`) and waits up to `deadline` seconds for their repair.

        One exchange from a tangled cloth to one that is certified clean, or to the best that is reached in time. For
        sessions with `repairs=True`. See :meth:`exchange` for the arguments.

        Raises:
            Missed: no repair within the deadline; it may still come, see :meth:`poll_repair`.
            FrameRefused: the frame can't be used.
        """
        given = _arrays.host("positions", positions)
        if given.shape != (self.num_vertices, 3):
            raise ValueError(f"positions must be of shape {(self.num_vertices, 3)}, not {given.shape}")
        deadline = self._checked(deadline)
        self.ask_for_repair(deadline)
        with self.frame(dt, time=time) as slots:
            np.copyto(slots, given, casting="same_kind")
        return self.wait_repair(deadline=deadline)

    def ask_for_repair(self, time: Optional[float] = None) -> None:
        """Asks for a repair of the next frame that is published, by whatever call.

        Its correction comes as ever; the repair comes beside it when it is done, see :meth:`poll_repair`. With `time`
        the daemon sends the best state so far early enough to be here within so many seconds; otherwise the setting
        `repair_deadline_us` limits it.
        """
        self._native.ask_for_repair(time)

    def wait_repair(self, frame: Optional[int] = None, *, deadline: float = 60.0) -> Repair:
        """The repair of a frame, by default of the last one that was published. See :meth:`repair`."""
        deadline = self._checked(deadline)
        try:
            return Repair(self._native.wait_repair(self._native.frame if frame is None else frame, deadline))
        except FrameRefused as refusal:
            self._take_back(refusal)
            raise

    def poll_repair(self) -> Optional[Repair]:
        """The newest repair that has come since the last call, if any. Does not wait.

        Add it to the positions of its frame, or to those of now: a displacement of the cloth stays right for as long as
        it hangs as it hung then.
        """
        native = self._native.poll_repair()
        return None if native is None else Repair(native)

    def begin_motion(self) -> None:
        """Says that the next frame is no continuation of those before.

        With the setting `repair` = `auto` the daemon then begins anew to judge progress.
        """
        self._native.begin_motion()

    @property
    def has_repairs(self) -> bool:
        """Whether the session was registered with `repairs=True`, by a daemon that knows them."""
        return self._native.has_repairs

    def _take_back(self, refusal: FrameRefused) -> None:
        """A frame that was refused takes no simulated time, unless newer ones were published."""
        if refusal.frame == self._native.frame:
            self.time = self._time_before

    def _checked(self, deadline: Optional[float]) -> float:
        """Before anything is published."""
        deadline = self.default_deadline if deadline is None else float(deadline)
        if not deadline >= 0:
            raise ValueError(f"deadline must be a number of seconds that is not negative, not {deadline}")
        return deadline

    def update_settings(self, settings: Mapping[str, Any], *, timeout: float = 5.0) -> None:
        """Replaces the settings from the next frame on; names left out take the daemon's defaults."""
        self._native.update_settings(_arrays.document(settings), timeout)

    @property
    def default_deadline(self) -> float:
        """How long calls without a deadline wait, in seconds: 0.2, and 20 microseconds for each triangle.

        That leaves room for a busy machine. A host that has a frame rate to keep passes its own `deadline`.
        """
        return self._native.default_deadline_s

    @property
    def last_frame(self) -> int:
        """Number of the last frame that was published; 0 before the first."""
        return self._native.frame

    @property
    def num_welded_vertices(self) -> int:
        """Vertices that became one with an earlier one in their place, where `weld` asked for that; else 0."""
        return self._native.num_welded_vertices

    @property
    def is_sparse(self) -> bool:
        """Whether corrections come sparse, as asked for: not from a daemon that is too old."""
        return self._native.is_sparse

    @property
    def has_labels(self) -> bool:
        """Whether corrections have labels, as asked for: not from a daemon that is too old."""
        return self._native.has_labels

    @property
    def num_registrations(self) -> int:
        """How often the session was registered: more than once if a daemon went away."""
        return self._native.num_registrations

    def close(self, *, timeout: float = 1.0) -> None:
        """Ends the session, and tells the daemon, which has up to `timeout` seconds to take note.

        Corrections stay readable.
        """
        self._native.close(timeout)

    def __enter__(self) -> "Session":
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()


def status(*, domain: Optional[str] = None, timeout: float = 5.0) -> Dict[str, Any]:
    """The state of a domain's daemon, schema `untangled.status/1`."""
    return json.loads(_status(domain, timeout))
