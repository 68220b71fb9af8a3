"""Sparse corrections and the filter of contacts."""

import numpy as np
import pytest

import untangled_cloth as untangled
from conftest import DEADLINE

ANY = 0xFFFFFFFF


def is_off(labels, first, second):
    """The rule, by brute force: `labels` of each vertex as a list."""
    ends = [[label for vertex in end for label in labels.get(int(vertex), [])] for end in (first, second)]
    return any(a >> 2 == b >> 2 and (a | b) & 3 == 3 or ANY in (a, b) for a in ends[0] for b in ends[1])


@pytest.mark.parametrize("dtype", [np.int32, np.uint32, np.int64])
def test_contact_filter_answers_as_brute_force_does(dtype):
    random = np.random.default_rng(3)
    labels = np.unique(np.stack([random.integers(0, 40, 60), random.integers(0, 6, 60) * 4 + 1], -1), axis=0)
    labels[:, 1] += random.integers(0, 3, len(labels))
    labels = np.concatenate([labels, [[45, ANY]]])
    by_vertex = {}
    for vertex, label in labels.tolist():
        by_vertex.setdefault(vertex, []).append(label)
    contacts = untangled.ContactFilter(50)
    contacts.set(labels)
    vertices, faces = random.integers(0, 50, 2000).astype(dtype), random.integers(0, 50, (2000, 3)).astype(dtype)
    off = contacts.vertex_face_off(vertices, faces)
    assert off.dtype == np.bool_ and 100 < off.sum() < 1900
    assert off.tolist() == [is_off(by_vertex, [vertex], face) for vertex, face in zip(vertices, faces)]
    first, second = random.integers(0, 50, (2, 2000, 2)).astype(dtype)
    off = contacts.edge_edge_off(first, second)
    assert off.tolist() == [is_off(by_vertex, a, b) for a, b in zip(first, second)]
    contacts.set(np.empty((0, 2), np.uint32))
    assert not contacts.edge_edge_off(first, second).any()


def test_contact_filter_takes_holes_strides_and_arrays_of_others():
    class Warp:
        def __init__(self, array):
            self.array = array

        def numpy(self):
            return self.array

    contacts = untangled.ContactFilter(6)
    contacts.set([[0, 5], [5, 6]])
    pairs = np.array([[0, 5, 4, 3], [-1, 5, 4, 3], [0, -1, -1, -1], [99, 0, 0, 0], [5, 1, 0, 2]], np.int32)
    assert contacts.vertex_face_off(pairs[:, 0], pairs[:, 1:]).tolist() == [True, False, False, False, True]
    assert contacts.vertex_face_off(Warp(pairs[:, 0]), Warp(pairs[:, 1:])).tolist()[0]
    assert contacts.edge_edge_off(pairs[:0, :2], pairs[:0, 2:]).tolist() == []
    for bad in (pairs[:, 0].astype(float), pairs[:, :2], np.array([2**40])):
        with pytest.raises((TypeError, ValueError)):
            contacts.vertex_face_off(bad, pairs[:, 1:])
    with pytest.raises(ValueError, match="differ in number"):
        contacts.vertex_face_off(pairs[:3, 0], pairs[:, 1:])


def test_sparse_corrections_read_as_dense_ones(sheets, domain):
    def open_session(**more):
        more.setdefault("pins", [0, 1])
        return untangled.Session(sheets.triangles, domain=domain, timeout=DEADLINE, **more)

    flat = sheets.vertices.copy()
    flat[400:] += [0, 0, 9]
    with open_session() as dense, open_session(sparse=True) as sparse, open_session(labels=True) as labelled:
        assert [s.is_sparse for s in (dense, sparse, labelled)] == [False, True, True]
        assert [s.has_labels for s in (dense, sparse, labelled)] == [False, False, True]
        for positions in (sheets.vertices, flat, sheets.vertices):
            ways = [session.exchange(positions, deadline=DEADLINE) for session in (dense, sparse, labelled)]
            plain = ways[0]
            for way in ways:
                assert np.array_equal(way.value, plain.value) and np.array_equal(way.flags, plain.flags)
                assert np.array_equal(way.mask, plain.mask) and way.flags[1] & untangled.PINNED
                vertices, values, flags = way.entries
                assert np.array_equal(values, plain.value[vertices])
                assert np.array_equal(flags, plain.flags[vertices])
                others = np.delete(np.arange(len(flat)), vertices)
                assert not plain.value[others].any() and not (plain.flags[others] & 7).any()
                assert not vertices.flags.writeable or way is plain
            tangled = plain.num_intersections > 0
            assert (len(ways[1].entries.vertices) > 0) == tangled and tangled == (len(ways[2].labels) > 0)
            assert [way.labels.shape for way in ways[:2]] == [(0, 2), (0, 2)]
            contacts = untangled.ContactFilter(labelled.num_vertices)
            contacts.set(ways[2])
            inside = np.flatnonzero(plain.inside)
            # What is inside may pass through some triangle of the other sheet, and through none of its own.
            faces = np.repeat(sheets.triangles, len(inside), axis=0)
            off = contacts.vertex_face_off(np.tile(inside, len(sheets.triangles)), faces)
            assert off.any() == (tangled and len(inside) > 0)
