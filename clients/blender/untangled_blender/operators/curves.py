"""The drawn paths as curve objects: for renderings, and to hand a scene on with what is wrong in it."""

import bpy

from .. import overlay
from ..plain.findings import COLOURS

COLLECTION = "Untangled paths"


class CurvesOperator(bpy.types.Operator):
    """Make the drawn paths curve objects, one for each type, that are rendered"""

    bl_idname = "untangled.curves"
    bl_label = "Paths to Curves"
    bl_options = {"REGISTER", "UNDO"}

    radius: bpy.props.FloatProperty(name="Radius", default=0.002, min=0, subtype="DISTANCE", unit="LENGTH")

    @classmethod
    def poll(cls, context):
        return bool(overlay.shown())

    def execute(self, context):
        collection = bpy.data.collections.get(COLLECTION)
        if collection is None:
            collection = bpy.data.collections.new(COLLECTION)
            context.scene.collection.children.link(collection)
        for old in list(collection.objects):
            bpy.data.curves.remove(old.data)
        for kind, ends in overlay.shown().items():
            collection.objects.link(bpy.data.objects.new(f"Paths {kind}", self.curve(kind, ends)))
        return {"FINISHED"}

    def curve(self, kind, ends):
        """Curve data with a spline for each segment."""
        curve = bpy.data.curves.new(f"Paths {kind}", "CURVE")
        curve.dimensions, curve.bevel_depth = "3D", self.radius
        for first, last in zip(ends[::2], ends[1::2]):
            spline = curve.splines.new("POLY")
            spline.points.add(1)
            spline.points[0].co, spline.points[1].co = (*first, 1), (*last, 1)
        material = bpy.data.materials.get(f"Paths {kind}") or bpy.data.materials.new(f"Paths {kind}")
        material.diffuse_color = (*COLOURS[kind], 1)
        material.use_nodes = True
        nodes = material.node_tree.nodes
        nodes.clear()
        emission, output = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeOutputMaterial")
        emission.inputs["Color"].default_value = (*COLOURS[kind], 1)
        material.node_tree.links.new(emission.outputs[0], output.inputs["Surface"])
        curve.materials.append(material)
        return curve


def register():
    bpy.utils.register_class(CurvesOperator)


def unregister():
    bpy.utils.unregister_class(CurvesOperator)
