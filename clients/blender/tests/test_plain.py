"""Modules of the extension that need no Blender."""

import numpy as np
import pytest
from conftest import joined, level, standing

import untangled_cloth as untangled
from untangled_blender.plain import caches, findings, solve
from untangled_blender.plain.world import Sheet, Unusable, World


def triangles(quads):
    return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def sheet(name, mesh, **more):
    return Sheet(name, mesh[0], triangles(mesh[1]), **more)


def place(scale, move):
    matrix = np.diag([*scale, 1.0])
    matrix[:3, 3] = move
    return matrix


def test_world_of_scaled_and_moved_objects_leads_displacements_back():
    turned = place((2, 2, 2), (1, 0, 0)) @ np.array([[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
    world = World.of([sheet("a", level()), sheet("b", standing(), matrix=turned)], metres=0.01)
    assert np.allclose(world.vertices[401], 0.01 * (turned @ [*standing()[0][1], 1])[:3])
    moved = world.vertices.copy()
    moved[401] += 0.01 * np.array([0, 0, 0.5])
    back = world.displacements(1, moved)
    assert np.allclose(back[1], [0, 0, 0.25]) and not np.delete(back, 1, 0).any()
    assert not world.displacements(0, moved).any() and world.owner(400) == 1 and world.owner(399) == 0


def test_faces_of_a_mirrored_object_keep_their_side_in_the_world():
    world = World.of([sheet("a", level()), sheet("b", level(), matrix=place((1, 1, -1), (0, 0, 0)))])
    for face in (0, len(world.triangles) // 2):
        a, b, c = world.vertices[world.triangles[face]]
        normal = np.cross(b - a, c - a)
        assert (normal[2] > 0) == (face == 0)


def test_roles_are_body_layers_and_pins_of_all_objects():
    parts = [sheet("a", level(3), layer=1, pins=np.array([2])), sheet("b", level(3), layer=2, pins=np.array([0]))]
    roles = World.of([*parts, sheet("c", level(3), body=True)]).roles()
    assert roles["pins"].tolist() == [2, 9] and roles["body"].tolist() == list(range(18, 27))
    assert roles["layers"].tolist() == 9 * [1] + 9 * [2] + 9 * [0]
    assert World.of([sheet("a", level(3))]).roles() == {}


@pytest.mark.parametrize(
    ("parts", "words"),
    [
        (lambda: [sheet("a", level(3), body=True)], "no cloth"),
        (lambda: [sheet("a", level(3), layer=1), sheet("b", level(3))], "b: it has no layer"),
        (lambda: [sheet("flat", level(3), matrix=place((1, 1, 0), (0, 0, 0)))], "flat: its scale is zero"),
        (lambda: [sheet("a", level(3)), sheet("b", (np.full((9, 3), np.nan), level(3)[1]))], "b: vertex 0"),
        (lambda: [Sheet("dust", level(3)[0], np.zeros((0, 3), int))], "dust: it has no faces"),
    ],
)
def test_what_can_not_be_used_is_named(parts, words):
    with pytest.raises(Unusable, match=words):
        World.of(parts()).roles()


def test_findings_list_paths_with_objects_places_and_segments():
    world = World.of([sheet("below", level()), sheet("above", standing())], metres=0.5)
    analysis = untangled.analyse(world.vertices, world.triangles)
    found = findings.findings(world, analysis)
    assert found and found[0].objects == "below, above" and found[0].length >= found[-1].length
    assert abs(found[0].centre[1] - 0.21) < 0.03, "a centre is in Blender's units"
    segments = findings.segments_by_type(found)
    assert findings.LEGEND.keys() == findings.COLOURS.keys()
    assert set(segments) <= set(findings.COLOURS) and all(len(ends) % 2 == 0 for ends in segments.values())
    wrong = findings.wrong_vertices(world, analysis, 1)
    assert len(wrong) and (standing()[0][wrong, 2] < 0.02).all()
    assert "pairs of faces intersect" in findings.summary(found, analysis)
    clean = untangled.analyse(*(lambda m: (m[0], triangles(m[1])))(level()))
    assert findings.summary([], clean) == "clean: nothing intersects"


def test_repair_in_a_thread_yields_words_and_is_judged():
    world = World.of([sheet("both", joined(level(), standing()))])
    assert "edges pierce a face" in solve.verdict(world, 0)
    steps, said = solve.repair(world, 0.001, "balanced", 100), []
    with pytest.raises(StopIteration) as end:
        while True:
            said.append(next(steps))
    world.vertices = end.value.value.vertices
    assert solve.verdict(world, 0.001) == "" and said
    assert "nearer than the gap" in solve.verdict(world, 0.05)


def test_repair_that_is_closed_ends_its_thread():
    world = World.of([sheet("both", joined(level(60), standing(60)))])
    steps = solve.repair(world, 0, "accurate", 100)
    next(steps)
    steps.close()


def test_cache_is_read_as_it_was_written_and_split(tmp_path):
    frames = np.random.default_rng(1).normal(size=(3, 7, 3)).astype(np.float32)
    writer = caches.Writer(tmp_path / "a.pc2", 7, start=5)
    for frame in frames:
        writer.add(frame)
    with pytest.raises(ValueError, match="6 points, not 7"):
        writer.add(frames[0, :6])
    writer.close()
    assert (caches.read(tmp_path / "a.pc2") == frames).all()
    caches.part(tmp_path / "a.pc2", tmp_path / "b.pc2", 2, 5)
    assert (caches.read(tmp_path / "b.pc2") == frames[:, 2:5]).all()
    (tmp_path / "c.pc2").write_bytes(b"x" * 64)
    with pytest.raises(ValueError, match="no PC2"):
        caches.read(tmp_path / "c.pc2")
