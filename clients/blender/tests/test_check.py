"""Checking: lists, lines, vertex groups."""

import numpy as np
from conftest import joined, level, standing


def test_check_lists_paths_draws_them_and_marks_vertices(scene):
    below, above = scene.add("below", level()), scene.add("above", standing())
    for mode, choose in (("EDIT", True), ("OBJECT", False)):
        scene.bpy.ops.object.mode_set(mode=mode)
        assert not choose or scene.bpy.ops.mesh.select_all(action="SELECT") == {"FINISHED"}
    assert above.data.polygons[0].select
    assert scene.ops.check() == {"FINISHED"}
    found = scene.bpy.context.window_manager.untangled
    assert "pairs of faces intersect" in found.summary and found.paths[0].objects == "above, below"
    from untangled_blender import overlay

    ends = np.concatenate(list(overlay.shown().values()))
    assert len(ends) > 20 and abs(ends[:, 2]).max() < 0.03, "segments lie where the sheets meet"
    group = above.vertex_groups["Untangled inside"].index
    grouped = {v.index for v in above.data.vertices if group in [weight.group for weight in v.groups]}
    assert grouped == {v.index for v in above.data.vertices if v.select} and len(grouped) > 10
    assert not any(element.select for element in [*above.data.edges, *above.data.polygons])
    assert scene.ops.jump(index=0) == {"FINISHED"}
    assert np.allclose(scene.bpy.context.scene.cursor.location, found.paths[0].centre)

    scene.bpy.context.view_layer.objects.active = above
    above.location.z = 1
    scene.bpy.context.view_layer.update()
    scene.ops.fix()
    assert found.summary == "clean: nothing had to move" and not overlay.shown()
    scene.ops.check()
    assert found.summary == "clean: nothing intersects" and not found.paths and not overlay.shown()
    assert "Untangled inside" not in above.vertex_groups


def test_check_honours_transforms_units_and_deforming_modifiers(scene):
    unit = scene.bpy.context.scene.unit_settings
    unit.system, unit.scale_length = "METRIC", 0.1
    below, above = scene.add("below", level()), scene.add("above", standing())
    scene.ops.check(mark=False)
    found = scene.bpy.context.window_manager.untangled
    length = found.paths[0].length
    assert 0.03 < length < 0.06, "0.4 units of a tenth of a metre"
    # Half the size, twice the scale.
    for obj in (below, above):
        obj.data.transform(scene.bpy.data.objects.new("e", None).matrix_world.Scale(0.5, 4))
        obj.scale = 2, 2, 2
    scene.bpy.context.view_layer.update()
    scene.ops.check(mark=False)
    assert np.isclose(found.paths[0].length, length, rtol=1e-4)
    # A modifier lifts the upper sheet out; a subdivision behind it is not the sheet.
    lift = above.modifiers.new("lift", "DISPLACE")
    lift.direction, lift.mid_level, lift.strength = "Z", 0, 0.3
    above.modifiers.new("fine", "SUBSURF")
    scene.ops.check()
    assert found.summary == "clean: nothing intersects" and above.modifiers["fine"].show_viewport


def test_body_is_no_cloth_and_cloth_inside_of_it_is_marked(scene):
    scene.bpy.ops.mesh.primitive_uv_sphere_add(radius=0.3, segments=24, ring_count=12, location=(0.2, 0.2, -0.25))
    ball = scene.bpy.context.object
    ball.untangled.role = "BODY"
    cloth = scene.add("cloth", level())
    ball.select_set(True)
    scene.ops.check()
    assert "inside of a body" in scene.bpy.context.window_manager.untangled.summary
    inside = [v.co for v in cloth.data.vertices if v.select]
    assert inside and all(np.linalg.norm(np.subtract(v, (0.2, 0.2, -0.25))) < 0.3 for v in inside)
    assert not ball.vertex_groups


def test_what_can_not_be_checked_is_said(scene):
    import pytest

    with pytest.raises(RuntimeError, match="no mesh object is selected"):
        scene.ops.check()
    cloth = scene.add("cloth", joined(level(), standing()), pins="nothing")
    with pytest.raises(RuntimeError, match="cloth: it has no vertex group 'nothing'"):
        scene.ops.check()
    cloth.untangled.role = "BODY"
    with pytest.raises(RuntimeError, match="no cloth"):
        scene.ops.check()


def test_paths_become_curves_in_their_colours(scene):
    scene.add("both", joined(level(), standing()))
    scene.ops.check()
    assert scene.ops.curves() == {"FINISHED"}
    from untangled_blender import overlay

    curves = scene.bpy.data.collections["Untangled paths"].objects
    assert [curve.name for curve in curves] == [f"Paths {kind}" for kind in overlay.shown()]
    assert [len(curve.data.splines) for curve in curves] == [len(ends) // 2 for ends in overlay.shown().values()]
    scene.ops.curves()
    assert len(curves) == len(overlay.shown()), "a second time replaces the first"
