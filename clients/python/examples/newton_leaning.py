"""Newton's VBD where layers lean on each other under gravity, with and without help: newton_leaning.py [--out FOLDER].

Each scene with contacts off within two rings, the solver's default, and within one. The first run compiles Newton's
kernels, which takes some minutes on two cores.
"""

import sys

import warp as wp

import controls
import newton
from leaning import SCENES
from newton_cloth import simulate

CONTROLS = {
    "no help": controls.CONTROLS["no help"],
    "force + labels": {"repair": "never"},
    "repair": {},
}


def main():
    wp.config.quiet = True
    options = controls.arguments(__doc__)
    good = True
    with controls.Daemon(options.domain) as domain:
        for name, make in SCENES.items():
            scene, ground = make(), name == "folded towel"
            for rings in (2, 1):
                title = f"Newton {newton.__version__}, {name}, {len(scene[1])} triangles, contacts off in {rings} rings"
                simulated = lambda told: simulate(
                    scene, domain, options, told, rings=rings, gravity=(0.0, 0.0, -9.81), ground=ground
                )
                ended_clean = controls.run(title, simulated, scene, options, CONTROLS)
                good &= ended_clean or rings > 1
                print()
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
