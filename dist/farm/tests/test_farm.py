"""The job templates, run by `openjd` (`pip install openjd-cli`) with the program of the Python package."""

import json
import pathlib
import shutil
import subprocess
import sys

import numpy as np
import pytest

import untangled_cloth as untangled

FARM = pathlib.Path(__file__).resolve().parents[1]
NUM_FRAMES = 10


@pytest.fixture(scope="module")
def openjd():
    beside = pathlib.Path(sys.executable).with_name("openjd")
    program = str(beside) if beside.exists() else shutil.which("openjd")
    if program is None:
        pytest.skip("there is no openjd here: pip install openjd-cli")
    return program


@pytest.fixture(scope="module")
def program():
    try:
        return untangled.program()
    except FileNotFoundError as error:
        pytest.skip(str(error))


def run(openjd, template, step, **parameters):
    command = [openjd, "run", str(FARM / template), "--step", step, "--run-dependencies"]
    for name, value in parameters.items():
        command += ["-p", f"{name}={value}"]
    return subprocess.run(command, capture_output=True, text=True)


def sheets(side=8):
    """A level sheet, and one that stands above it: vertices, and faces as lines of an OBJ."""
    line = np.linspace(0, 0.4, side)
    u, v = (axis.ravel() for axis in np.meshgrid(line, line, indexing="ij"))
    vertices = np.concatenate([np.stack([u, v, 0 * u], 1), np.stack([u, 0 * u + 0.19, v], 1)]).astype("<f4")
    faces = []
    for first in (1, 1 + side * side):
        for a in range(side - 1):
            corner = first + a * side + np.arange(side - 1)
            faces += [f"f {k} {k + side} {k + side + 1} {k + 1}" for k in corner]
    return vertices, faces


def obj(path, vertices, faces):
    path.write_text("".join("v %.9g %.9g %.9g\n" % tuple(vertex) for vertex in vertices) + "\n".join(faces) + "\n")


@pytest.fixture
def shot(tmp_path):
    """`cloth.obj` and a cache in both formats, in which the upper sheet dips into the lower one."""
    vertices, faces = sheets()
    frames = np.repeat(vertices[None], NUM_FRAMES, 0)
    frames[:, 64:, 2] += (0.1 * np.cos(np.linspace(0, 2 * np.pi, NUM_FRAMES)) + 0.05)[:, None].astype("<f4")
    folder = tmp_path / "a shot"
    folder.mkdir()
    obj(folder / "cloth.obj", vertices, faces)
    counts = np.array([128, NUM_FRAMES], "<i4")
    times = np.array([1, 1], "<f4").tobytes()
    pc2 = b"POINTCACHE2\0" + np.int32(1).tobytes() + counts[:1].tobytes() + times + counts[1:].tobytes()
    (folder / "in.pc2").write_bytes(pc2 + frames.tobytes())
    mdd = counts[::-1].astype(">i4").tobytes() + (np.arange(NUM_FRAMES) / 24).astype(">f4").tobytes()
    (folder / "in.mdd").write_bytes(mdd + frames.astype(">f4").tobytes())
    return folder


@pytest.mark.parametrize("template", ["shot.yaml", "garments.yaml"])
def test_template_is_valid(openjd, template):
    subprocess.run([openjd, "check", str(FARM / template)], check=True)


@pytest.mark.parametrize("cache", ["in.pc2", "in.mdd"])
def test_shot_in_tasks_has_the_bytes_of_one_run(openjd, program, shot, cache):
    whole = shot / f"whole{cache[2:]}"
    fix = [program, "fix", shot / "cloth.obj", "--cache", shot / cache, "-o", whole]
    subprocess.run(fix, check=True, capture_output=True)
    parameters = {"Mesh": shot / "cloth.obj", "Cache": shot / cache, "OutFolder": shot / "out", "LastFrame": 9}
    done = run(openjd, "shot.yaml", "Join", **parameters, FramesPerTask=4, Program=program)
    assert done.returncode == 0, done.stdout + done.stderr
    assert (shot / "out" / cache).read_bytes() == whole.read_bytes()
    assert whole.read_bytes() != (shot / cache).read_bytes(), "there is something to repair"
    reports = sorted((shot / "out/parts").glob("*.json"))
    lines = [json.loads(line) for report in reports for line in report.read_text().splitlines()]
    assert [line["frame"] for line in lines if "frame" in line] == list(range(NUM_FRAMES))
    assert len(reports) == 3 and not list((shot / "out/parts").glob(f"*{cache[2:]}"))


def test_shot_that_does_not_come_clean_is_written_and_fails_the_job(openjd, program, shot):
    # All is pinned.
    (shot / "all.pins").write_text(" ".join(map(str, range(128))))
    pins = shot.parent / "pins"
    shutil.copy(shot / "all.pins", pins)
    parameters = {"Mesh": shot / "cloth.obj", "Cache": shot / "in.pc2", "OutFolder": shot / "out", "LastFrame": 9}
    done = run(openjd, "shot.yaml", "Join", **parameters, Options=f"--pin {pins}", Program=program)
    assert done.returncode != 0 and "some frames are not clean" in done.stdout, done.stdout + done.stderr
    assert (shot / "out/in.pc2").read_bytes() == (shot / "in.pc2").read_bytes()


def test_garments_of_a_folder_are_shared_and_what_is_left_is_listed(openjd, program, tmp_path):
    vertices, faces = sheets()
    (tmp_path / "in").mkdir()
    for k in range(4):
        crossed = vertices + np.float32([0, 0, 0.1])
        crossed[64:, 2] -= 0.11 + 0.01 * k
        obj(tmp_path / f"in/dress {k}.obj", crossed, faces)
    folders = {"InFolder": tmp_path / "in", "OutFolder": tmp_path / "out", "NumTasks": 3, "Program": program}
    done = run(openjd, "garments.yaml", "List", **folders)
    assert done.returncode == 0 and "4 of 4 garments are clean" in done.stdout, done.stdout + done.stderr
    for k in range(4):
        report = json.loads((tmp_path / f"out/dress {k}.obj.json").read_text())
        assert report["clean"] and report["before"]["num_face_pairs"] > 0
    (tmp_path / "in/bad.obj").write_text("v 0 0 0\n")
    done = run(openjd, "garments.yaml", "List", **folders)
    assert done.returncode != 0, "a file that can't be read fails its task"
    assert (tmp_path / "out/dress 3.obj.status").read_text() == "0\n", "and keeps no other from being repaired"
