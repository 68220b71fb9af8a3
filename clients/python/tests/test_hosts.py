"""The host examples, where their simulators are installed: tangled without help, clean with force and mask."""

import importlib.util
import os
import pathlib
import subprocess
import sys

import numpy as np
import pytest

import untangled
from conftest import binary

EXAMPLES = pathlib.Path(__file__).resolve().parents[1] / "examples"


def run(example, package, control, tmp_path, *more):
    """The columns of the one line of a control: start, after the steps with help, most in the steps after."""
    if importlib.util.find_spec(package) is None:
        pytest.skip(f"{package} is not installed: pip install './clients/python[{package}]'")
    if binary() is None:
        pytest.skip("there is no daemon: build it, or set DAEMON_PROGRAM")
    command = [sys.executable, str(EXAMPLES / example), "--only", control, "--out", str(tmp_path), *more]
    done = subprocess.run(command, env={**os.environ, "DAEMON_PROGRAM": binary()}, capture_output=True, text=True)
    lines = [line for line in done.stdout.splitlines() if line.startswith(f"| {control} |")]
    assert lines, done.stdout + done.stderr
    for picture in ["before.png", f"after-{control}.png".replace("+", "and").replace(" ", "-")]:
        assert (tmp_path / picture).read_bytes().startswith(b"\x89PNG")
    return [cell.strip() for cell in lines[0].split("|")[2:5]]


def test_newton_example_without_help_stays_tangled(tmp_path):
    start, helped, after = run("newton_towel.py", "newton", "no help", tmp_path, "--steps", "40", "--after", "10")
    assert int(start) > 20 and int(helped) > 0 and int(after) > 0


def test_newton_example_with_force_and_mask_ends_clean(tmp_path):
    start, helped, after = run("newton_towel.py", "newton", "force + mask", tmp_path)
    assert int(start) > 20 and (helped, after) == ("0", "0")


def test_towel_scene_is_tangled_and_its_rest_state_is_clean():
    sys.path.insert(0, str(EXAMPLES))
    from towel import towel

    vertices, triangles, rest, pins = towel()
    assert vertices.shape == (496, 3) and triangles.shape == (900, 3) and len(pins) == 33
    # The two layers are mirror images, so that edges meet edges: the check counts faces that touch, the analysis
    # decides for one side by symbolic perturbation.
    found = untangled.analyse(vertices, triangles).num_intersections
    assert untangled.count_intersections(vertices, triangles) >= found > 20
    assert untangled.count_intersections(rest, triangles) == 0
    assert np.isfinite(vertices).all()
