"""MuJoCo flex (`pip install mujoco`): two-dimensional flexes with self-collision.

::

    with untangled_cloth.hosts.mujoco.Untangler(model, data, flex="towel", every=8) as untangler:
        while running:
            untangler.before_step()
            mujoco.mj_step(model, data)

By default a tangled frame is repaired between two steps: positions move to where nothing intersects, certified, and
velocities keep all but what leads back. MuJoCo does not look between two steps for what passes through each other, so
new tangles may arise; the next exchange repairs them.

With `repair="never"`, or `"auto"` until a tangle does not shrink, there are forces in newtons, in `data.qfrc_applied`
of the flex's vertices, held for `every` steps. MuJoCo has no switch for single contacts: the mask switches
self-collision of the whole flex off (`model.flex_selfcollide`) for as long as any vertex is masked, and new tangles
arise where layers lean on each other: clients/python/README.md has a table.
"""

from __future__ import annotations

from typing import Any, Mapping, Optional, Union

import numpy as np
from numpy.typing import NDArray

import mujoco

from .. import Missed, Session
from ..correction import Correction
from . import _repairs


class Untangler:
    """Keeps the vertices of one flex apart.

    Args:
        flex: id or name; of dimension 2, with a body for each vertex.
        every: steps between two exchanges. A correction is a displacement by a good part of an edge length in `every`
            steps: in a single one of MuJoCo's short steps it would be an impact.
        uv, uv_triangles, rest_positions, settings, domain, timeout: as for :class:`untangled_cloth.Session`.
        deadline: seconds to wait for a correction before the steps go on without.
        repair: which frames are repaired: "always" those with intersections, "auto" those of a tangle that does not
            shrink, "never".
        use_force, use_mask: whether forces are added, and self-collision goes off, in frames that are not repaired.
    """

    def __init__(
        self,
        model: Any,
        data: Any,
        flex: Union[int, str] = 0,
        *,
        every: int = 8,
        uv: Any = None,
        uv_triangles: Any = None,
        rest_positions: Any = None,
        settings: Optional[Mapping[str, Any]] = None,
        deadline: float = 0.5,
        domain: Optional[str] = None,
        timeout: float = 5.0,
        use_force: bool = True,
        use_mask: bool = True,
        repair: str = "always",
    ) -> None:
        if isinstance(flex, str):
            flex = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_FLEX, flex)
        if not 0 <= flex < model.nflex or model.flex_dim[flex] != 2 or model.flex_interp[flex] != 0:
            raise ValueError("a flex of dimension 2 with a body for each vertex is needed")
        self.model, self.data, self.flex, self.every, self.deadline = model, data, flex, every, deadline
        self.use_force, self.use_mask = use_force, use_mask
        first, count = model.flex_vertadr[flex], model.flex_vertnum[flex]
        self._vertices = slice(first, first + count)
        self._bodies = model.flex_vertbodyid[self._vertices].copy()
        # A free vertex has three joints of its own; all others are pinned to something.
        num_vertices = np.bincount(self._bodies, minlength=model.nbody)
        free = (model.body_dofnum[self._bodies] == 3) & (num_vertices[self._bodies] == 1)
        self._free = np.flatnonzero(free)
        self._dofs = model.body_dofadr[self._bodies[self._free]][:, None] + np.arange(3)
        joints = model.body_jntadr[self._bodies[self._free]]
        self._places = model.jnt_qposadr[joints][:, None] + np.arange(3)
        self._force = np.zeros((len(self._free), 3))
        self._switch = int(model.flex_selfcollide[flex])
        self._countdown = 0
        elements = model.flex_elem[model.flex_elemdataadr[flex] :][: 3 * model.flex_elemnum[flex]].reshape(-1, 3)
        self._triangles = elements.copy()
        masses = np.where(free, model.body_mass[self._bodies], 0.0)
        self.session = Session(
            elements,
            uv,
            uv_triangles=uv_triangles,
            num_vertices=int(count),
            rest_positions=rest_positions,
            masses=masses,
            pins=np.flatnonzero(~free),
            correction="force",
            dtype=np.float64,
            settings=_repairs.with_repair(settings, repair),
            repairs=repair != "never",
            dt=every * model.opt.timestep,
            domain=domain,
            timeout=timeout,
        )

    def before_step(self) -> Optional[Correction]:
        """Exchanges once in `every` steps, and applies force and mask in each.

        Returns the correction where there was an exchange and it came in time; a repair has then moved the flex
        already. After a missed one the steps go on without help.
        """
        correction = None
        if self._countdown == 0:
            self._countdown = self.every
            self.clear()
            mujoco.mj_kinematics(self.model, self.data)
            mujoco.mj_comPos(self.model, self.data)
            mujoco.mj_flex(self.model, self.data)
            try:
                correction = self.session.exchange(self.data.flexvert_xpos[self._vertices], deadline=self.deadline)
            except Missed:
                pass
        self._countdown -= 1
        if correction is not None and not self._repair(correction):
            if self.use_mask and correction.mask.any():
                self.model.flex_selfcollide[self.flex] = mujoco.mjtFlexSelf.mjFLEXSELF_NONE
            if self.use_force:
                self._force = self._along_joints(correction.force)
                self.data.qfrc_applied[self._dofs] += self._force
        return correction

    def _repair(self, correction: Correction) -> bool:
        """Moves the vertices by the repair of this frame, and slows them; whether there was one."""
        positions = self.data.flexvert_xpos[self._vertices]
        moves = _repairs.displacement(self.session, self._triangles, correction, positions, self.deadline)
        if moves is None:
            return False
        along = self._along_joints(moves)
        self.data.qpos[self._places] += along
        self.data.qvel[self._dofs] = _repairs.slowed(self.data.qvel[self._dofs], along, self.session.dt)
        return True

    def _along_joints(self, vectors: NDArray[Any]) -> NDArray[Any]:
        """Vectors of all vertices as their joints take them: along the axes of the body, which does not turn."""
        axes = self.data.xmat[self._bodies[self._free]].reshape(-1, 3, 3)
        return np.einsum("kij,ki->kj", axes, vectors[self._free])

    def clear(self) -> None:
        """Takes the force back and switches self-collision on again."""
        self.data.qfrc_applied[self._dofs] -= self._force
        self._force = np.zeros_like(self._force)
        self.model.flex_selfcollide[self.flex] = self._switch

    def close(self) -> None:
        """Gives model and data back as they were, and ends the session."""
        self.clear()
        self.session.close()

    def __enter__(self) -> "Untangler":
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()
