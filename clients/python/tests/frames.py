"""As clients/c/tests/programs/frames.c: frames.py DOMAIN SCENE OUT [REPEATS]."""

import statistics
import sys
import time

import numpy as np

import untangled_cloth as untangled


def main(domain, scene, out, repeats="1"):
    with open(scene, "rb") as file:
        num_vertices, num_triangles, num_frames = np.fromfile(file, np.uint32, 3)
        triangles = np.fromfile(file, np.uint32, 3 * num_triangles).reshape(-1, 3)
        masses = np.fromfile(file, np.float64, num_vertices)
        states = np.fromfile(file, np.float32, 3 * num_vertices * num_frames).reshape(num_frames, num_vertices, 3)
    timed = int(repeats) > 1
    times = []
    session = untangled.Session(triangles, masses=masses, domain=domain, timeout=60, paths=not timed)
    with session, open(out, "wb") as file:
        for repeat in range(int(repeats)):
            for state in states:
                begin = time.perf_counter()
                correction = session.exchange(state, dt=0.01, time=0.0, deadline=60)
                force, flags = correction.force, correction.flags
                times.append(1e6 * (time.perf_counter() - begin))
                if not timed:
                    vertices = np.empty(num_vertices, [("force", np.float32, 3), ("flags", np.uint32)])
                    vertices["force"], vertices["flags"] = force, flags
                    layout = [("position", np.float64, 3), ("faces", np.uint32, 2)]
                    points = np.empty(len(correction.paths.points), layout)
                    points["position"], points["faces"] = correction.paths.points, correction.paths.faces
                    for part in (vertices, correction.paths.records, points):
                        file.write(part.tobytes())
                del correction, force, flags
    print(f"{statistics.median(times):.3f}")


if __name__ == "__main__":
    main(*sys.argv[1:])
