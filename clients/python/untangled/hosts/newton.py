"""NVIDIA Newton 1.8 (`pip install "newton==1.8.*"`), SolverVBD with self-contact.

::

    solver = newton.solvers.SolverVBD(model, particle_enable_self_contact=True, ...)
    with untangled.hosts.newton.Untangler(model, solver, dt=dt) as untangler:
        for _ in range(num_steps):
            state_0.clear_forces()
            untangler.before_step(state_0)
            solver.step(state_0, state_1, control, contacts, dt)
            state_0, state_1 = state_1, state_0

The force is in newtons, in `state.particle_f`, for one step. The mask is applied to the solver's own contact list:
after each collision detection the pairs that touch a masked vertex are struck out. That list is private to Newton,
hence the version. Without the mask VBD keeps a tangle for ever, against any force: it lets no vertex move through an
element that it has found near.
"""

from __future__ import annotations

from typing import Any, Mapping, Optional

import numpy as np
import warp as wp

import newton

from .. import Missed, Session
from ..correction import Correction

if not newton.__version__.startswith("1.8."):
    raise ImportError(f"untangled.hosts.newton knows Newton 1.8, not {newton.__version__}")

_HOOK = "_collision_detection_penetration_free"


@wp.kernel
def _strike_vertex_triangle(
    masked: wp.array(dtype=wp.int32),
    triangles: wp.array2d(dtype=wp.int32),
    offsets: wp.array(dtype=wp.int32),
    sizes: wp.array(dtype=wp.int32),
    counts: wp.array(dtype=wp.int32),
    pairs: wp.array(dtype=wp.int32),
):
    vertex = wp.tid()
    for k in range(wp.min(counts[vertex], sizes[vertex])):
        place = 2 * (offsets[vertex] + k) + 1
        face = pairs[place]
        if face >= 0:
            corners = masked[triangles[face, 0]] + masked[triangles[face, 1]] + masked[triangles[face, 2]]
            if masked[vertex] + corners > 0:
                pairs[place] = -1


@wp.kernel
def _strike_edge_edge(
    masked: wp.array(dtype=wp.int32),
    edges: wp.array2d(dtype=wp.int32),
    offsets: wp.array(dtype=wp.int32),
    sizes: wp.array(dtype=wp.int32),
    counts: wp.array(dtype=wp.int32),
    pairs: wp.array(dtype=wp.int32),
):
    edge = wp.tid()
    for k in range(wp.min(counts[edge], sizes[edge])):
        place = 2 * (offsets[edge] + k) + 1
        other = pairs[place]
        if other >= 0:
            own = masked[edges[edge, 2]] + masked[edges[edge, 3]]
            if own + masked[edges[other, 2]] + masked[edges[other, 3]] > 0:
                pairs[place] = -1


class Untangler:
    """Keeps the particles of a Newton model apart.

    Args:
        model: with all cloth in it; particles without mass are taken for pinned.
        solver: a SolverVBD with `particle_enable_self_contact=True`.
        dt: length of a step in seconds.
        uv, uv_triangles, rest_positions, settings, domain, timeout: as for :class:`untangled.Session`.
        deadline: seconds to wait for a correction before the step goes on without.
        use_force, use_mask: switches for comparisons. Neither alone untangles.
    """

    def __init__(
        self,
        model: Any,
        solver: Any,
        *,
        dt: float,
        uv: Any = None,
        uv_triangles: Any = None,
        rest_positions: Any = None,
        settings: Optional[Mapping[str, Any]] = None,
        deadline: float = 0.5,
        domain: Optional[str] = None,
        timeout: float = 5.0,
        use_force: bool = True,
        use_mask: bool = True,
    ) -> None:
        if not getattr(solver, "particle_enable_self_contact", False) or not hasattr(solver, _HOOK):
            raise TypeError(
                "a SolverVBD with particle_enable_self_contact=True is needed: only its contacts can be masked"
            )
        self.model, self.solver, self.dt, self.deadline = model, solver, dt, deadline
        self.use_force, self.use_mask = use_force, use_mask
        masses = model.particle_mass.numpy().astype(np.float64)
        self.session = Session(
            model.tri_indices.numpy(),
            uv,
            uv_triangles=uv_triangles,
            num_vertices=model.particle_count,
            rest_positions=rest_positions,
            masses=masses,
            pins=np.flatnonzero(masses == 0),
            correction="force",
            settings=settings,
            dt=dt,
            domain=domain,
            timeout=timeout,
        )
        self._masked = wp.zeros(model.particle_count, dtype=wp.int32, device=model.device)
        self._any = False
        self._detect = getattr(solver, _HOOK)
        setattr(solver, _HOOK, self._detect_and_strike)

    def before_step(self, state: Any) -> Optional[Correction]:
        """Sends the positions of `state`, adds the forces to `state.particle_f`, and sets the mask of the next step.

        Without a correction (it came too late, or the daemon is gone) the step goes on without help, and this returns
        None.
        """
        try:
            correction = self.session.exchange(state.particle_q.numpy(), self.dt, deadline=self.deadline)
        except Missed:
            self.clear_mask()
            return None
        if self.use_force and correction.num_intersections:
            state.particle_f.assign(state.particle_f.numpy() + correction.force)
        if self.use_mask:
            self._any = bool(correction.mask.any())
            self._masked.assign(correction.mask.astype(np.int32))
        return correction

    def clear_mask(self) -> None:
        """Switches all contacts on again."""
        self._any = False
        self._masked.zero_()

    def close(self) -> None:
        """Gives the solver back as it was, and ends the session."""
        if getattr(self.solver, _HOOK) == self._detect_and_strike:
            delattr(self.solver, _HOOK)
        self.session.close()

    def __enter__(self) -> "Untangler":
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()

    def _detect_and_strike(self, *arguments: Any, **named: Any) -> Any:
        result = self._detect(*arguments, **named)
        if self._any:
            found = self.solver.trimesh_collision_info
            for kernel, elements, name in (
                (_strike_vertex_triangle, self.model.tri_indices, "vertex_colliding_triangles"),
                (_strike_edge_edge, self.model.edge_indices, "edge_colliding_edges"),
            ):
                count = getattr(found, name + "_count")
                parts = [getattr(found, name + part) for part in ("_offsets", "_buffer_sizes")]
                inputs = [self._masked, elements, *parts, count, getattr(found, name)]
                wp.launch(kernel, dim=len(count), inputs=inputs, device=self.model.device)
        return result
