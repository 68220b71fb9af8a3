"""The host examples, where their simulators are installed: tangled without help, clean with it."""

import importlib.util
import os
import pathlib
import subprocess
import sys
import warnings
from types import SimpleNamespace

import numpy as np
import pytest

import untangled_cloth as untangled
from conftest import DEADLINE, binary
from untangled_cloth.hosts import _repairs

EXAMPLES = pathlib.Path(__file__).resolve().parents[1] / "examples"


def run(example, package, control, tmp_path, *more):
    """The columns of the one line of a control: start, after the steps with help, most in the steps after."""
    if importlib.util.find_spec(package) is None:
        pytest.skip(f"{package} is not installed: pip install 'untangled-cloth[{package}]'")
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


def test_newton_example_with_repairs_ends_clean(tmp_path):
    start, helped, after = run("newton_towel.py", "newton", "repair", tmp_path, "--steps", "10", "--after", "20")
    assert int(start) > 20 and (helped, after) == ("0", "0")


@pytest.mark.parametrize(("rings", "warned"), [(2, 1), (1, 0)])
def test_newton_solver_that_leaves_out_near_contacts_is_warned_of(rings, warned):
    adapter = pytest.importorskip("untangled_cloth.hosts.newton", exc_type=ImportError)
    solver = SimpleNamespace(particle_topological_contact_filter_threshold=rings)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        adapter._warn_of_contacts_left_out(solver)
    assert len(caught) == warned and all("threshold=1" in str(warning.message) for warning in caught)


def test_mujoco_example_with_repairs_ends_clean(tmp_path):
    start, helped, after = run("mujoco_towel.py", "mujoco", "repair", tmp_path)
    assert int(start) > 20 and (helped, after) == ("0", "0")


def test_velocities_after_a_repair_lose_only_what_leads_back():
    moves = np.array([[0.01, 0, 0], [0.01, 0, 0], [1e-6, 0, 0], [0, 0, 0]])
    before = np.array([[-0.5, 0, -2], [0.5, 0, -2], [-0.5, 0, 0], [-0.5, 1, 2]])
    after = _repairs.slowed(before, moves, 0.01)
    assert np.allclose(after, [[0, 0, -2], [0.5, 0, -2], [-0.4999, 0, 0], [-0.5, 1, 2]])


def test_repair_of_a_tangled_frame_is_taken_and_leaves_nothing(domain, sheets):
    settings = _repairs.with_repair({"quality": "fast"}, "always")
    with untangled.Session(sheets.triangles, repairs=True, settings=settings, domain=domain) as session:
        correction = session.exchange(sheets.vertices, deadline=DEADLINE)
        moves = _repairs.displacement(session, sheets.triangles, correction, sheets.vertices, DEADLINE)
        assert untangled.count_intersections(sheets.vertices, sheets.triangles) > 0
        assert untangled.count_intersections(sheets.vertices + moves, sheets.triangles) == 0


@pytest.mark.parametrize("helps", [True, False])
def test_late_repair_is_taken_only_where_it_leaves_fewer_intersections(sheets, helps):
    moves = np.zeros_like(sheets.vertices)
    moves[len(moves) // 2 :, 2] = 0.1 if helps else 0.0
    late = SimpleNamespace(certified=True, frame=1, displacement=moves, repaired=lambda positions: positions + moves)
    session = SimpleNamespace(has_repairs=True, poll_repair=lambda: late)
    now = SimpleNamespace(being_repaired=False, frame=2)
    taken = _repairs.displacement(session, sheets.triangles, now, sheets.vertices, 0.0)
    assert (taken is not None) == helps


def test_repair_by_an_unknown_name_is_refused_in_words():
    with pytest.raises(ValueError, match="never, auto, always"):
        _repairs.with_repair(None, "sometimes")


def test_leaning_scenes_are_tangled_and_clean_at_rest():
    sys.path.insert(0, str(EXAMPLES))
    from leaning import SCENES

    for make in SCENES.values():
        vertices, triangles, rest, _ = make()
        assert untangled.analyse(vertices, triangles).num_intersections > 20
        assert untangled.count_intersections(rest, triangles) == 0


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
