"""Several objects as one mesh in metres, and back. Nothing here needs Blender.

A `Sheet` is an object as the add-on reads it: `vertices` in the object's own space, `matrix` from there to the world in
Blender's units. The library works on all sheets of a command together, in metres.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import List, Optional

import numpy as np


class Unusable(Exception):
    """What a user can put right: one line, which names the object."""


@dataclass
class Sheet:
    """One object: its mesh, its place, and its part in the command."""

    name: str
    vertices: np.ndarray
    triangles: np.ndarray
    matrix: np.ndarray = field(default_factory=lambda: np.eye(4))
    body: bool = False
    layer: int = 0
    pins: Optional[np.ndarray] = None

    def __post_init__(self) -> None:
        if not self.body and abs(np.linalg.det(self.matrix[:3, :3])) < 1e-30:
            raise Unusable(f"{self.name}: its scale is zero")
        if not len(self.triangles):
            raise Unusable(f"{self.name}: it has no faces")

    def in_world(self) -> np.ndarray:
        """Its vertices in the world, in Blender's units, in double precision."""
        return self.vertices.astype(float) @ self.matrix[:3, :3].T + self.matrix[:3, 3]

    def from_world(self, displacements: np.ndarray) -> np.ndarray:
        """Displacements in the world, in its own space."""
        return displacements @ np.linalg.inv(self.matrix[:3, :3]).T


@dataclass
class World:
    """All sheets of a command as one mesh in metres."""

    sheets: List[Sheet]
    metres: float
    """Metres in one of Blender's units."""
    vertices: np.ndarray
    triangles: np.ndarray
    starts: np.ndarray
    """Where the vertices of each sheet start, and their number at the end."""

    @classmethod
    def of(cls, sheets: List[Sheet], metres: float = 1.0) -> "World":
        if not any(not sheet.body for sheet in sheets):
            raise Unusable("there is no cloth among the selected objects: all are bodies")
        starts = np.concatenate([[0], np.cumsum([len(sheet.vertices) for sheet in sheets])])
        triangles = []
        for sheet, start in zip(sheets, starts):
            # A mirrored object shows its faces from behind.
            mirrored = np.linalg.det(sheet.matrix[:3, :3]) < 0
            triangles.append((sheet.triangles[:, ::-1] if mirrored else sheet.triangles) + start)
        vertices = np.concatenate([sheet.in_world() for sheet in sheets]) * metres
        bad = np.flatnonzero(~np.isfinite(vertices).all(1))
        if len(bad):
            owner = int(np.searchsorted(starts, bad[0], "right")) - 1
            raise Unusable(f"{sheets[owner].name}: vertex {bad[0] - starts[owner]} has a coordinate that is no number")
        return cls(sheets, metres, vertices, np.concatenate(triangles), starts)

    def roles(self) -> dict:
        """`body`, `layers` and `pins` as the library takes them; what nobody asked for is left out."""
        roles = {}
        body = [self.range(k) for k, sheet in enumerate(self.sheets) if sheet.body]
        if body:
            roles["body"] = np.concatenate(body)
        pins = [self.starts[k] + sheet.pins for k, sheet in enumerate(self.sheets) if sheet.pins is not None]
        if pins and sum(map(len, pins)):
            roles["pins"] = np.concatenate(pins)
        cloth = {sheet.layer for sheet in self.sheets if not sheet.body}
        if len(cloth) > 1:
            if 0 in cloth:
                unordered = next(sheet.name for sheet in self.sheets if not sheet.body and not sheet.layer)
                raise Unusable(f"{unordered}: it has no layer, and other selected objects have one: give it one too")
            layers = np.zeros(len(self.vertices), np.uint32)
            for k, sheet in enumerate(self.sheets):
                layers[self.range(k)] = sheet.layer
            roles["layers"] = layers
        return roles

    def range(self, k: int) -> np.ndarray:
        """Vertices of one sheet."""
        return np.arange(self.starts[k], self.starts[k + 1])

    def owner(self, vertex: int) -> int:
        """The sheet of a vertex."""
        return int(np.searchsorted(self.starts, vertex, "right")) - 1

    def displacements(self, k: int, vertices: np.ndarray) -> np.ndarray:
        """What leads a sheet, in its own space, to these `vertices` of the world; exactly zero where none moved."""
        own = self.range(k)
        moved = (vertices[own] != self.vertices[own]).any(1)
        back = np.zeros((len(own), 3))
        back[moved] = self.sheets[k].from_world((vertices[own] - self.vertices[own])[moved] / self.metres)
        return back
