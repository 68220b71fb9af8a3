"""What may be passed: arrays of other packages, numbers of numpy, and words for what can't be read."""

import numpy as np
import pytest

import untangled_cloth as untangled
from conftest import DEADLINE
from untangled_cloth import _arrays


class OnGpu:
    """An array as CuPy, PyTorch and Warp show it, in memory that a processor can't read."""

    __cuda_array_interface__ = {"shape": (6, 3), "typestr": "<f4", "data": (1 << 40, False), "version": 3}

    def __array__(self, *_, **__):
        raise AssertionError("its memory is not the host's")


class WithNumpy:
    """An array that only its own method shows, as arrays of structures may be."""

    def __init__(self, array):
        self.array = array

    def numpy(self):
        return self.array


def test_arrays_on_a_gpu_are_refused_with_what_to_do(crossed, domain):
    with pytest.raises(TypeError, match="vertices lies in the memory of a GPU.*Warp"):
        untangled.analyse(OnGpu(), crossed.triangles)
    with pytest.raises(TypeError, match="masses lies in the memory of a GPU"):
        untangled.Session(crossed.triangles, masses=OnGpu(), domain=domain)
    with untangled.Session(crossed.triangles, domain=domain, timeout=DEADLINE) as session:
        with pytest.raises(TypeError, match="positions lies in the memory of a GPU"):
            session.exchange(OnGpu())
        assert session.last_frame == 0


def test_arrays_with_a_numpy_method_are_read(crossed):
    vertices, triangles = WithNumpy(crossed.vertices), WithNumpy(crossed.triangles)
    assert untangled.analyse(vertices, triangles).num_intersections == 2


def test_warp_arrays_of_vectors_are_read(crossed):
    wp = pytest.importorskip("warp")
    vertices = wp.array(crossed.vertices, dtype=wp.vec3, device="cpu")
    triangles = wp.array(crossed.triangles.astype(np.int32).ravel(), dtype=wp.int32, device="cpu")
    assert untangled.analyse(vertices, triangles).num_intersections == 2


def test_objects_that_are_no_arrays_are_refused_by_name(crossed):
    with pytest.raises(TypeError, match="vertices can't be read.*dict"):
        untangled.analyse({"a": 1}, crossed.triangles)
    with pytest.raises(ValueError, match="triangles can't be read"):
        untangled.analyse(crossed.vertices, [[0, 1, 2], [3, 4]])


@pytest.mark.parametrize("name", ["masses", "rest_positions", "layers"])
def test_arrays_one_vertex_short_are_named(crossed, name):
    arrays = {"masses": np.ones(6), "rest_positions": crossed.vertices, "layers": np.zeros(6, int)}
    arrays[name] = arrays[name][:5]
    for given in (arrays, {name: arrays[name]}):
        with pytest.raises(ValueError, match=f"{name} has 5 elements; there are 6 vertices"):
            untangled.Session(crossed.triangles, domain="nobody-home", timeout=0, **given)
    with pytest.raises(ValueError, match="uv has 5 elements; there are 6 vertices"):
        untangled.Session(crossed.triangles, np.zeros((5, 2)), domain="nobody-home", timeout=0)


def test_settings_may_be_numbers_of_numpy(crossed, domain):
    given = {"path_rings": np.int64(2), "stiffness_per_step2": np.float32(0.25), "thickness_m": np.array(0.5)}
    given["deadline_us"] = np.uint32(10**6)
    assert _arrays.document({"a": np.bool_(True), **given}) == (
        '{"a": true, "path_rings": 2, "stiffness_per_step2": 0.25, "thickness_m": 0.5, "deadline_us": 1000000}'
    )
    with untangled.Session(crossed.triangles, settings=given, domain=domain, timeout=DEADLINE) as session:
        session.update_settings(given)
        assert session.exchange(crossed.vertices, deadline=DEADLINE).num_intersections == 2
    assert untangled.analyse(crossed.vertices, crossed.triangles, settings=given).num_intersections == 2


def test_settings_that_cannot_be_sent_are_named():
    cases = ((object(), TypeError), (np.ones(3), TypeError), (np.nan, ValueError), (float("inf"), ValueError))
    for value, kind in cases:
        with pytest.raises(kind, match="'path_rings'"):
            _arrays.document({"path_rings": value})
