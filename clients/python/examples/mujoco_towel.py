"""MuJoCo's flex with self-collision, with and without help: mujoco_towel.py [--out FOLDER]."""

import sys

import mujoco
import numpy as np

import controls
from towel import DENSITY, GRAVITY, LENGTH, WIDTH, towel
from untangled_cloth.hosts.mujoco import Untangler

TIMESTEP = 1 / 480
EVERY = 4


def build(scene):
    vertices, triangles, rest, pins = scene
    text = lambda values: " ".join(f"{value:.7g}" for value in np.ravel(values))
    # The flex is made at rest, so that nothing is strained there; it begins tangled.
    xml = f"""<mujoco>
      <option timestep="{TIMESTEP}" gravity="{text(GRAVITY)}" integrator="discrete"/>
      <size memory="512M"/>
      <worldbody>
        <flexcomp name="towel" type="direct" dim="2" mass="{DENSITY * LENGTH * WIDTH}" radius="0.004"
                  point="{text(rest)}" element="{text(triangles)}">
          <elasticity young="1e5" poisson="0.3" thickness="1e-3" elastic2d="both" damping="1e-3"/>
          <contact selfcollide="auto" condim="1"/>
          <pin id="{text(pins)}"/>
        </flexcomp>
      </worldbody>
    </mujoco>"""
    return mujoco.MjModel.from_xml_string(xml)


def simulate(scene, domain, options, told):
    vertices, triangles, rest, pins = scene
    model = build(scene)
    data = mujoco.MjData(model)
    bodies = model.flex_vertbodyid
    # Pinned vertices belong to the world; where they are is said by the model.
    model.flex_vert[pins] = vertices[pins]
    free = np.setdiff1d(np.arange(len(vertices)), pins)
    for vertex in free:
        address = model.body_dofadr[bodies[vertex]]
        data.qpos[address : address + 3] = vertices[vertex] - rest[vertex]
    mujoco.mj_forward(model, data)
    uv = np.ascontiguousarray(rest[:, :2])
    with Untangler(model, data, every=EVERY, uv=uv, rest_positions=rest, domain=domain, **told) as untangler:
        untangler.deadline = 10.0
        for frame in range((options.steps or 60) + options.after):
            phase = "help" if frame < (options.steps or 60) else "after"
            for _ in range(EVERY):
                if phase == "help":
                    untangler.before_step()
                else:
                    untangler.clear()
                mujoco.mj_step(model, data)
            yield phase, data.flexvert_xpos.copy()


def main():
    options = controls.arguments(__doc__)
    scene = towel()
    with controls.Daemon(options.domain) as domain:
        size = f"{len(scene[1])} triangles, {EVERY} steps a frame"
        title = f"MuJoCo {mujoco.__version__}, flex, self-collision on, {size}"
        good = controls.run(title, lambda told: simulate(scene, domain, options, told), scene, options)
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
