"""Shared by the Newton examples: a model of a scene, and VBD with self-contact that simulates it."""

import numpy as np
import warp as wp

import newton
from towel import DENSITY, GRAVITY
from untangled_cloth.hosts.newton import Untangler

DT = 1 / 120
ITERATIONS = 8


def build(scene, gravity=GRAVITY, ground=False):
    """The model of a scene's rest positions, triangles and pins, in metres; `ground` is the plane z = 0."""
    vertices, triangles, rest, pins = scene
    builder = newton.ModelBuilder(gravity=gravity)
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
    if ground:
        builder.add_ground_plane()
    builder.color(include_bending=True)
    model = builder.finalize()
    model.soft_contact_ke, model.soft_contact_kd, model.soft_contact_mu = 100.0, 1e-3, 0.1
    # The mesh was added at rest, so that nothing is strained there; it begins tangled. What has no mass does not move.
    mass, inverse = model.particle_mass.numpy(), model.particle_inv_mass.numpy()
    mass[pins], inverse[pins] = 0.0, 0.0
    model.particle_mass.assign(mass)
    model.particle_inv_mass.assign(inverse)
    return model


def simulate(scene, domain, options, told, *, rings=1, gravity=GRAVITY, ground=False):
    """Yields whether there was help and the positions after each step.

    Contacts between elements within `rings` rings of each other are off in the solver. With 2, its default, neither
    contact nor limit of a step keeps the faces on both sides of a sharp fold apart.
    """
    vertices, _, rest, _ = scene
    model = build(scene, gravity, ground)
    solver = newton.solvers.SolverVBD(
        model,
        iterations=ITERATIONS,
        particle_enable_self_contact=True,
        particle_self_contact_margin=0.006,
        particle_self_contact_gap=0.006,
        particle_topological_contact_filter_threshold=rings,
    )
    pipeline = newton.CollisionPipeline(model) if ground else None
    contacts = pipeline.contacts() if ground else None
    states = [model.state(), model.state()]
    for state in states:
        state.particle_q.assign(vertices)
    control = model.control()
    uv = np.ascontiguousarray(rest[:, :2])
    with Untangler(model, solver, dt=DT, uv=uv, rest_positions=rest, domain=domain, **told) as untangler:
        phases = [("help", untangler.before_step)] * (options.steps or 60) + [("after", None)] * options.after
        # Long enough for any repair, also on a busy machine.
        untangler.deadline = 60.0
        for phase, help in phases:
            states[0].clear_forces()
            if help is None:
                untangler.clear_mask()
            else:
                help(states[0])
            if pipeline:
                pipeline.collide(states[0], contacts)
            solver.step(states[0], states[1], control, contacts, DT)
            states.reverse()
            yield phase, states[0].particle_q.numpy().copy()
