"""Analysis and repair of one state, without a daemon."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Callable, Dict, List, Mapping, Optional, Tuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays, _native


@dataclass(frozen=True)
class FoundPath:
    """One intersection path. Arrays are the caller's own, and may be written."""

    type: str
    """CLOSED, LL, BLI, BLB, BB, BI or II."""
    pair_type: str
    """Type of the pair: CLOSED/CLOSED, EIGHT, LL, BLI, BLB, BLLB, CROSS, BB/II, BB/BI, BB/BB or BI/BI."""
    pair: int
    """Which pair it belongs to."""
    partner: int
    """Index of the corresponding path; its own where it is its own."""
    closed: bool
    """Whether it is a loop on the cloth."""
    points: NDArray[np.float64]
    """World positions in metres, `num_points x 3`."""
    faces: NDArray[np.uint32]
    """The face that the path runs through after each point, and the partner's, `num_points x 2`."""
    inside: NDArray[np.uint32]
    """Vertices inside of it."""


@dataclass(frozen=True)
class Analysis:
    """What intersects in one state. Arrays are the caller's own, and may be written."""

    edge_face: NDArray[np.uint32]
    """For each edge that pierces a face its two vertices and the face, `n x 3`."""
    face_pairs: NDArray[np.uint32]
    """Intersecting pairs of faces, `n x 2`."""
    contour_length: float
    """Length of all paths in metres, each pair once."""
    inside: NDArray[np.bool_]
    """Whether each vertex is inside, `num_vertices` of bool."""
    paths: List[FoundPath]
    """Intersection paths."""
    inside_body: NDArray[np.uint32]
    """Vertices of cloth inside of a body, ascending."""
    behind: NDArray[np.uint32]
    """Vertices behind a layer that lies further in, ascending."""

    @property
    def num_intersections(self) -> int:
        """Number of edges that pierce a face. 0 is said after an exact test of every candidate."""
        return len(self.edge_face)


@dataclass(frozen=True)
class Progress:
    """How far a repair is, after one of its iterations."""

    num_iterations: int
    """Iterations so far."""
    num_intersections: int
    """Edges that pierce a face now. 0 while the shape is being recovered."""
    contour_length: float
    """Length of all paths in metres."""
    method: str
    """What moved the cloth: rbf, push, contour, nudge, straighten, settle or gap."""


@dataclass(frozen=True)
class Fix:
    """Result of a repair."""

    vertices: NDArray[np.float64]
    """Positions in metres, `num_vertices x 3` of float64; those of the input, bit for bit, if that was clean. The
    caller's own array: it may be written."""
    num_intersections: int
    """Edges that pierce a face in `vertices`, by an exact check that shares no code with the repair."""
    num_iterations: int
    """Iterations that it took."""
    blocked: List[Tuple[str, int, float, str]]
    """Paths that remain: type, a vertex beside the path, length in metres, reason."""
    num_inside_body: int = 0
    """Vertices of cloth inside of a body in `vertices`, by the same check."""
    num_behind: int = 0
    """Vertices behind a layer that lies further in."""
    num_pairs_below: Optional[int] = None
    """Pairs of primitives nearer than the gap that was asked for, by the same check; None without one."""
    infeasible: List[Tuple[List[int], int, float, str]] = field(default_factory=list)
    """Where pairs stayed nearer than the gap: vertices, number of pairs, least distance in metres, reason."""

    @property
    def clean(self) -> bool:
        """Whether nothing intersects, is on the wrong side of a body or a layer, or nearer than the gap."""
        return not (self.num_intersections or self.num_inside_body or self.num_behind or self.num_pairs_below)


def _mesh(
    vertices: Any, triangles: Any, uv: Any, uv_triangles: Any, rest: Any, pins: Any, layers: Any, body: Any
) -> Dict[str, Any]:
    positions = _arrays.numbers("vertices", vertices, 3)
    cloth = _arrays.cloth(len(positions), triangles, uv, uv_triangles, rest, pins, layers, body)
    return {"vertices": positions.tobytes(), **cloth}


def analyse(
    vertices: ArrayLike,
    triangles: ArrayLike,
    uv: Optional[ArrayLike] = None,
    *,
    uv_triangles: Optional[ArrayLike] = None,
    rest_positions: Optional[ArrayLike] = None,
    pins: Optional[ArrayLike] = None,
    layers: Optional[ArrayLike] = None,
    body: Optional[ArrayLike] = None,
    settings: Optional[Mapping[str, Any]] = None,
) -> Analysis:
    """What intersects in one state, by exact signs. For the arguments see :class:`untangled_cloth.Session`.

    Raises:
        ValueError: the mesh, a position or a setting can't be used; the message names the element at fault.
    """
    mesh = _mesh(vertices, triangles, uv, uv_triangles, rest_positions, pins, layers, body)
    found = _native.analyse(mesh, _arrays.document(settings))
    paths = [
        FoundPath(
            type=path["type"],
            pair_type=path["pair_type"],
            pair=path["pair"],
            partner=path["partner"],
            closed=path["closed"],
            points=np.frombuffer(path["points"], np.float64).reshape(-1, 3),
            faces=np.frombuffer(path["faces"], np.uint32).reshape(-1, 2),
            inside=np.frombuffer(path["inside"], np.uint32),
        )
        for path in found["paths"]
    ]
    return Analysis(
        edge_face=np.frombuffer(found["edge_face"], np.uint32).reshape(-1, 3),
        face_pairs=np.frombuffer(found["face_pairs"], np.uint32).reshape(-1, 2),
        contour_length=found["contour_length_m"],
        inside=np.frombuffer(found["inside"], np.bool_),
        paths=paths,
        inside_body=np.frombuffer(found["inside_body"], np.uint32),
        behind=np.frombuffer(found["behind"], np.uint32),
    )


def count_intersections(vertices: ArrayLike, triangles: ArrayLike, body: Optional[ArrayLike] = None) -> int:
    """Number of edges that pierce a face, by an exact check that shares no code with the untangler.

    Those of bodies with each other, whose vertices are `body`, are not counted.

    It judges results of the untangler. Slower than :func:`analyse`.
    """
    positions = _arrays.numbers("vertices", vertices, 3)
    faces = _arrays.indices("triangles", triangles, 3)
    fixed = b"" if body is None else _arrays.indices("body", body, 1).tobytes()
    return _native.count_intersections(positions.tobytes(), faces.tobytes(), fixed)


def fix(
    vertices: ArrayLike,
    triangles: ArrayLike,
    uv: Optional[ArrayLike] = None,
    *,
    uv_triangles: Optional[ArrayLike] = None,
    rest_positions: Optional[ArrayLike] = None,
    pins: Optional[ArrayLike] = None,
    layers: Optional[ArrayLike] = None,
    body: Optional[ArrayLike] = None,
    gap: Optional[float] = None,
    quality: str = "balanced",
    max_iterations: int = 100,
    single_precision: bool = False,
    progress: Optional[Callable[[Progress], Optional[bool]]] = None,
) -> Fix:
    """Moves vertices as little as possible until nothing intersects.

    For the arguments see :class:`untangled_cloth.Session`.

    Cloth is brought out of bodies, and layers into their order. With a `gap` in metres, primitives without a common
    vertex are then set apart by at least that; what can't be is in `infeasible`.

    `single_precision` rounds every state to float32, so that `vertices.astype(numpy.float32)` is what was checked.
    `progress` is called after each iteration. Where it returns False, the best state so far is the result; what it
    raises ends the repair.

    Raises:
        ValueError: the mesh or a position can't be used. KeyboardInterrupt: between two iterations.
    """
    mesh = _mesh(vertices, triangles, uv, uv_triangles, rest_positions, pins, layers, body)
    report = None if progress is None else (lambda *state: progress(Progress(*state)))
    result = _native.fix(mesh, quality, max_iterations, single_precision, gap, report)
    return Fix(
        vertices=np.frombuffer(result["vertices"], np.float64).reshape(-1, 3),
        num_intersections=result["num_edge_face_intersections"],
        num_iterations=result["num_iterations"],
        blocked=list(result["blocked"]),
        num_inside_body=result["num_inside_body"],
        num_behind=result["num_behind"],
        num_pairs_below=result["num_pairs_below"],
        infeasible=list(result["infeasible"]),
    )
