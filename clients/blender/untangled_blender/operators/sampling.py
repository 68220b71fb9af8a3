"""A range of frames as files for the program: meshes and point caches, in the space of the first cloth.

There the program writes what a Mesh Cache modifier reads, without a rounding in between: what it certified is what
Blender shows.
"""

import numpy as np

from ..plain import caches
from ..plain.world import Unusable
from ..sheets import is_body, polygons, sheet

SAME = 1e-6
"""Two places are one if the entries of their matrices differ by no more than this share of the scale."""


def uniform_scale(name, matrix) -> float:
    """The scale of an object whose matrix turns and moves besides."""
    squares = matrix[:3, :3].T @ matrix[:3, :3]
    scale = np.sqrt(np.trace(squares) / 3)
    if not scale or abs(squares - scale**2 * np.eye(3)).max() > 1e-4 * scale**2:
        raise Unusable(f"{name}: its scale is not the same in all directions: apply the scale first")
    return float(scale)


class Samples:
    """The files of a shot in `folder`, written frame by frame. Cloth objects come first, the innermost at the front."""

    def __init__(self, context, objects, folder) -> None:
        self.context, self.folder = context, folder
        cloth = (obj for obj in objects if not is_body(obj))
        self.cloth = sorted(cloth, key=lambda obj: (obj.untangled.layer, obj.name))
        self.bodies = [obj for obj in objects if is_body(obj)]
        if not self.cloth:
            raise Unusable("there is no cloth among the selected objects: all are bodies")
        if len({obj.untangled.layer for obj in self.cloth}) not in (1, len(self.cloth)):
            raise Unusable("two of the selected objects are the same layer: give each its own")
        self.layers = len(self.cloth) > 1 and self.cloth[0].untangled.layer != self.cloth[1].untangled.layer
        self.scale = None
        self._writers = {}

    def add(self, frame) -> None:
        """Writes one frame."""
        self.context.scene.frame_set(frame)
        cloth = [sheet(self.context, obj) for obj in self.cloth]
        place = cloth[0].matrix
        scale = uniform_scale(cloth[0].name, place)
        if self.scale is not None and abs(scale - self.scale) > SAME * scale:
            raise Unusable(f"{cloth[0].name}: its scale changes in frame {frame}")
        self.scale = scale if self.scale is None else self.scale
        for other in cloth[1:]:
            if abs(other.matrix - place).max() > SAME * scale:
                raise Unusable(f"{other.name}: it is not placed like {cloth[0].name}: apply the transforms of both")
        self._write("cloth", np.concatenate([found.vertices for found in cloth]), frame)
        for k, obj in enumerate(self.bodies):
            found = sheet(self.context, obj)
            self._write(f"body{k}", (found.in_world() - place[:3, 3]) @ np.linalg.inv(place[:3, :3]).T, frame)

    def _write(self, name, vertices, frame) -> None:
        if name not in self._writers:
            self._writers[name] = caches.Writer(self.folder / f"{name}.pc2", len(vertices), frame)
        try:
            self._writers[name].add(vertices)
        except ValueError:
            raise Unusable(f"frame {frame}: an object has other vertices than in the frame before") from None

    def finish(self) -> None:
        """Ends the caches, and writes meshes and pins beside them."""
        self.close()
        pinned, first = [], 0
        for k, obj in enumerate(self.cloth):
            own = sheet(self.context, obj)
            caches.write_obj(self.folder / f"cloth{k}.obj", own.vertices, polygons(obj.data))
            if own.pins is not None:
                pinned += (own.pins + first).tolist()
            first += len(own.vertices)
        self.pins = bool(pinned)
        (self.folder / "pins.txt").write_text("\n".join(map(str, pinned)))
        graph = self.context.evaluated_depsgraph_get()
        for k, obj in enumerate(self.bodies):
            found = obj.evaluated_get(graph)
            mesh = found.to_mesh()
            caches.write_obj(self.folder / f"body{k}.obj", [vertex.co for vertex in mesh.vertices], polygons(mesh))
            found.to_mesh_clear()

    def close(self) -> None:
        for writer in self._writers.values():
            writer.close()
