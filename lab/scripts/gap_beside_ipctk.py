"""Repairs meshes with a gap, and lets ipctk look at what was written, as a table in Markdown.

    pip install ipctk numpy
    cargo build --release
    python lab/scripts/gap_beside_ipctk.py [--program target/release/untangled] MESH.obj ...

Each mesh is repaired with gaps of 1 % and 10 % of its mean edge. ipctk measures the least distance of all primitives
without a common vertex in the output as it is, and rounded to single precision. Then both search the output for pairs
below ten per cent of the mean edge: `ours` is the stage `gap` of `untangled check --json` (the search, with exact
decisions, and the nearest pair), `ipctk` its broad phase (LBVH) and the distances of what that found.
"""

import argparse
import json
import pathlib
import subprocess
import sys
import tempfile
import time

try:
    import ipctk
    import numpy as np
except ImportError as missing:
    print(f"SKIPPED: there is no Python module {missing.name}", file=sys.stderr)
    sys.exit(0)


def read(path):
    """Positions and triangles of an OBJ; nothing if it has other polygons."""
    positions, faces = [], []
    for line in path.read_text(errors="replace").splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            positions.append([float(word) for word in words[1:4]])
        elif words[:1] == ["f"]:
            faces.append([int(word.split("/")[0]) for word in words[1:]])
    if any(len(face) != 3 for face in faces):
        return None
    faces = np.array([[index - 1 if index > 0 else index + len(positions) for index in face] for face in faces])
    return np.asfortranarray(positions, dtype=float), faces.astype(np.int32)


class Mesh:
    """A cloth as ipctk sees it. Vertices that no triangle uses are left out."""

    def __init__(self, positions, faces):
        used, faces = np.unique(faces, return_inverse=True)
        self.positions = np.asfortranarray(positions[used])
        faces = np.asfortranarray(faces.reshape(-1, 3), dtype=np.int32)
        edges = ipctk.edges(faces)
        self.mesh = ipctk.CollisionMesh(self.positions, edges, faces)
        lengths = np.linalg.norm(self.positions[edges[:, 0]] - self.positions[edges[:, 1]], axis=1)
        self.mean_edge = lengths.mean()

    def search(self, distance):
        """The seconds of both phases, and the least distance of what is below a distance."""
        start = time.perf_counter()
        candidates = ipctk.Candidates()
        candidates.build(self.mesh, self.positions, distance / 2, ipctk.LBVH())
        found = ipctk.NormalCollisions()
        found.build(candidates, self.mesh, self.positions, distance)
        seconds = time.perf_counter() - start
        least = found.compute_minimum_distance(self.mesh, self.positions) ** 0.5 if len(found) else np.inf
        return seconds, least


def untangled(program, *arguments):
    """The JSON document of a command."""
    words = [str(word) for word in (program, *arguments, "--json", "--weld", "off")]
    return json.loads(subprocess.run(words, capture_output=True, check=False).stdout)


def row(program, path, folder):
    given = read(path)
    if given is None:
        print(f"SKIPPED: {path.name} has polygons that are no triangles", file=sys.stderr)
        return
    mean_edge = float(Mesh(*given).mean_edge)
    tenth = 0.1 * mean_edge
    for part in (0.01, 0.1):
        gap, out = part * mean_edge, folder / "out.obj"
        report = untangled(program, "fix", path, "-o", out, "--overwrite", "--gap", gap)
        positions, faces = read(out)
        rounded = positions.astype(np.float32).astype(float)
        least = [Mesh(seen, faces).search(2 * gap)[1] / gap for seen in (positions, rounded)]
        shown = [f"{value:.4f}" if np.isfinite(value) else "> 2" for value in least]
        theirs = min(Mesh(positions, faces).search(tenth)[0] for _ in range(3))
        ours = min(untangled(program, "check", out, "--gap", tenth)["time_us"]["gap"] for _ in range(3))
        below = report["gap"]["num_pairs_below_before"]
        left = report["gap"]["num_pairs_below"]
        steps = sum(step["method"] == "gap" for step in report["history"])
        print(
            f"| {path.stem} | {len(faces)} | {100 * part:g} % | {below} | {left} | {steps} | {report['seconds']:.2f} "
            f"| {shown[0]} | {shown[1]} | {ours / 1e3:.1f} | {theirs * 1e3:.1f} |",
            flush=True,
        )


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--program", type=pathlib.Path, default=pathlib.Path("target/release/untangled"))
    arguments.add_argument("meshes", nargs="+", type=pathlib.Path)
    chosen = arguments.parse_args()
    print("| mesh | #Tri | gap | below before | left | gap steps | s | least, double | single | ours ms | ipctk ms |")
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for path in chosen.meshes:
            row(chosen.program, path, pathlib.Path(folder))


if __name__ == "__main__":
    main()
