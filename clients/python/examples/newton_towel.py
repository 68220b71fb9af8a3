"""Newton's VBD with self-contact, with and without help: newton_towel.py [--out FOLDER].

The first run compiles Newton's kernels, which takes some minutes on two cores.
"""

import sys

import warp as wp

import controls
import newton
from newton_cloth import simulate
from towel import towel

# The mask by vertex, and by the labels of single contacts.
CONTROLS = {name: {"labels": False, **told} if told else told for name, told in controls.CONTROLS.items()}
CONTROLS["force + labels"] = {"repair": "never"}


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
