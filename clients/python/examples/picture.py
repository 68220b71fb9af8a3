"""Pictures of a cloth without any other package: a depth buffer and a PNG file."""

import struct
import zlib

import numpy as np

FRONT, REAR, MARKED = np.array([[70, 120, 190], [220, 170, 90], [200, 40, 40]], float)


def render(path, vertices, triangles, layers, marked=(), eye=(1.0, -0.75, 0.35), size=(640, 640)):
    """Writes a picture of the cloth as seen from the direction `eye`.

    `layers` says which triangles have the second colour, `marked` which the third.
    """
    toward = np.array(eye, float) / np.linalg.norm(eye)
    right = np.cross([0.0, 0.0, 1.0], toward)
    right /= np.linalg.norm(right)
    up = np.cross(toward, right)
    vertices = np.asarray(vertices, float)
    flat = np.stack([vertices @ right, vertices @ up], -1)
    low, high = flat.min(0), flat.max(0)
    width, height = size
    scale = 0.9 * min(width / (high[0] - low[0]), height / (high[1] - low[1]))
    flat = (flat - (low + high) / 2) * [scale, -scale] + [width / 2, height / 2]
    depth = vertices @ toward
    image = np.full((height, width, 3), 255.0)
    buffer = np.full((height, width), -np.inf)
    marked = set(int(face) for face in marked)
    for face, corners in enumerate(triangles):
        p, z = flat[corners], depth[corners]
        normal = np.cross(vertices[corners[1]] - vertices[corners[0]], vertices[corners[2]] - vertices[corners[0]])
        light = 0.35 + 0.65 * abs(normal @ [0.8, -0.5, 0.4]) / (np.linalg.norm(normal) * 1.02 + 1e-30)
        colour = (MARKED if face in marked else REAR if layers[face] else FRONT) * min(light, 1.0)
        x0, y0 = np.maximum(np.floor(p.min(0)).astype(int), 0)
        x1, y1 = np.minimum(np.ceil(p.max(0)).astype(int) + 1, size)
        x, y = np.meshgrid(np.arange(x0, x1) + 0.5, np.arange(y0, y1) + 0.5)
        (ax, ay), (bx, by), (cx, cy) = p
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if abs(area) < 1e-9 or x.size == 0:
            continue
        wb = ((x - ax) * (cy - ay) - (y - ay) * (cx - ax)) / area
        wc = ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / area
        here = z[0] + wb * (z[1] - z[0]) + wc * (z[2] - z[0])
        window = buffer[y0:y1, x0:x1]
        seen = (wb >= 0) & (wc >= 0) & (wb + wc <= 1) & (here > window)
        window[seen] = here[seen]
        image[y0:y1, x0:x1][seen] = colour
    _write(path, image.astype(np.uint8))


def _write(path, image):
    height, width, _ = image.shape
    rows = np.concatenate([np.zeros((height, 1), np.uint8), image.reshape(height, -1)], 1).tobytes()

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    with open(path, "wb") as file:
        chunks = [chunk(b"IHDR", header), chunk(b"IDAT", zlib.compress(rows, 6)), chunk(b"IEND", b"")]
        file.write(b"\x89PNG\r\n\x1a\n" + b"".join(chunks))
