"""Newton's VBD with self-contact, with and without help: newton_towel.py [--out FOLDER].

The first run compiles Newton's kernels, which takes some minutes on two cores.
"""

import sys

import numpy as np
import warp as wp

import controls
import newton
from towel import DENSITY, GRAVITY, towel
from untangled_cloth.hosts.newton import Untangler

DT = 1 / 120
ITERATIONS = 8
# The mask by vertex, and by the labels of single contacts.
CONTROLS = {name: {"labels": False, **told} if told else told for name, told in controls.CONTROLS.items()}
CONTROLS["force + labels"] = {"repair": "never"}


def build(scene):
    vertices, triangles, rest, pins = scene
    builder = newton.ModelBuilder(gravity=GRAVITY)
    builder.add_cloth_mesh(
        pos=wp.vec3(0.0, 0.0, 0.0),
        rot=wp.quat_identity(),
        scale=1.0,
        vel=wp.vec3(0.0, 0.0, 0.0),
        vertices=[wp.vec3(*map(float, position)) for position in rest],
        indices=triangles.ravel().tolist(),
        density=DENSITY,
        tri_ke=300.0,
        tri_ka=300.0,
        tri_kd=1e-3,
        edge_ke=1e-3,
        edge_kd=1e-4,
        particle_radius=0.005,
    )
    builder.color(include_bending=True)
    model = builder.finalize()
    model.soft_contact_ke, model.soft_contact_kd, model.soft_contact_mu = 100.0, 1e-3, 0.1
    # The mesh was added at rest, so that nothing is strained there; it begins tangled. What has no mass does not move.
    mass, inverse = model.particle_mass.numpy(), model.particle_inv_mass.numpy()
    mass[pins], inverse[pins] = 0.0, 0.0
    model.particle_mass.assign(mass)
    model.particle_inv_mass.assign(inverse)
    return model


def simulate(scene, domain, options, told):
    vertices, _, rest, _ = scene
    model = build(scene)
    solver = newton.solvers.SolverVBD(
        model,
        iterations=ITERATIONS,
        particle_enable_self_contact=True,
        particle_self_contact_margin=0.006,
        particle_self_contact_gap=0.006,
    )
    states = [model.state(), model.state()]
    for state in states:
        state.particle_q.assign(vertices)
    control = model.control()
    uv = np.ascontiguousarray(rest[:, :2])
    with Untangler(model, solver, dt=DT, uv=uv, rest_positions=rest, domain=domain, **told) as untangler:
        phases = [("help", untangler.before_step)] * (options.steps or 60) + [("after", None)] * options.after
        untangler.deadline = 10.0
        for phase, help in phases:
            states[0].clear_forces()
            if help is None:
                untangler.clear_mask()
            else:
                help(states[0])
            solver.step(states[0], states[1], control, None, DT)
            states.reverse()
            yield phase, states[0].particle_q.numpy().copy()


def main():
    wp.config.quiet = True
    options = controls.arguments(__doc__)
    scene = towel()
    with controls.Daemon(options.domain) as domain:
        title = f"Newton {newton.__version__}, SolverVBD, self-contact on, {len(scene[1])} triangles"
        simulated = lambda told: simulate(scene, domain, options, told)
        good = controls.run(title, simulated, scene, options, CONTROLS)
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
