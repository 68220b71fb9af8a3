"""NVIDIA Newton 1.8 (`pip install "newton==1.8.*"`), SolverVBD with self-contact.

::

    solver = newton.solvers.SolverVBD(
        model, particle_enable_self_contact=True, particle_topological_contact_filter_threshold=1, ...
    )
    with untangled_cloth.hosts.newton.Untangler(model, solver, dt=dt) as untangler:
        for _ in range(num_steps):
            state_0.clear_forces()
            untangler.before_step(state_0)
            solver.step(state_0, state_1, control, contacts, dt)
            state_0, state_1 = state_1, state_0

Three things help, each where the one before does not:

- Forces in newtons, in `state.particle_f`, for one step.
- Contacts between the two sides of a tangle are struck out of the solver's own list after each of its collision
  detections (:class:`untangled_cloth.ContactFilter`); all others stay, so that less falls through that leans on it.
  That list is private to Newton, hence the version. Without this VBD keeps a tangle for ever, against any force: it
  lets no vertex move through an element that it has found near.
- Repairs between two steps: positions move to where nothing intersects, certified, and velocities keep all but what
  leads back. Where layers are pressed together the solver's own steps may tangle them again, and the next frame is
  repaired again: clients/python/README.md has tables.

By default VBD leaves out contacts of elements within two rings of each other, and where a fold is sharp it tangles them
again in every step: give it `particle_topological_contact_filter_threshold=1`.

Arrays may be Warp's. Those of a GPU are copied: positions to the host and forces back in each step, positions and
velocities back with a repair, and the contact lists there and back after each detection while anything is tangled.
"""

from __future__ import annotations

import warnings
from typing import Any, Callable, Mapping, Optional

import numpy as np
import warp as wp
from numpy.typing import NDArray

import newton

from .. import ContactFilter, Missed, Session
from ..correction import Correction
from . import _repairs

if not newton.__version__.startswith("1.8."):
    raise ImportError(f"untangled_cloth.hosts.newton knows Newton 1.8, not {newton.__version__}")

_HOOK = "_collision_detection_penetration_free"


class Untangler:
    """Keeps the particles of a Newton model apart.

    Args:
        model: with all cloth in it; particles without mass are taken for pinned.
        solver: a SolverVBD with `particle_enable_self_contact=True` and
            `particle_topological_contact_filter_threshold=1`; warns where that is more.
        dt: length of a step in seconds.
        uv, uv_triangles, rest_positions, settings, domain, timeout: as for :class:`untangled_cloth.Session`.
        deadline: seconds to wait for a correction before the step goes on without.
        repair: which frames are repaired: "always" those with intersections, "auto" those of a tangle that does not
            shrink, "never".
        use_force, use_mask: whether forces are added, and whether contacts of a tangle are off, where a frame is not
            repaired. Neither alone untangles.
        labels: whether contacts are off by pair; otherwise, and with a daemon that is too old, all of a masked vertex.
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
        labels: bool = True,
        repair: str = "always",
    ) -> None:
        if not getattr(solver, "particle_enable_self_contact", False) or not hasattr(solver, _HOOK):
            raise TypeError(
                "a SolverVBD with particle_enable_self_contact=True is needed: only its contacts can be masked"
            )
        _warn_of_contacts_left_out(solver)
        self.model, self.solver, self.dt, self.deadline = model, solver, dt, deadline
        self.use_force, self.use_mask = use_force, use_mask
        self._triangles = model.tri_indices.numpy()
        self._edges = model.edge_indices.numpy()[:, 2:4]
        masses = model.particle_mass.numpy().astype(np.float64)
        self.session = Session(
            self._triangles,
            _on_host(uv),
            uv_triangles=_on_host(uv_triangles),
            num_vertices=model.particle_count,
            rest_positions=_on_host(rest_positions),
            masses=masses,
            pins=np.flatnonzero(masses == 0),
            correction="force",
            settings=_repairs.with_repair(settings, repair),
            repairs=repair != "never",
            labels=labels,
            dt=dt,
            domain=domain,
            timeout=timeout,
        )
        self._contacts = ContactFilter(model.particle_count)
        self._any = False
        self._detect = getattr(solver, _HOOK)
        setattr(solver, _HOOK, self._detect_and_strike)

    def before_step(self, state: Any) -> Optional[Correction]:
        """Sends the positions of `state`; repairs it, or adds forces to `state.particle_f` and sets the contacts of the
        next step.

        Without a correction (it came too late, or the daemon is gone) the step goes on without help, and this returns
        None.
        """
        positions = state.particle_q.numpy()
        try:
            correction = self.session.exchange(positions, self.dt, deadline=self.deadline)
        except Missed:
            self.clear_mask()
            return None
        moves = _repairs.displacement(self.session, self._triangles, correction, positions, self.deadline)
        if moves is not None:
            # The force was for the state before.
            self.clear_mask()
            state.particle_qd.assign(_repairs.slowed(state.particle_qd.numpy(), moves, self.dt))
            state.particle_q.assign(positions + moves)
            return correction
        if self.use_force and correction.num_intersections:
            state.particle_f.assign(state.particle_f.numpy() + correction.force)
        if self.use_mask:
            self._set_contacts(correction)
        return correction

    def _set_contacts(self, correction: Correction) -> None:
        if self.session.has_labels:
            self._any = len(correction.labels) > 0
            self._contacts.set(correction)
        else:
            self._masked = correction.mask
            self._any = bool(self._masked.any())

    def clear_mask(self) -> None:
        """Switches all contacts on again."""
        self._any = False

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
            self._strike("vertex_colliding_triangles", self._vertex_face_off)
            self._strike("edge_colliding_edges", self._edge_edge_off)
        return result

    def _strike(self, name: str, off: Callable[[NDArray[Any], NDArray[Any]], NDArray[np.bool_]]) -> None:
        """Strikes those pairs out of one of the solver's lists that are off: the second of a pair becomes -1."""
        found = self.solver.trimesh_collision_info
        counts, sizes, offsets = (
            getattr(found, name + part).numpy() for part in ("_count", "_buffer_sizes", "_offsets")
        )
        counts = np.minimum(counts, sizes[: len(counts)])
        # The places of all pairs in the list: rows of known beginnings and lengths, one for each vertex or edge.
        owners = np.repeat(np.arange(len(counts)), counts)
        places = np.arange(len(owners)) + np.repeat(offsets[: len(counts)] - (np.cumsum(counts) - counts), counts)
        pairs = getattr(found, name)
        listed = pairs.numpy()
        others = listed[2 * places + 1]
        kept = others >= 0
        owners, places, others = owners[kept], places[kept], others[kept]
        listed[2 * places[off(owners, others)] + 1] = -1
        if not pairs.device.is_cpu:
            pairs.assign(listed)

    def _vertex_face_off(self, vertices: NDArray[Any], faces: NDArray[Any]) -> NDArray[np.bool_]:
        if self.session.has_labels:
            return self._contacts.vertex_face_off(vertices, self._triangles[faces])
        return self._masked[vertices] | self._masked[self._triangles[faces]].any(axis=1)

    def _edge_edge_off(self, first: NDArray[Any], second: NDArray[Any]) -> NDArray[np.bool_]:
        if self.session.has_labels:
            return self._contacts.edge_edge_off(self._edges[first], self._edges[second])
        return self._masked[self._edges[first]].any(axis=1) | self._masked[self._edges[second]].any(axis=1)


def _warn_of_contacts_left_out(solver: Any) -> None:
    rings = getattr(solver, "particle_topological_contact_filter_threshold", 0)
    if rings > 1:
        warnings.warn(
            f"this solver leaves out contacts of elements within {rings} rings of each other: where cloth is folded "
            "sharply, its steps tangle what is repaired; pass particle_topological_contact_filter_threshold=1",
            stacklevel=3,
        )


def _on_host(values: Any) -> Any:
    """A Warp array as numpy's, by copy from a GPU; all else as it is."""
    return values.numpy() if isinstance(values, wp.array) else values
