"""Checks and converts the arrays of a caller for the native half."""

from __future__ import annotations

from typing import Any, Dict, Optional

import numpy as np


def indices(name: str, values: Any, width: int) -> "np.ndarray":
    """`values` as contiguous uint32, `n x width`, or a plain list for width 1."""
    given = np.asarray(values)
    if given.size and given.dtype.kind not in "iu":
        raise TypeError(f"{name} must be integers, not {given.dtype}")
    if given.size and (given.min() < 0 or given.max() > 0xFFFFFFFF):
        raise ValueError(f"{name} must be from 0 to 2**32 - 1")
    return _shaped(name, given.astype(np.uint32, copy=False), width)


def numbers(name: str, values: Any, width: int, length: Optional[int] = None) -> "np.ndarray":
    """`values` as contiguous float64, `length x width`, or a plain list for width 1."""
    array = _shaped(name, np.asarray(values, dtype=np.float64), width)
    if length is not None and len(array) != length:
        raise ValueError(f"{name} has {len(array)} elements; there are {length} vertices")
    return array


def _shaped(name: str, array: "np.ndarray", width: int) -> "np.ndarray":
    if width == 1:
        array = array.reshape(-1) if array.size == 0 else array
        if array.ndim != 1:
            raise ValueError(f"{name} must be a plain list, not of shape {array.shape}")
    else:
        array = array.reshape(-1, width) if array.ndim == 1 and array.size % width == 0 else array
        if array.ndim != 2 or array.shape[1] != width:
            raise ValueError(f"{name} must be of shape (n, {width}), not {array.shape}")
    return np.ascontiguousarray(array)


def cloth(
    num_vertices: int,
    triangles: Any,
    uv: Any,
    uv_triangles: Any,
    rest_positions: Any,
    pins: Any,
    layers: Any,
) -> Dict[str, Optional[bytes]]:
    """The arrays that a registration and a mesh to analyse have in common, as bytes."""
    faces = indices("triangles", triangles, 3)
    if uv is None and uv_triangles is not None:
        raise ValueError("uv_triangles without uv")
    if uv is not None and uv_triangles is None:
        if len(np.asarray(uv).reshape(-1, 2)) != num_vertices:
            raise ValueError("uv without uv_triangles must have one coordinate for each vertex")
        uv_triangles = faces

    def raw(array: Any) -> Optional[bytes]:
        return None if array is None else array.tobytes()

    if layers is not None:
        layers = indices("layers", layers, 1)
        if len(layers) != num_vertices:
            raise ValueError(f"layers has {len(layers)} elements; there are {num_vertices} vertices")
    return {
        "triangles": faces.tobytes(),
        "uvs": None if uv is None else numbers("uv", uv, 2).tobytes(),
        "uv_corners": None if uv_triangles is None else indices("uv_triangles", uv_triangles, 3).tobytes(),
        "rest_positions": None
        if rest_positions is None
        else numbers("rest_positions", rest_positions, 3, num_vertices).tobytes(),
        "pins": b"" if pins is None else indices("pins", pins, 1).tobytes(),
        "layers": raw(layers),
    }
