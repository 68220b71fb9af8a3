"""Shots: mesh caches, baked simulations, Alembic, and start states of simulations."""

import numpy as np
import pytest
from conftest import joined, level, standing

NUM_FRAMES = 10


def shot_vertices(side=12):
    """Two sheets of which one dips into the other and comes out again, frame by frame from 1 on."""
    vertices, faces = joined(level(side), standing(side))
    frames = np.repeat(vertices[None], NUM_FRAMES, 0)
    lift = 0.06 * np.cos(np.linspace(0, 2 * np.pi, NUM_FRAMES)) + 0.01
    frames[:, side * side :, 2] += lift[:, None].astype(np.float32)
    return frames, faces


def add_cached(scene, folder, name="cloth", **settings):
    """An object that a Mesh Cache modifier moves."""
    from untangled_blender.plain import caches

    frames, faces = shot_vertices()
    writer = caches.Writer(folder / f"{name}-in.pc2", frames.shape[1], 1)
    for frame in frames:
        writer.add(frame)
    writer.close()
    obj = scene.add(name, (frames[0], faces), **settings)
    modifier = obj.modifiers.new("cache", "MESH_CACHE")
    modifier.cache_format, modifier.filepath, modifier.frame_start = "PC2", str(folder / f"{name}-in.pc2"), 1
    modifier.interpolation = "NONE"
    scene.bpy.context.scene.frame_end = NUM_FRAMES
    return obj


def counts(scene, *objects):
    """Edges that pierce a face in each frame."""
    found = []
    for frame in range(1, NUM_FRAMES + 1):
        scene.bpy.context.scene.frame_set(frame)
        found.append(scene.count(*objects))
    return found


def test_shot_of_a_mesh_cache_ends_clean_and_keeps_bits_beside_the_tangle(scene, tmp_path):
    cloth = add_cached(scene, tmp_path)
    cloth.modifiers.new("thick", "SOLIDIFY")
    cloth.scale, cloth.location, cloth.rotation_euler = (2, 2, 2), (1, 2, 3), (0.1, 0.2, 0.3)
    scene.bpy.context.scene.frame_set(3)
    assert scene.ops.shot() == {"FINISHED"}
    assert scene.bpy.context.scene.frame_current == 3
    assert [modifier.name for modifier in cloth.modifiers] == ["cache", "Untangled shot", "thick"]
    assert cloth.modifiers["thick"].show_viewport
    cloth.modifiers["thick"].show_viewport = False
    assert counts(scene, cloth) == NUM_FRAMES * [0]
    from untangled_blender.plain import caches

    out, original = caches.read(tmp_path / "untangled" / "cloth.pc2"), shot_vertices()[0]
    assert out.shape == original.shape and (out != original).any()
    shown = np.empty(3 * out.shape[1], np.float32)
    scene.bpy.context.scene.frame_set(4)
    evaluated = cloth.evaluated_get(scene.bpy.context.evaluated_depsgraph_get())
    evaluated.data.vertices.foreach_get("co", shown)
    assert (out[2] != out[3]).any()
    assert (shown.reshape(-1, 3) == out[3]).all(), "what is shown is what was certified, to the bit"
    assert not [path for path in (tmp_path / "untangled").iterdir() if path.name != "cloth.pc2"]
    cloth.modifiers["Untangled shot"].show_viewport = False
    assert max(counts(scene, cloth)) > 10
    assert scene.ops.shot(first=4, last=7) == {"FINISHED"}, "again, from the frames of before"
    assert [modifier.name for modifier in cloth.modifiers] == ["cache", "Untangled shot", "thick"]
    assert len(caches.read(tmp_path / "untangled" / "cloth.pc2")) == 4


def test_shot_with_a_moving_body_ends_outside_of_it(scene, tmp_path):
    scene.bpy.ops.mesh.primitive_uv_sphere_add(radius=0.1, segments=12, ring_count=8, location=(0.2, 0.2, -0.2))
    ball = scene.bpy.context.object
    ball.untangled.role = "BODY"
    ball.keyframe_insert("location", frame=1)
    ball.location.z = -0.04
    ball.keyframe_insert("location", frame=5)
    cloth = scene.add("cloth", level(12))
    # The same, elsewhere in the world.
    empty = scene.bpy.data.objects.new("place", None)
    scene.bpy.context.collection.objects.link(empty)
    empty.location, empty.rotation_euler = (1, 2, 3), (0.4, 0.5, 0.6)
    ball.parent = cloth.parent = empty
    ball.select_set(True)
    scene.bpy.context.scene.frame_end = NUM_FRAMES
    assert counts(scene, cloth, ball)[-1] > 0
    assert scene.ops.shot() == {"FINISHED"}
    assert counts(scene, cloth, ball) == NUM_FRAMES * [0]
    assert [modifier.name for modifier in ball.modifiers] == []


@pytest.mark.parametrize("layers", [(0, 0), (1, 2)])
def test_shot_of_two_objects_is_repaired_together_and_split(scene, tmp_path, layers):
    below = scene.add("below", level(12), layer=layers[0])
    above = add_cached(scene, tmp_path, "above", layer=layers[1])
    frames, faces = shot_vertices()
    above.data.clear_geometry()
    above.data.from_pydata(frames[0][144:].tolist(), [], (faces[len(faces) // 2 :] - 144).tolist())
    from untangled_blender.plain import caches

    caches.part(tmp_path / "above-in.pc2", tmp_path / "upper.pc2", 144, 288)
    above.modifiers["cache"].filepath = str(tmp_path / "upper.pc2")
    assert max(counts(scene, below, above)) > 10 and scene.ops.shot() == {"FINISHED"}
    assert counts(scene, below, above) == NUM_FRAMES * [0]


def test_shot_that_is_cancelled_leaves_the_scene_and_the_folder(scene, tmp_path):
    from untangled_blender.operators import shot
    from untangled_blender.plain import child

    cloth = add_cached(scene, tmp_path)
    running = []
    started = child.Shot.__init__
    operator = type("Operator", (), {
        "first": 1, "last": NUM_FRAMES, "folder": "//untangled", "report": lambda *_: None,
        "_folder": shot.ShotOperator._folder, "_repaired": shot.ShotOperator._repaired,
        "_keep": shot.ShotOperator._keep,
    })()  # fmt: skip
    steps = shot.ShotOperator.work(operator, scene.bpy.context)
    words = ""
    child.Shot.__init__ = lambda self, command: (started(self, command), running.append(self))[0]
    try:
        while "repaired" not in words:
            _, words = next(steps)
        steps.close()
    finally:
        child.Shot.__init__ = started
    assert running[0]._process.poll() is not None, "the program was ended"
    assert len(cloth.modifiers) == 1 and not list((tmp_path / "untangled").iterdir())


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda bpy, obj: setattr(obj, "scale", (1, 2, 1)), "cloth: its scale is not the same"),
        (lambda bpy, obj: setattr(obj.untangled, "role", "BODY"), "no cloth"),
    ],
)
def test_shot_that_can_not_be_repaired_is_refused_in_words(scene, tmp_path, spoil, words):
    spoil(scene.bpy, add_cached(scene, tmp_path))
    scene.bpy.context.scene.frame_end = NUM_FRAMES
    with pytest.raises(RuntimeError, match=words):
        scene.ops.shot()
    with pytest.raises(RuntimeError, match="the last frame, 3, is before the first, 7"):
        scene.ops.shot(first=7, last=3)


def test_alembic_file_is_repaired_and_exported(scene, tmp_path):
    bpy = scene.bpy
    add_cached(scene, tmp_path)
    abc = lambda name: str(tmp_path / f"{name}.abc")
    export = lambda name: bpy.ops.wm.alembic_export(
        filepath=abc(name), start=1, end=NUM_FRAMES, selected=True, as_background_job=False
    )
    assert export("in") == {"FINISHED"}

    def imported(name):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "other.blend"))
        assert bpy.ops.wm.alembic_import(filepath=abc(name), as_background_job=False) == {"FINISHED"}
        obj = next(obj for obj in bpy.data.objects if obj.type == "MESH")
        assert [modifier.type for modifier in obj.modifiers] == ["MESH_SEQUENCE_CACHE"]
        obj.select_set(True)
        bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1, NUM_FRAMES
        return obj

    cloth = imported("in")
    assert max(counts(scene, cloth)) > 10
    assert scene.ops.shot() == {"FINISHED"}
    assert export("out") == {"FINISHED"}
    assert counts(scene, imported("out")) == NUM_FRAMES * [0]


def add_simulation(scene):
    """A cloth that falls through itself: the lower sheet is pinned, the upper one leans."""
    upper = level(12)[0] + np.float32([0, 0, 0.03])
    upper[:, 2] += upper[:, 0]
    cloth = scene.add("cloth", joined(level(12), (upper, level(12)[1])))
    group = cloth.vertex_groups.new(name="held")
    group.add(list(range(144)), 1.0, "REPLACE")
    modifier = cloth.modifiers.new("sim", "CLOTH")
    modifier.settings.vertex_group_mass = "held"
    modifier.point_cache.frame_start, modifier.point_cache.frame_end = 1, NUM_FRAMES
    scene.bpy.context.scene.frame_end = NUM_FRAMES
    return cloth, modifier


def test_baked_simulation_that_fell_through_itself_is_repaired(scene, tmp_path):
    bpy = scene.bpy
    cloth, modifier = add_simulation(scene)
    with bpy.context.temp_override(scene=bpy.context.scene, active_object=cloth, point_cache=modifier.point_cache):
        bpy.ops.ptcache.bake(bake=True)
    assert modifier.point_cache.is_baked and max(counts(scene, cloth)) > 10
    assert scene.ops.shot() == {"FINISHED"}
    assert counts(scene, cloth) == NUM_FRAMES * [0]
    with pytest.raises(RuntimeError, match="cloth: its simulation is baked"):
        scene.ops.start()


def test_start_state_of_a_simulation_is_clean_with_its_gap(scene):
    bpy = scene.bpy
    cloth = scene.add("cloth", joined(level(12), standing(12)))
    modifier = cloth.modifiers.new("sim", "CLOTH")
    modifier.collision_settings.use_self_collision = True
    modifier.collision_settings.self_distance_min = 0.004
    modifier.settings.effector_weights.gravity = 0
    modifier.point_cache.frame_start, modifier.point_cache.frame_end = 3, NUM_FRAMES
    cloth.modifiers.new("fine", "SUBSURF")
    bpy.context.scene.frame_end = NUM_FRAMES
    assert scene.ops.start() == {"FINISHED"} and bpy.context.scene.frame_current == 3
    assert modifier.show_viewport and cloth.data.shape_keys.key_blocks["Untangled"].value == 1
    cloth.modifiers["fine"].show_viewport = False
    from untangled_blender.plain import solve
    from untangled_blender.sheets import sheet
    from untangled_blender.plain.world import World

    state = World.of([sheet(bpy.context, cloth)])
    assert solve.verdict(state, 0.004) == "", "what the simulation starts from keeps its distance"
    for frame in range(3, NUM_FRAMES + 1):
        bpy.context.scene.frame_set(frame)
        assert scene.count(cloth) == 0
    cloth.modifiers.remove(modifier)
    with pytest.raises(RuntimeError, match="cloth: it has no cloth simulation"):
        scene.ops.start()
