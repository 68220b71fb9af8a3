"""Scenes in which layers lean on each other: what is masked too widely falls through."""

import numpy as np

EDGE = 0.025  # m


def _grid(columns, rows):
    """Places in the plane in metres, indices by column and row, and triangles."""
    u, v = (axis.ravel() * EDGE for axis in np.meshgrid(np.arange(columns), np.arange(rows), indexing="ij"))
    index = np.arange(columns * rows).reshape(columns, rows)
    a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
    triangles = np.concatenate([np.stack(t, -1).reshape(-1, 3) for t in ((a, b, c), (a, c, d))])
    return u, v, index, triangles.astype(np.uint32)


def _two_sheets(lower, upper, pins_of_upper):
    """Two sheets of 24 x 24 vertices; the lower one is pinned all around."""
    u, v, index, triangles = _grid(24, 24)
    flat = np.stack([u, v, 0 * u], -1)
    rest = np.concatenate([flat, flat + [1.0, 0.0, 0.0]])
    around = [index[0], index[-1], index[:, 0], index[:, -1]]
    pins = np.unique(np.concatenate([*around, len(u) + pins_of_upper(index)])).astype(np.uint32)
    vertices = np.concatenate([lower(u, v), upper(u, v)]).astype(np.float32)
    return vertices, np.concatenate([triangles, triangles + np.uint32(len(u))]), rest, pins


def curtain():
    """A curtain, pinned along its upper edge, through a level sheet."""
    level = lambda u, v: np.stack([u, v, 0 * u + 0.5], -1)
    hangs = lambda u, v: np.stack([u, 0.29 + 0.02 * np.sin(8 * u), v + 0.09], -1)
    return _two_sheets(level, hangs, lambda index: index[:, -1])


def corner():
    """Two level sheets; a corner of the upper one, which is pinned at the opposite edge, goes through the lower one."""
    level = lambda u, v: np.stack([u, v, 0 * u + 0.5], -1)
    bent = lambda u, v: np.stack([u, v + 0.003, 0.52 - 0.09 * np.clip((u + v - 0.9) / 0.2, 0, 1)], -1)
    return _two_sheets(level, bent, lambda index: index[0])


def folded():
    """A crumpled towel on the ground, folded twice so sharply that layers meet at the folds, a wave through them."""
    u, v, _, triangles = _grid(46, 16)
    third = 15 * EDGE
    layer = np.minimum(u // third, 2)
    along = u - layer * third
    x = np.where(layer == 1, third - along, along)
    # From layer to layer within two edges of a fold; in between layers are level, 8 mm apart.
    ramp = lambda distance: np.clip(0.5 + distance / (4 * EDGE), 0, 1)
    z = 0.008 * (1 + ramp(u - third) + ramp(u - 2 * third))
    z += 0.011 * (layer == 1) * np.sin(v * 30) * np.sin(np.pi * along / third)
    vertices = np.stack([x, v, z], -1) + 0.006 * np.random.default_rng(1).uniform(-1, 1, (len(u), 3))
    vertices[:, 2] += 0.008 - vertices[:, 2].min()
    vertices = vertices.astype(np.float32)
    return vertices, triangles, np.stack([u, v, 0 * u], -1), np.zeros(0, np.uint32)


SCENES = {"curtain through a level sheet": curtain, "corner through a level sheet": corner, "folded towel": folded}
