"""A session: one cloth, its frames and its corrections."""

from __future__ import annotations

import json
from contextlib import contextmanager
from typing import Any, Dict, Iterator, Mapping, Optional

import numpy as np

from . import _arrays
from ._native import NativeSession
from ._native import status as _status
from .correction import KINDS, Correction


class Session:
    """One cloth that the daemon knows.

    It connects to the daemon of `domain` (else the environment variable `UNTANGLED_DOMAIN`, else `default`), waiting
    up to `timeout` seconds for it to start, and registers the cloth. When the daemon died or was restarted, that frame
    raises :class:`untangled.Missed`, and a later one registers the session again.

    Any thread may use it, one at a time; it waits without the interpreter's lock.

    Args:
        triangles: vertex indices, `num_triangles x 3`.
        uv: texture coordinates, `n x 2`; one for each vertex unless `uv_triangles` says otherwise.
        uv_triangles: the texture coordinate of each corner, `num_triangles x 3`.
        num_vertices: taken from `masses`, `rest_positions` or `layers`, else the highest index plus one.
        rest_positions: unstrained positions in metres, `num_vertices x 3`.
        masses: kilograms, `num_vertices`; needed for forces.
        pins: vertices that the simulator does not let move.
        layers: of each vertex, from the body outwards.
        correction: "force" (N), "acceleration" (m/s^2), "velocity" (change, m/s) or "displacement" (m); by default
            force where there are masses, else displacement.
        dtype: float32 or float64: the precision in which positions are sent.
        paths: whether corrections bring the intersection paths.
        settings: by name, as in `untangled config`, section `settings`; besides, `quality`.
        dt: length of a step in seconds, where a call does not say another.

    Raises:
        NoDaemon, Refused (the message names the element at fault), ValueError, TypeError.
    """

    def __init__(
        self,
        triangles: Any,
        uv: Any = None,
        *,
        uv_triangles: Any = None,
        num_vertices: Optional[int] = None,
        rest_positions: Any = None,
        masses: Any = None,
        pins: Any = None,
        layers: Any = None,
        correction: Optional[str] = None,
        dtype: Any = np.float32,
        paths: bool = False,
        settings: Optional[Mapping[str, Any]] = None,
        dt: float = 1 / 60,
        domain: Optional[str] = None,
        timeout: float = 5.0,
    ) -> None:
        if num_vertices is None:
            known = [len(values) for values in (masses, rest_positions, layers) if values is not None]
            faces = np.asarray(triangles)
            num_vertices = known[0] if known else (int(faces.max()) + 1 if faces.size else 0)
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
        """Simulated time in seconds of the next frame; each frame adds its `dt`."""
        cloth = _arrays.cloth(num_vertices, triangles, uv, uv_triangles, rest_positions, pins, layers)
        weights = None if masses is None else _arrays.numbers("masses", masses, 1, num_vertices).tobytes()
        self._native = NativeSession(
            domain=domain,
            timeout_s=timeout,
            num_vertices=num_vertices,
            masses=weights,
            double=self.dtype == np.float64,
            kind=correction,
            paths=paths,
            settings=json.dumps({} if settings is None else dict(settings)),
            **cloth,  # type: ignore[arg-type]
        )

    def exchange(
        self, positions: Any, dt: Optional[float] = None, *, time: Optional[float] = None, deadline: float = 0.05
    ) -> Correction:
        """Publishes `positions` (metres, `num_vertices x 3`) and waits up to `deadline` seconds for their correction.

        This is lock step. Positions of any precision and strides are written directly into shared memory.

        Raises:
            Missed: no correction this time. Go on without it; the next call tries again.
            FrameRefused: a position is not finite, or `dt` can't be used.
        """
        with self.frame(dt, time=time) as slots:
            if np.shape(positions) != slots.shape:
                raise ValueError(f"positions must be of shape {slots.shape}, not {np.shape(positions)}")
            np.copyto(slots, positions, casting="same_kind")
        return self.wait(deadline=deadline)

    @contextmanager
    def frame(self, dt: Optional[float] = None, *, time: Optional[float] = None) -> "Iterator[np.ndarray]":
        """Lends the memory of the next frame, `num_vertices x 3`: write every position in it, in metres.

        The end of the block publishes the frame, an exception drops it. The array can't be written after that; other
        views of it must not be.

        Raises:
            Missed: the daemon went away; this frame is lost.
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
        self.time = now + step
        self._native.send()

    def wait(self, frame: Optional[int] = None, *, deadline: float = 0.05) -> Correction:
        """The correction of a frame, by default of the last one that was published. See :meth:`exchange`."""
        return Correction(self._native.wait(self._native.frame if frame is None else frame, deadline))

    def newest(self) -> Optional[Correction]:
        """The newest correction that has come since the last call, if any: free running. Does not wait."""
        native = self._native.newest()
        return None if native is None else Correction(native)

    def update_settings(self, settings: Mapping[str, Any], *, timeout: float = 5.0) -> None:
        """Replaces the settings from the next frame on; names left out take the daemon's defaults."""
        self._native.update_settings(json.dumps(dict(settings)), timeout)

    @property
    def last_frame(self) -> int:
        """Number of the last frame that was published; 0 before the first."""
        return self._native.frame

    @property
    def num_registrations(self) -> int:
        """How often the session was registered: more than once if a daemon went away."""
        return self._native.num_registrations

    def close(self) -> None:
        """Ends the session. Corrections stay readable."""
        self._native.close()

    def __enter__(self) -> "Session":
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()


def status(*, domain: Optional[str] = None, timeout: float = 5.0) -> Dict[str, Any]:
    """The state of a domain's daemon, schema `untangled.status/1`."""
    return json.loads(_status(domain, timeout))
