"""The extension in a Blender without a window, and scenes for it. `pip install bpy==4.5.* untangled-cloth pytest`."""

import pathlib
import sys

import numpy as np
import pytest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))


def grid(side, place):
    """Vertices and quadrangles of a sheet, `place(u, v)` with u and v from 0 to 1."""
    line = np.linspace(0, 1, side)
    u, v = (axis.ravel() for axis in np.meshgrid(line, line, indexing="ij"))
    index = np.arange(side * side).reshape(side, side)
    corners = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
    return np.stack(place(u, v), -1).astype(np.float32), np.stack(corners, -1).reshape(-1, 4)


def level(side=20):
    """A level sheet of 0.4 m."""
    return grid(side, lambda u, v: (0.4 * u, 0.4 * v, 0.01 * np.sin(9 * u)))


def standing(side=20):
    """A sheet that stands on the level one, with its lower rows through it."""
    return grid(side, lambda u, v: (0.4 * u, 0.193 + 0.04 * u, 0.4 * v - 0.051))


def curled(side=30):
    """A sheet of 0.3 m x 1 m whose end curls back and through it: far from there nothing need move."""
    angle = np.linspace(0, 1.5 * np.pi, 40)
    x = np.concatenate([[0.0], 0.6 + 0.08 * np.sin(angle), [0.52]])
    z = np.concatenate([[0.0], 0.08 - 0.08 * np.cos(angle), [-0.025]])
    length = np.concatenate([[0], np.cumsum(np.hypot(np.diff(x), np.diff(z)))])
    along = lambda t, values: np.interp(t * length[-1], length, values)
    return grid(side, lambda u, v: (along(u, x), 0.3 * v, along(u, z)))


def joined(*meshes):
    """Several meshes as one."""
    starts = np.cumsum([0] + [len(vertices) for vertices, _ in meshes])
    return (
        np.concatenate([vertices for vertices, _ in meshes]),
        np.concatenate([faces + start for (_, faces), start in zip(meshes, starts)]),
    )


@pytest.fixture(scope="session")
def registered():
    bpy = pytest.importorskip("bpy", reason="there is no bpy here: pip install 'bpy==4.5.*', on Python 3.11")
    import untangled_blender

    untangled_blender.register()
    yield bpy
    untangled_blender.unregister()


@pytest.fixture
def scene(registered, tmp_path):
    """An empty scene, as a file in a folder of its own."""
    bpy = registered
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    return Scene(bpy)


class Scene:
    def __init__(self, bpy):
        self.bpy, self.ops = bpy, bpy.ops.untangled

    def add(self, name, mesh, **settings):
        """A selected object of a mesh."""
        bpy = self.bpy
        data = bpy.data.meshes.new(name)
        data.from_pydata(mesh[0].tolist(), [], mesh[1].tolist())
        obj = bpy.data.objects.new(name, data)
        bpy.context.collection.objects.link(obj)
        obj.select_set(True)
        bpy.context.view_layer.objects.active = obj
        for key, value in settings.items():
            setattr(obj.untangled, key, value)
        bpy.context.view_layer.update()
        return obj

    def world(self, *objects):
        """What is evaluated of objects: vertices in the world, and triangles, as one mesh."""
        from untangled_blender.sheets import sheet

        found = [sheet(self.bpy.context, obj) for obj in objects]
        return joined(*[(sheet.in_world(), sheet.triangles) for sheet in found])

    def count(self, *objects):
        """Edges that pierce a face, by the judge."""
        import untangled_cloth

        vertices, triangles = self.world(*objects)
        return untangled_cloth.count_intersections(vertices, triangles)
