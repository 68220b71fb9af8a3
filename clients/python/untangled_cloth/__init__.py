"""Resolves intersections of cloth: global intersection analysis (GIA) and response.

With a daemon, for simulators (``untangled-cloth serve`` starts it, :class:`Daemon` one for this process alone)::

    import numpy as np, untangled_cloth as untangled

    with untangled.Session(triangles, masses=masses) as session:
        correction = session.exchange(positions, dt=1 / 60)
        forces += correction.force                      # newtons, num_vertices x 3
        self_collision[correction.mask] = False         # without this nothing untangles

Without one: :func:`analyse` says what intersects, :func:`fix` moves vertices until nothing does.

Lengths are in metres, times in seconds, masses in kilograms, forces in newtons.
"""

from . import observe
from ._native import Error, FrameRefused, Missed, NoDaemon, Refused, __version__
from ._program import program
from .contacts import ContactFilter
from .correction import Correction, Entries, Path, Paths
from .daemon import Daemon
from .library import Analysis, Fix, FoundPath, Progress, analyse, count_intersections, fix
from .repair import Repair
from .session import Session, status

INSIDE = 1
"""Flag: the vertex is inside; switch the host's self-collision off here."""
NEAR_PATH = 2
"""Flag: the vertex is near a path; switch the host's self-collision off here too."""
CLAMPED = 4
"""Flag: the correction was limited."""
PINNED = 8
"""Flag: the vertex is pinned and never corrected."""
MASK = INSIDE | NEAR_PATH
"""Where the host's self-collision has to be off, or it defends the tangle."""

__all__ = [
    "CLAMPED",
    "INSIDE",
    "MASK",
    "NEAR_PATH",
    "PINNED",
    "Analysis",
    "ContactFilter",
    "Correction",
    "Daemon",
    "Entries",
    "Error",
    "Fix",
    "FoundPath",
    "FrameRefused",
    "Missed",
    "NoDaemon",
    "Path",
    "Paths",
    "Progress",
    "Refused",
    "Repair",
    "Session",
    "__version__",
    "analyse",
    "count_intersections",
    "fix",
    "observe",
    "program",
    "status",
]
