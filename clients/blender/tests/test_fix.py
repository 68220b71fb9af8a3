"""Repairs of one state as shape keys."""

import numpy as np
import pytest
from conftest import curled, joined, level, standing


def deltas(obj):
    """Displacements of the repair's key, and the basis."""
    keys = obj.data.shape_keys.key_blocks
    read = lambda key: np.array([point.co for point in key.data])
    return read(keys["Untangled"]) - read(keys["Basis"]), read(keys["Basis"])


def test_fix_of_two_objects_ends_clean_as_keys_that_can_be_blended(scene):
    below = scene.add("below", level())
    above = scene.add("above", (standing()[0] - [0, 0.1, 0], standing()[1]))
    above.location.y = 0.1
    scene.bpy.context.view_layer.update()
    before = scene.count(below, above)
    assert before > 20 and scene.ops.fix() == {"FINISHED"}
    assert scene.count(below, above) == 0
    for obj in (below, above):
        if obj.data.shape_keys:
            obj.data.shape_keys.key_blocks["Untangled"].value = 0
    scene.bpy.context.view_layer.update()
    assert scene.count(below, above) == before
    assert scene.ops.fix() == {"FINISHED"}, "beside a key that is switched off"
    assert scene.count(below, above) == 0


def test_fix_of_a_clean_object_adds_no_key(scene):
    cloth = scene.add("cloth", level())
    assert scene.ops.fix() == {"FINISHED"} and cloth.data.shape_keys is None


def test_pins_stay_and_the_gap_is_kept_in_scene_units(scene):
    from untangled_blender.sheets import sheet

    unit = scene.bpy.context.scene.unit_settings
    unit.system, unit.scale_length = "METRIC", 0.01
    scale = lambda mesh: (100 * mesh[0], mesh[1])
    below, above = scene.add("below", scale(level()), pins="pins"), scene.add("above", scale(standing()))
    below.vertex_groups.new(name="pins").add(list(range(400)), 1.0, "REPLACE")
    scene.bpy.context.scene.untangled.gap = 0.2
    assert scene.ops.fix() == {"FINISHED"}
    assert below.data.shape_keys is None and scene.count(below, above) == 0
    below_at, above_at = (sheet(scene.bpy.context, obj).in_world() for obj in (below, above))
    distances = np.linalg.norm(below_at[:, None] - above_at[None], axis=2)
    assert distances.min() >= 0.2 * (1 - 1e-6), "two millimetres"


def test_body_stays_and_cloth_ends_outside(scene):
    scene.bpy.ops.mesh.primitive_uv_sphere_add(radius=0.3, segments=24, ring_count=12, location=(0.2, 0.2, -0.25))
    ball = scene.bpy.context.object
    ball.untangled.role = "BODY"
    cloth = scene.add("cloth", level())
    ball.select_set(True)
    assert scene.ops.fix() == {"FINISHED"} and ball.data.shape_keys is None
    assert scene.count(cloth, ball) == 0
    scene.ops.check()
    assert scene.bpy.context.window_manager.untangled.summary == "clean: nothing intersects"


def test_layers_end_in_their_order(scene):
    inner = scene.add("inner", level(), layer=1)
    outer = scene.add("outer", (level()[0] - np.float32([0, 0, 0.01]), level()[1]), layer=2)
    assert scene.ops.fix() == {"FINISHED"}
    heights = [np.array([v.co.z for v in obj.evaluated_get(scene.bpy.context.evaluated_depsgraph_get()).data.vertices])
               for obj in (inner, outer)]  # fmt: skip
    middle = slice(150, 250)
    assert (heights[1][middle] > heights[0][middle] - 1e-6).all()


def test_fix_behind_an_armature_and_a_subdivision_is_clean_where_it_is_posed(scene):
    bpy = scene.bpy
    bpy.ops.object.armature_add()
    rig = bpy.context.object
    rig.pose.bones[0].rotation_mode = "XYZ"
    cloth = scene.add("cloth", curled())
    modifier = cloth.modifiers.new("rig", "ARMATURE")
    modifier.object = rig
    cloth.vertex_groups.new(name="Bone").add(list(range(900)), 1.0, "REPLACE")
    cloth.modifiers.new("fine", "SUBSURF")
    rig.pose.bones[0].rotation_euler = (0.3, 0.8, 1.1)
    rig.select_set(False)
    bpy.context.view_layer.update()
    assert scene.ops.fix() == {"FINISHED"}
    cloth.modifiers["fine"].show_viewport = False
    bpy.context.view_layer.update()
    assert scene.count(cloth) == 0
    moved, basis = deltas(cloth)
    assert (basis == curled()[0]).all(), "the basis is the mesh"
    assert 10 < moved.any(1).sum() < 600, "what need not move stays, to the bit"


def test_key_behind_an_armature_moves_what_is_shown_by_the_displacement(scene):
    from untangled_blender import keys
    from untangled_blender.sheets import sheet

    bpy = scene.bpy
    bpy.ops.object.armature_add()
    rig = bpy.context.object
    cloth = scene.add("cloth", curled())
    cloth.modifiers.new("rig", "ARMATURE").object = rig
    cloth.vertex_groups.new(name="Bone").add(list(range(900)), 1.0, "REPLACE")
    rig.pose.bones[0].rotation_mode, rig.pose.bones[0].rotation_euler = "XYZ", (0.3, 0.8, 1.1)
    bpy.context.view_layer.update()
    before = sheet(bpy.context, cloth).vertices
    moves = np.zeros((900, 3))
    moves[7] = 0.01, 0.02, -0.03
    keys.move(bpy.context, cloth, keys.add(cloth), moves)
    assert np.allclose(sheet(bpy.context, cloth).vertices - before, moves, atol=1e-6)


def test_undo_takes_a_repair_back(scene):
    bpy = scene.bpy
    cloth = scene.add("cloth", joined(level(), standing()))
    bpy.context.preferences.edit.use_global_undo = True
    bpy.ops.ed.undo_push(message="before")
    assert scene.ops.fix() == {"FINISHED"}
    bpy.ops.ed.undo_push(message="Fix Cloth")
    assert bpy.data.objects["cloth"].data.shape_keys
    bpy.ops.ed.undo()
    assert bpy.data.objects["cloth"].data.shape_keys is None


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda bpy, obj: bpy.data.objects.new("twin", obj.data), "share its mesh"),
        (lambda bpy, obj: obj.modifiers.new("sim", "CLOTH"), "a cloth simulation moves its vertices"),
        (lambda bpy, obj: setattr(obj, "show_only_shape_key", True), "shown alone"),
    ],
)
def test_object_that_a_key_would_not_repair_is_refused_and_unchanged(scene, spoil, words):
    cloth = scene.add("cloth", joined(level(), standing()))
    spoil(scene.bpy, cloth)
    with pytest.raises(RuntimeError, match=f"cloth: .*{words}"):
        scene.ops.fix()
    assert cloth.data.shape_keys is None


def test_cancelled_repair_leaves_no_key_and_shows_all_modifiers(scene, monkeypatch):
    from untangled_blender.operators import fix

    # As if what Blender made of the key were not clean.
    monkeypatch.setattr(fix, "verdict", lambda *_: "something is left")

    cloth = scene.add("cloth", joined(level(), standing()))
    fine = cloth.modifiers.new("fine", "SUBSURF")
    steps = fix.fixed(scene.bpy.context, [cloth], {cloth: 0}, 0.0)
    while not cloth.data.shape_keys:
        next(steps)
    assert not fine.show_viewport
    steps.close()
    assert "Untangled" not in cloth.data.shape_keys.key_blocks and fine.show_viewport
