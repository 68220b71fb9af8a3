"""Checks and converts what a caller passes, for the native half."""

from __future__ import annotations

import json
import math
from typing import Any, Dict, Mapping, Optional

import numpy as np
from numpy.typing import NDArray


def host(name: str, values: Any) -> NDArray[Any]:
    """`values` as a numpy array: without a copy where numpy, or an object's own `numpy()`, can look at its memory."""
    if hasattr(values, "__cuda_array_interface__"):
        raise TypeError(
            f"{name} lies in the memory of a GPU: copy it to the host first, with `.numpy()` (Warp), `.cpu()` "
            "(PyTorch) or `.get()` (CuPy)"
        )
    known = any(hasattr(values, way) for way in ("__array_interface__", "__array__", "__buffer__"))
    if not known and callable(getattr(values, "numpy", None)):
        values = values.numpy()
    try:
        array = np.asarray(values)
    except ValueError as error:
        raise ValueError(f"{name} can't be read as an array: {error}") from None
    if array.dtype == object:
        raise TypeError(f"{name} can't be read as an array of numbers: it is of type {type(values).__name__}")
    return array


def document(settings: Optional[Mapping[str, Any]]) -> str:
    """Settings as a JSON object; numbers of numpy are numbers."""
    plain = {} if settings is None else dict(settings)
    for name, value in plain.items():
        if isinstance(value, (np.generic, np.ndarray)) and value.ndim == 0:
            plain[name] = value = value.item()
        if isinstance(value, float) and not math.isfinite(value):
            raise ValueError(f"setting {name!r} is {value}, which a session can't be sent")
        try:
            json.dumps(value)
        except (TypeError, ValueError):
            message = f"setting {name!r} must be a number, a text, a bool or None, not of type {type(value).__name__}"
            raise TypeError(message) from None
    return json.dumps(plain)


def indices(name: str, values: Any, width: int) -> NDArray[np.uint32]:
    """`values` as contiguous uint32, `n x width`, or a plain list for width 1."""
    given = host(name, values)
    if given.size and given.dtype.kind not in "iu":
        raise TypeError(f"{name} must be integers, not {given.dtype}")
    if given.size and (given.min() < 0 or given.max() > 0xFFFFFFFF):
        raise ValueError(f"{name} must be from 0 to 2**32 - 1")
    return _shaped(name, given.astype(np.uint32, copy=False), width)


def contact_ends(name: str, values: Any, width: int) -> bytes:
    """`values`, `n x width` indices of vertices, as bytes of uint32; those below zero become larger than any."""
    given = host(name, values)
    if given.size and given.dtype.kind not in "iu":
        raise TypeError(f"{name} must be integers, not {given.dtype}")
    if given.dtype.itemsize > 4 and given.size and (given.min() < -(2**31) or given.max() > 0xFFFFFFFF):
        raise ValueError(f"{name} must be from -2**31 to 2**32 - 1")
    return _shaped(name, given.astype(np.uint32, copy=False), width).tobytes()


def numbers(name: str, values: Any, width: int, length: Optional[int] = None) -> NDArray[np.float64]:
    """`values` as contiguous float64, `length x width`, or a plain list for width 1."""
    array = _shaped(name, np.asarray(host(name, values), dtype=np.float64), width)
    if length is not None and len(array) != length:
        raise ValueError(f"{name} has {len(array)} elements; there are {length} vertices")
    return array


def _shaped(name: str, array: NDArray[Any], width: int) -> NDArray[Any]:
    if width == 1:
        array = array.reshape(-1) if array.size == 0 else array
        if array.ndim != 1:
            raise ValueError(f"{name} must be a plain list, not of shape {array.shape}")
    else:
        array = array.reshape(-1, width) if array.ndim == 1 and array.size % width == 0 else array
        if array.ndim != 2 or array.shape[1] != width:
            raise ValueError(f"{name} must be of shape (n, {width}), not {array.shape}")
    return np.ascontiguousarray(array)


def count_vertices(triangles: Any, masses: Any, rest_positions: Any, layers: Any) -> int:
    """The longest of what has one element for each vertex, so that one that is too short is named; at least the highest
    index plus one."""
    faces = indices("triangles", triangles, 3)
    counts = [int(faces.max()) + 1 if faces.size else 0]
    if masses is not None:
        counts.append(len(numbers("masses", masses, 1)))
    if rest_positions is not None:
        counts.append(len(numbers("rest_positions", rest_positions, 3)))
    if layers is not None:
        counts.append(len(indices("layers", layers, 1)))
    return max(counts)


def cloth(
    num_vertices: int,
    triangles: Any,
    uv: Any,
    uv_triangles: Any,
    rest_positions: Any,
    pins: Any,
    layers: Any,
    body: Any = None,
) -> Dict[str, Optional[bytes]]:
    """The arrays that a registration and a mesh to analyse have in common, as bytes."""
    faces = indices("triangles", triangles, 3)
    if uv is None and uv_triangles is not None:
        raise ValueError("uv_triangles without uv")
    if uv is not None and uv_triangles is None:
        num_coordinates = len(numbers("uv", uv, 2))
        if num_coordinates != num_vertices:
            raise ValueError(
                f"uv has {num_coordinates} elements; there are {num_vertices} vertices, and uv without uv_triangles "
                "must have one coordinate for each vertex"
            )
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
        "body": b"" if body is None else indices("body", body, 1).tobytes(),
    }
