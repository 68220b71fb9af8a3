"""One exchange from a tangled cloth to one that is certified clean: two square sheets through each other.

Start `untangled serve` first. The first half waits for the repair. The second half goes on meanwhile, as a simulator
with a frame rate would.
"""

import numpy as np

import untangled_cloth as untangled


def scene():
    """A level sheet, and one that stands and has its lower rows through it."""
    u, v = (axis.ravel() for axis in np.meshgrid(np.arange(20) * 0.02, np.arange(20) * 0.02, indexing="ij"))
    below = np.stack([u, v, 0.01 * np.sin(9 * u)], axis=1)
    above = np.stack([u, 0.193 + 0.1 * u, v - 0.051], axis=1)
    a = (np.arange(19)[:, None] * 20 + np.arange(19)).ravel()
    sheet = np.concatenate([np.stack([a, a + 20, a + 21], 1), np.stack([a, a + 21, a + 1], 1)])
    return np.concatenate([below, above]).astype(np.float32), np.concatenate([sheet, sheet + 400])


def main():
    tangled, triangles = scene()
    with untangled.Session(triangles, repairs=True) as session:
        repair = session.repair(tangled)
        print(f"certified: {repair.certified}, {repair.summary['num_moved']} vertices moved")
        # In single precision, as the cloth was sent: then these are the bits that were checked.
        cloth = repair.repaired(tangled)
        # A session lends one repair at a time.
        del repair
        print(f"{session.exchange(cloth).num_intersections} edges pierce a face")

        cloth, step = tangled.copy(), 0
        session.ask_for_repair()
        # A real host uses value and mask while it waits: see ../../INTEGRATE.md.
        while session.exchange(cloth).num_intersections > 0:
            step += 1
            repair = session.poll_repair()
            if repair is not None:
                # Of an earlier frame: its displacements are added to the positions of now.
                cloth = repair.repaired(cloth)
                del repair
                print(f"repaired after step {step}")


if __name__ == "__main__":
    main()
