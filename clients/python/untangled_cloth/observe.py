"""Watching sessions of other processes: positions, corrections and paths of their newest frames.

An observer takes no part in a session, and the session does not wait for it: one that is slow, or was stopped, misses
frames. At most 16 may watch a session at a time::

    from untangled_cloth import observe

    with observe.Observer(name="my viewer") as observer:
        while True:
            seen = observer.latest(timeout=1.0)
            if seen is not None:
                draw(seen.positions, observer.mesh.triangles, seen.paths)
"""

from __future__ import annotations

import time
from typing import Any, Dict, List, NamedTuple, Optional

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._native import NativeObservation, NativeObserver, SessionEnded
from .correction import KINDS, Paths

__all__ = ["ObservedMesh", "Observation", "Observer", "SessionEnded", "sessions"]


def sessions(domain: Optional[str] = None, timeout: float = 5.0) -> List[Dict[str, Any]]:
    """The sessions that a daemon serves now, by their ids.

    Each has `session` (its id), `instance` (the run of the daemon), `host` (the process that registered it: `pid` and
    `name`), `num_vertices`, `num_faces`, `num_frames`, `rate_hz`, and `observers` (as `host`, a list).

    Raises :class:`untangled_cloth.NoDaemon` where none answers within `timeout` seconds.
    """
    return _native.sessions(domain, timeout)


class ObservedMesh(NamedTuple):
    """What stays the same while a session lives, by the host's vertices."""

    num_vertices: int
    triangles: NDArray[np.uint32]
    """`num_faces x 3`; corners on a welded seam are the lowest of those in their place."""
    body: NDArray[np.uint32]
    """Vertices of bodies, ascending."""
    pins: NDArray[np.uint32]
    """Vertices that the host does not let move, ascending."""
    layers: Optional[NDArray[np.uint32]]
    """Layer of each vertex, from the body outwards; None where the host said nothing of layers."""
    outwards: Optional[NDArray[np.bool_]]
    """For each face whether its normal points outwards of its layer, where rest positions decided that; else None."""
    double: bool
    """Whether the session's positions are in double precision; those of observations are single."""
    correction: str
    """What corrections are: force, acceleration, velocity or displacement."""


class Observation:
    """One frame of a session: what its host sent, and what it got. Arrays are read-only, and its own."""

    def __init__(self, native: NativeObservation) -> None:
        self._header: Dict[str, Any] = native.header()
        self.positions: NDArray[np.float32] = np.asarray(native.positions())
        """World positions in metres, `num_vertices x 3`; empty where those of the frame can't be used."""
        self.corrections: NDArray[np.float32] = np.asarray(native.corrections())
        """Values of all vertices, `num_vertices x 3`, in the unit of `kind`."""
        self.flags: NDArray[np.uint32] = np.asarray(native.flags())
        """Flags of all vertices, `num_vertices`: `untangled_cloth.INSIDE` and so on."""
        self.inside: NDArray[np.uint32] = np.asarray(native.inside())
        """Vertices inside and the pair of paths that each is inside of, `num_inside x 2`; some may be in several."""
        self.depths: NDArray[np.float32] = np.asarray(native.depths())
        """For each pair of paths how far the farthest point inside is from where it should be, in metres; 0 where there
        is no such place: nothing is inside, or the response seeks no targets."""
        self.paths = Paths(*(np.asarray(part) for part in native.paths()))
        """The intersection paths; `state` of each says what became of it."""

    @property
    def frame(self) -> int:
        """Its number."""
        return self._header["frame"]

    @property
    def kind(self) -> str:
        """What the corrections are: force, acceleration, velocity or displacement."""
        return KINDS[self._header["kind"]]

    @property
    def num_frames(self) -> int:
        """Frames of the session that were answered so far, this one included."""
        return self._header["num_frames"]

    @property
    def num_dropped(self) -> int:
        """Frames that were answered since the last observation, or the opening, and not seen."""
        return self._header["num_dropped"]

    @property
    def refused(self) -> Optional[str]:
        """Why the frame was not corrected, in words; None if it was."""
        return self._header["refused"]

    @property
    def age(self) -> float:
        """How long ago its correction was sent, in seconds."""
        return max(time.clock_gettime(time.CLOCK_MONOTONIC) - self._header["sent_s"], 0.0)

    @property
    def summary(self) -> Dict[str, Any]:
        """Counts and times by name: the header of `proto/PROTOCOL.md`, and `sent_s`, by `CLOCK_MONOTONIC`."""
        return dict(self._header)

    def __repr__(self) -> str:
        return f"<untangled_cloth.observe.Observation of frame {self.frame}: {len(self.paths)} paths>"


class Observer:
    """Watches one session, `session` by its id; without it the only one of the domain.

    `name` (at most 64 bytes) is what `untangled status` calls it; without it the name of the program. The first
    observation is that of the first frame after the opening. Any thread may use it, one at a time; no call waits beyond
    its timeout, in seconds.

    Raises :class:`untangled_cloth.NoDaemon`, or :class:`untangled_cloth.Refused` where there is no such session, or
    16 observers watch it.
    """

    def __init__(
        self,
        session: Optional[int] = None,
        *,
        domain: Optional[str] = None,
        timeout: float = 5.0,
        name: Optional[str] = None,
    ) -> None:
        self._native = NativeObserver(session, domain, timeout, name)
        self._read_mesh()

    def _read_mesh(self) -> None:
        mesh = self._native.mesh()

        def numbers(raw: bytes) -> NDArray[np.uint32]:
            return np.frombuffer(raw, np.uint32)

        self.session: Dict[str, Any] = self._native.session()
        """The session as :func:`sessions` lists it, when it was opened."""
        self.mesh = ObservedMesh(
            num_vertices=mesh["num_vertices"],
            triangles=numbers(mesh["triangles"]).reshape(-1, 3),
            body=numbers(mesh["body"]),
            pins=numbers(mesh["pins"]),
            layers=None if mesh["layers"] is None else numbers(mesh["layers"]),
            outwards=None if mesh["outwards"] is None else np.frombuffer(mesh["outwards"], np.bool_),
            double=mesh["double"],
            correction=mesh["correction"],
        )
        """What stays the same: triangles, bodies, layers, pins."""

    def latest(self, timeout: float = 0.0) -> Optional[Observation]:
        """The newest frame that was not seen yet; waits for one up to `timeout` seconds. None where none has come.

        Raises :class:`SessionEnded` once the session has ended, or its daemon.
        """
        native = self._native.latest(timeout)
        return None if native is None else Observation(native)

    def reopen(self, timeout: float = 5.0) -> None:
        """Watches the session that takes the place of one that has ended, waiting for it up to `timeout` seconds.

        It is one of the same host and of the same size, and among several of those the same one by the order of
        registration: what a host registers after its daemon was restarted.
        """
        self._native.reopen(timeout)
        self._read_mesh()

    def close(self) -> None:
        """Ends the watching."""
        self._native.close()

    def __enter__(self) -> "Observer":
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<untangled_cloth.observe.Observer of session {self.session['session']}>"
