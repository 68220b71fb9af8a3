"""Files that the program reads and writes: point caches (PC2) and the mesh as OBJ. Nothing here needs Blender."""

from __future__ import annotations

import pathlib
import struct
from typing import List

import numpy as np

HEADER = struct.Struct("<12siiffi")
MAGIC = b"POINTCACHE2\0"


class Writer:
    """A PC2 file, written frame by frame; its header has the number of frames once it is closed."""

    def __init__(self, path: pathlib.Path, num_points: int, start: float = 0.0) -> None:
        self.path, self.num_points, self.start, self.num_frames = path, num_points, start, 0
        self.file = open(path, "wb")
        self._write_header()

    def _write_header(self) -> None:
        self.file.seek(0)
        self.file.write(HEADER.pack(MAGIC, 1, self.num_points, self.start, 1.0, self.num_frames))

    def add(self, vertices: np.ndarray) -> None:
        """One frame, `num_points x 3`."""
        if len(vertices) != self.num_points:
            raise ValueError(f"{self.path.name}: {len(vertices)} points, not {self.num_points} as before")
        self.file.write(np.ascontiguousarray(vertices, "<f4").tobytes())
        self.num_frames += 1

    def close(self) -> None:
        if not self.file.closed:
            self._write_header()
            self.file.close()


def read(path: pathlib.Path) -> np.ndarray:
    """All frames of a PC2 file, `frames x points x 3` of float32, mapped and not loaded."""
    with open(path, "rb") as file:
        magic, _, num_points, _, _, num_frames = HEADER.unpack(file.read(HEADER.size))
    if magic != MAGIC:
        raise ValueError(f"{path}: no PC2 file")
    return np.memmap(path, "<f4", "r", HEADER.size, (num_frames, num_points, 3))


def write_obj(path: pathlib.Path, vertices: np.ndarray, polygons: List) -> None:
    """A mesh of polygons, each a list of its vertices."""
    with open(path, "w") as file:
        file.writelines("v %.9g %.9g %.9g\n" % tuple(vertex) for vertex in vertices)
        file.writelines("f " + " ".join(str(int(k) + 1) for k in polygon) + "\n" for polygon in polygons)


def part(path: pathlib.Path, out: pathlib.Path, first: int, end: int) -> None:
    """Writes the points from `first` to before `end` of a cache as a cache of their own."""
    frames = read(path)
    writer = Writer(out, end - first)
    for frame in frames:
        writer.add(frame[first:end])
    writer.close()
