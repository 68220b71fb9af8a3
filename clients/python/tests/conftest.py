"""A real daemon for each test module, and meshes to send it.

`DAEMON_PROGRAM` names the daemon's program; without it, it is the one in the package, else in the repository's target
folders, else `untangled` on the path.
"""

import itertools
import os
import pathlib
import shutil
import subprocess

import numpy as np
import pytest

from untangled_cloth._program import PACKAGED

DEADLINE = 60.0
_numbers = itertools.count()


def binary():
    root = pathlib.Path(__file__).resolve().parents[3]
    places = [os.environ.get("DAEMON_PROGRAM"), PACKAGED]
    places += [root / "target" / profile / "untangled" for profile in ("release", "debug")]
    places += [shutil.which("untangled")]
    return next((str(place) for place in places if place and os.access(place, os.X_OK)), None)


class Daemon:
    def __init__(self, domain):
        self.domain = domain
        self.start()

    def start(self):
        command = [binary(), "serve", "--domain", self.domain]
        self.process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
        for line in self.process.stderr:
            if line.strip() == "ready":
                return
        raise RuntimeError("the daemon did not start")

    def stop(self, kill=False):
        """Ends it, and returns what it said since it was ready."""
        (self.process.kill if kill else self.process.terminate)()
        return self.process.communicate()[1]


@pytest.fixture
def daemon():
    if binary() is None:
        pytest.skip("there is no daemon: build it, or set DAEMON_PROGRAM")
    daemon = Daemon(f"py-{os.getpid()}-{next(_numbers)}")
    yield daemon
    daemon.stop()


@pytest.fixture
def domain(daemon):
    return daemon.domain


class Mesh:
    def __init__(self, vertices, triangles):
        self.vertices = np.array(vertices, np.float32)
        self.triangles = np.array(triangles, np.uint32)


@pytest.fixture
def crossed():
    """An upright triangle with its tip, vertex 5, through a level one."""
    vertices = [[0, 0, 0], [4, 0, 0], [0, 4, 0], [0.5, 1, 2], [1.5, 1, 2], [1, 1.1, -1]]
    return Mesh(vertices, [[0, 1, 2], [3, 4, 5]])


def grid(side, place):
    """A sheet of `side x side` vertices, `place(u, v)` with u and v from 0 to 1."""
    line = np.linspace(0, 1, side)
    u, v = (axis.ravel() for axis in np.meshgrid(line, line, indexing="ij"))
    index = np.arange(side * side).reshape(side, side)
    a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
    triangles = np.concatenate([np.stack(t, -1).reshape(-1, 3) for t in ((a, b, c), (a, c, d))])
    return np.stack(place(u, v), -1), triangles


@pytest.fixture
def sheets():
    """A level sheet, and one that stands with its lower rows through it."""
    side = 20
    below, triangles = grid(side, lambda u, v: (0.4 * u, 0.4 * v, 0.01 * np.sin(9 * u)))
    above, more = grid(side, lambda u, v: (0.4 * u, 0.193 + 0.04 * u, 0.4 * v - 0.051))
    return Mesh(np.concatenate([below, above]), np.concatenate([triangles, more + len(below)]))
