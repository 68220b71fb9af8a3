"""The program in the package, and daemons that it starts."""

import subprocess
import sys

import numpy as np
import pytest

import untangled_cloth as untangled
from conftest import DEADLINE, binary
from untangled_cloth._program import PACKAGED

OBJ = "v 0 0 0\nv 4 0 0\nv 0 4 0\nv 0.5 1 2\nv 1.5 1 2\nv 1 1.1 -1\nf 1 2 3\nf 4 5 6\n"


@pytest.mark.skipif(not PACKAGED.exists(), reason="this package was installed without the program: see dist/wheel")
def test_program_of_the_package_repairs_a_file_under_its_own_name(tmp_path):
    (tmp_path / "crossed.obj").write_text(OBJ)
    command = [sys.executable, "-m", "untangled_cloth", "fix", "crossed.obj", "-o", "clean.obj"]
    assert subprocess.run(command, cwd=tmp_path, capture_output=True).returncode == 0
    vertices = [line.split()[1:] for line in (tmp_path / "clean.obj").read_text().splitlines() if line[0] == "v"]
    assert untangled.count_intersections(np.array(vertices, float), [[0, 1, 2], [3, 4, 5]]) == 0
    told = subprocess.run(command[:3] + ["--help"], capture_output=True, text=True).stdout
    assert "Usage: untangled-cloth <COMMAND>" in told and untangled.program() == str(PACKAGED)


def test_program_that_is_not_in_the_package_is_missed_in_words(tmp_path, monkeypatch):
    monkeypatch.setattr("untangled_cloth._program.PACKAGED", tmp_path / "untangled")
    with pytest.raises(FileNotFoundError, match="compiled from the sources"):
        untangled.Daemon()


@pytest.mark.skipif(binary() is None, reason="there is no daemon: build it, or set DAEMON_PROGRAM")
def test_daemon_serves_within_its_with_and_no_longer(crossed):
    with untangled.Daemon(program=binary()) as daemon:
        with untangled.Session(crossed.triangles, domain=daemon.domain, timeout=DEADLINE) as session:
            assert session.exchange(crossed.vertices, deadline=DEADLINE).num_intersections == 2
    assert daemon.process.returncode == 0
    with pytest.raises(untangled.NoDaemon):
        untangled.Session(crossed.triangles, domain=daemon.domain, timeout=0)


def test_daemon_that_ends_at_once_is_an_error(tmp_path):
    with pytest.raises(untangled.NoDaemon, match="exit code 1"):
        untangled.Daemon(program="/bin/false")
    with pytest.raises(untangled.NoDaemon, match="in time"):
        program = tmp_path / "sleeps"
        program.write_text("#!/bin/sh\nexec sleep 60\n")
        program.chmod(0o755)
        untangled.Daemon(program=program, timeout=0.2)
