"""Shared by the examples of all hosts: controls, a table, and pictures.

A demonstration needs controls: no help, the mask alone, the force alone, both, and repairs, the adapters' default. A
control is what an adapter is told beside its defaults.
"""

import argparse
import os
import pathlib
import shutil
import subprocess
import sys

import numpy as np

import picture
import untangled_cloth as untangled
from untangled_cloth._program import PACKAGED

CONTROLS = {
    "no help": {"use_force": False, "use_mask": False, "repair": "never"},
    "mask only": {"use_force": False, "repair": "never"},
    "force without mask": {"use_mask": False, "repair": "never"},
    "force + mask": {"repair": "never"},
    "repair": {},
}


class Daemon:
    """A daemon of this program's own, unless `domain` names one that runs."""

    def __init__(self, domain):
        self.domain, self.process = domain, None
        if domain is None:
            root = pathlib.Path(__file__).resolve().parents[3]
            places = [os.environ.get("DAEMON_PROGRAM"), PACKAGED]
            places += [root / "target" / profile / "untangled" for profile in ("release", "debug")]
            places += [shutil.which("untangled")]
            program = next((place for place in places if place and os.access(place, os.X_OK)), None)
            if program is None:
                sys.exit("there is no daemon: build it with `cargo build --release`, or set DAEMON_PROGRAM")
            self.domain = f"example-{os.getpid()}"
            self.process = subprocess.Popen([program, "serve", "--domain", self.domain], stderr=subprocess.DEVNULL)

    def __enter__(self):
        return self.domain

    def __exit__(self, *_):
        if self.process:
            self.process.terminate()
            self.process.wait()


def arguments(description):
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--out", type=pathlib.Path, help="folder for before.png and after.png of each control")
    parser.add_argument("--domain", help="of a daemon that runs; without it one is started")
    parser.add_argument("--steps", type=int, help="most steps with help")
    parser.add_argument("--after", type=int, default=60, help="steps after the mask is gone")
    parser.add_argument("--only", help="one control, by name")
    return parser.parse_args()


def run(title, simulate, scene, options, controls=CONTROLS):
    """Runs `simulate(told)` for each control; it yields a context and the positions after each step.

    Counts come from an exact check that shares no code with the untangler. Returns whether the last control ended clean
    and stayed so.
    """
    vertices, triangles, rest, _ = scene
    layers = rest[triangles][:, :, 0].mean(1) < rest[:, 0].max() / 2
    count = lambda positions: untangled.count_intersections(positions, triangles)

    def draw(name, positions):
        if options.out:
            options.out.mkdir(parents=True, exist_ok=True)
            marked = untangled.analyse(positions, triangles).face_pairs.ravel()
            picture.render(options.out / name, positions, triangles, layers, marked)

    draw("before.png", vertices)
    columns = f"after steps with help | most in the {options.after} steps after | steps until it stays clean"
    print(f"{title}\n\n| control | edges that pierce a face: start | {columns} |")
    print("|---|---|---|---|---|", flush=True)
    good = False
    for name, told in controls.items():
        if options.only not in (None, name):
            continue
        start, helped, worst, clean_at, positions = count(vertices), None, 0, None, vertices
        for step, (phase, positions) in enumerate(simulate(told)):
            now = count(positions)
            if phase == "help":
                helped = now
                # What is clean and tangles again was not clean.
                clean_at = (clean_at or step + 1) if now == 0 else None
            else:
                worst = max(worst, now)
        strained = not np.isfinite(positions).all()
        after = f"{worst}{' (not finite)' if strained else ''}"
        print(f"| {name} | {start} | {helped} | {after} | {'never' if clean_at is None else clean_at} |", flush=True)
        draw(f"after {name}.png".replace("+", "and").replace(" ", "-"), positions)
        good = (helped, worst) == (0, 0)
    return good
