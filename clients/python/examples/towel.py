"""The scene of the host examples: a towel over a line, with a corner of its front layer through the rear one.

1 m x 0.5 m in two layers, 496 vertices, 900 triangles. It is pinned along the line, along the lower edge of the rear
layer, and at the other lower corner of the front layer. Gravity leans towards the rear and pulls the corner further
through, so that the tangle can't fall out, and the pins keep the front layer from slipping through the rear one.
"""

import numpy as np

COLUMNS, ROWS = 31, 16
LENGTH, WIDTH = 1.0, 0.5
GRAVITY = (-4.0, 0.0, -9.0)
DENSITY = 0.2  # kg/m^2
GAP = 0.03  # half the distance of the layers, m


def towel():
    """Vertices (float32), triangles, rest positions in the plane (which are texture coordinates too), pins."""
    lines = np.linspace(0, LENGTH, COLUMNS), np.linspace(0, WIDTH, ROWS)
    u, v = (axis.ravel() for axis in np.meshgrid(*lines, indexing="ij"))
    below = np.abs(u - LENGTH / 2)
    side = np.sign(u - LENGTH / 2)  # front is +1
    bend = np.tanh(below / 0.05)
    vertices = np.stack([side * GAP * bend, v, 1.0 - below + 0.02 * (1 - bend)], -1)
    # The corner of the front layer, bent through the rear one along a slanted line.
    corner = np.clip((u - 0.72) / 0.28 + (v - 0.22) / 0.28 - 0.75, 0, None) * (side > 0)
    vertices[:, 0] -= 0.16 * np.minimum(corner, 1.0)
    vertices[:, 1] += 0.003 * corner
    index = np.arange(COLUMNS * ROWS).reshape(COLUMNS, ROWS)
    a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
    triangles = np.concatenate([np.stack(t, -1).reshape(-1, 3) for t in ((a, b, c), (a, c, d))]).astype(np.uint32)
    rest = np.stack([u, v, 0 * u], -1)
    pins = np.concatenate([index[COLUMNS // 2], index[0], index[-1, :1]]).astype(np.uint32)
    return vertices.astype(np.float32), triangles, rest, pins
