"""What an analysis found, as a list to read and lines to draw. Nothing here needs Blender."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Dict, List, Tuple

import numpy as np

COLOURS: Dict[str, Tuple[float, float, float]] = {
    "CLOSED": (0.95, 0.25, 0.20),
    "LL": (0.95, 0.55, 0.10),
    "BLI": (0.95, 0.85, 0.15),
    "BLB": (0.60, 0.85, 0.20),
    "BB": (0.20, 0.75, 0.95),
    "BI": (0.35, 0.45, 1.00),
    "II": (0.85, 0.35, 0.95),
}
"""A colour for each type of path."""
LEGEND = {
    "CLOSED": "red",
    "LL": "orange",
    "BLI": "yellow",
    "BLB": "green",
    "BB": "light blue",
    "BI": "blue",
    "II": "violet",
}
"""The same in words."""


@dataclass
class Finding:
    """A pair of intersection paths: one entry of the list."""

    pair_type: str
    objects: str
    length: float
    """Metres."""
    centre: np.ndarray
    """In the world, in Blender's units; so is `radius`."""
    radius: float
    polylines: List[Tuple[str, np.ndarray]]
    """Type and points of each of its paths."""


def findings(world, analysis) -> List[Finding]:
    """The paths of an analysis, pair by pair, the longest first."""
    pairs: Dict[int, list] = {}
    for path in analysis.paths:
        pairs.setdefault(path.pair, []).append(path)
    found = [_finding(world, paths) for paths in pairs.values()]
    return sorted(found, key=lambda finding: -finding.length)


def _finding(world, paths) -> Finding:
    polylines = []
    for path in paths:
        points = np.asarray(path.points, float) / world.metres
        polylines.append((path.type, np.concatenate([points, points[:1]]) if path.closed and len(points) else points))
    every = np.concatenate([points for _, points in polylines])
    low, high = every.min(0), every.max(0)
    faces = np.unique(np.concatenate([np.asarray(path.faces).ravel() for path in paths]))
    owners = {world.owner(int(vertex)) for vertex in world.triangles[faces[faces < len(world.triangles)], 0]}
    return Finding(
        pair_type=paths[0].pair_type,
        objects=", ".join(world.sheets[k].name for k in sorted(owners)),
        length=max(_length(points) for _, points in polylines) * world.metres,
        centre=(low + high) / 2,
        radius=float(np.linalg.norm(high - low)) / 2,
        polylines=polylines,
    )


def _length(points: np.ndarray) -> float:
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


def segments_by_type(found: List[Finding]) -> Dict[str, np.ndarray]:
    """Ends of all segments to draw, type by type: `2 n x 3` each, two rows for a segment."""
    pieces: Dict[str, List[np.ndarray]] = {}
    for finding in found:
        for kind, points in finding.polylines:
            if len(points) > 1:
                ends = np.stack([points[:-1], points[1:]], 1).reshape(-1, 3)
                pieces.setdefault(kind, []).append(ends)
    return {kind: np.concatenate(ends) for kind, ends in sorted(pieces.items())}


def wrong_vertices(world, analysis, k: int) -> np.ndarray:
    """Vertices of one sheet that are on the wrong side: inside of a path or a body, or behind a layer."""
    wrong = np.array(analysis.inside, bool)
    wrong[analysis.inside_body] = True
    wrong[analysis.behind] = True
    return np.flatnonzero(wrong[world.range(k)])


def summary(found: List[Finding], analysis) -> str:
    """One line for a user."""
    words = []
    if analysis.num_intersections:
        words.append(f"{_many(len(analysis.face_pairs), 'pair')} of faces intersect, on {_many(len(found), 'path')}")
    if len(analysis.inside_body):
        words.append(f"{_many(len(analysis.inside_body), 'vertex', 'vertices')} inside of a body")
    if len(analysis.behind):
        words.append(f"{_many(len(analysis.behind), 'vertex', 'vertices')} behind an inner layer")
    return "; ".join(words) if words else "clean: nothing intersects"


def _many(number: int, one: str, several: str = "") -> str:
    return f"{number} {one if number == 1 else several or one + 's'}"
