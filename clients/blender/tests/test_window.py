"""The sidebar and the lines of the viewport, with a window that is made up: this Blender has none."""

from types import SimpleNamespace

from conftest import joined, level, standing


class Recorder:
    """Stands for a layout: remembers what is called, by name."""

    def __init__(self, called):
        self.called = called

    def __getattr__(self, name):
        def call(*given, **named):
            self.called.append((name, given[-1] if given else named.get("text")))
            return SimpleNamespace() if name == "operator" else Recorder(self.called)

        return call


def test_sidebar_names_operators_settings_and_what_was_found(scene):
    from untangled_blender import panel

    cloth = scene.add("cloth", joined(level(), standing()))
    scene.ops.check()
    context, called = scene.bpy.context, []
    drawn = SimpleNamespace(layout=Recorder(called))
    drawn.draw_found = lambda *given: panel.Panel.draw_found(drawn, *given)
    panel.Panel.draw(drawn, context)
    names = [given for name, given in called if name == "operator"]
    assert names == [f"untangled.{name}" for name in ("check", "curves", "clear", "fix", "start", "shot")]
    assert all(scene.bpy.ops.untangled.__getattr__(name[10:]).get_rna_type() for name in names)
    settings = [given for name, given in called if name == "prop"]
    known = [*cloth.untangled.bl_rna.properties.keys(), *context.scene.untangled.bl_rna.properties.keys()]
    assert set(settings) <= set(known) and len(settings) == 5
    assert ("label", "BB: light blue") in called
    found = context.window_manager.untangled
    panel.PathList.draw_item(None, context, Recorder(called), found, found.paths[0], 0, None, "", index=0)
    assert ("operator", "untangled.jump") in called


def test_lines_are_drawn_type_by_type_in_their_colours(scene, monkeypatch):
    from untangled_blender import overlay
    from untangled_blender.plain.findings import COLOURS

    drawn, uniforms = [], {}
    shader = SimpleNamespace(bind=lambda: None, uniform_float=uniforms.__setitem__)
    state = SimpleNamespace(
        depth_test_set=lambda _: None, blend_set=lambda _: None, viewport_get=lambda: (0, 0, 640, 480)
    )
    made = SimpleNamespace(shader=SimpleNamespace(from_builtin=lambda _: shader), state=state)

    def batch(shader, kind, content):
        return SimpleNamespace(draw=lambda _: drawn.append((kind, len(content["pos"]), uniforms["color"])))

    monkeypatch.setattr(overlay, "gpu", made)
    monkeypatch.setattr(overlay, "batch_for_shader", batch)
    overlay.draw()
    assert not drawn, "nothing is shown before a check"
    scene.add("both", joined(level(), standing()))
    scene.ops.check()
    overlay.draw()
    expected = [("LINES", len(ends), (*COLOURS[kind], 1.0)) for kind, ends in overlay.shown().items()]
    assert drawn == expected and drawn and uniforms["viewportSize"] == (640, 480)
    scene.ops.clear()
    overlay.draw()
    assert len(drawn) == len(expected)
