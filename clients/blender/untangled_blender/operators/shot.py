"""Repairs a range of frames: a baked simulation, a mesh cache, an Alembic file, or whatever else moves the vertices.

Frames are sampled, the program repairs them as a child process, and a Mesh Cache modifier behind the last deforming
modifier shows the result.
"""

import pathlib
import shutil
import tempfile
import time

import bpy
import untangled_cloth as untangled

from ..plain import caches, child
from ..plain.world import Unusable
from ..sheets import is_body, num_deforming, selected, up_to
from .fix import tell
from .jobs import Job
from .sampling import Samples

MODIFIER = "Untangled shot"
PAUSE_S = 0.02
SAMPLING = 0.3
"""Share of the progress that goes to sampling."""


class ShotOperator(Job, bpy.types.Operator):
    """Repair the selected cloth in a range of frames, as a point cache and a modifier that reads it"""

    bl_idname = "untangled.shot"
    bl_label = "Repair Shot"
    bl_options = {"REGISTER", "UNDO"}

    first: bpy.props.IntProperty(name="First Frame", description="Together with the last: 0 and 0 are the scene's")
    last: bpy.props.IntProperty(name="Last Frame", description="Outside of the range the cloth stays as at its ends")
    folder: bpy.props.StringProperty(
        name="Folder", description="For the caches: NAME.pc2 of each object", default="//untangled", subtype="DIR_PATH"
    )

    @classmethod
    def poll(cls, context):
        return context.mode == "OBJECT"

    def work(self, context):
        objects = selected(context)
        first, last = (self.first, self.last) if self.first or self.last else scene_range(context.scene)
        if first > last:
            raise Unusable(f"the last frame, {last}, is before the first, {first}")
        before = context.scene.frame_current
        with tempfile.TemporaryDirectory(prefix="untangled-", dir=self._folder()) as folder:
            samples = Samples(context, objects, pathlib.Path(folder))
            ends = {obj: end(obj) for obj in objects if not is_body(obj)}
            try:
                with up_to(context, ends):
                    for frame in range(first, last + 1):
                        yield SAMPLING * (frame - first) / (last + 1 - first), f"reading frame {frame}"
                        samples.add(frame)
                    samples.finish()
            finally:
                samples.close()
                context.scene.frame_set(before)
            totals = yield from self._repaired(context, samples, last + 1 - first)
            self._keep(samples, ends, first)
        words = f"{totals['num_clean_frames']} of {totals['num_frames']} frames are clean, "
        tell(self, context, words + f"{totals['num_clean_frames_before']} were", totals["clean"])

    def _folder(self):
        if self.folder.startswith("//") and not bpy.data.filepath:
            raise Unusable("save the file first, or choose a folder for the caches")
        folder = pathlib.Path(bpy.path.abspath(self.folder))
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise Unusable(f"{folder}: {error.strerror}") from None
        return folder

    def _repaired(self, context, samples, num_frames):
        """Runs the program; yields how far it is, and returns its totals."""
        options = context.scene.untangled
        try:
            program = untangled.program()
        except FileNotFoundError as error:
            raise Unusable(str(error)) from None
        shot = child.Shot(
            child.command(
                program,
                samples.folder,
                samples.folder / "out.pc2",
                cloth=[f"cloth{k}" for k in range(len(samples.cloth))],
                bodies=[f"body{k}" for k in range(len(samples.bodies))],
                layers=samples.layers,
                pins=samples.pins,
                gap=options.gap / samples.scale,
                quality=options.quality,
            )
        )
        try:
            while not shot.done:
                done = shot.num_frames
                yield SAMPLING + (1 - SAMPLING) * done / num_frames, f"{done} of {num_frames} frames are repaired"
                time.sleep(PAUSE_S)
            return shot.totals()
        finally:
            shot.stop()

    def _keep(self, samples, ends, first):
        """Moves the caches to their places, and has modifiers read them."""
        out = samples.folder / "out.pc2"
        start = 0
        for obj in samples.cloth:
            own = samples.folder / "own.pc2"
            if len(samples.cloth) == 1:
                own = out
            else:
                caches.part(out, own, start, start + len(obj.data.vertices))
            start += len(obj.data.vertices)
            name = bpy.path.clean_name(obj.name) + ".pc2"
            shutil.move(own, self._folder() / name)
            # Keeps a path beside the file in its relative form.
            show(obj, self.folder.rstrip("/") + "/" + name, ends[obj], first)


def scene_range(scene):
    return scene.frame_start, scene.frame_end


def end(obj):
    """How many of its modifiers make what is repaired: those before an earlier repair, and before other vertices."""
    earlier = obj.modifiers.find(MODIFIER)
    return num_deforming(obj) if earlier < 0 else min(num_deforming(obj), earlier)


def show(obj, path, place, first):
    """Has a modifier at `place` read a cache whose first frame is `first`."""
    earlier = obj.modifiers.get(MODIFIER)
    if earlier is not None:
        obj.modifiers.remove(earlier)
    modifier = obj.modifiers.new(MODIFIER, "MESH_CACHE")
    modifier.cache_format, modifier.filepath = "PC2", path
    modifier.frame_start, modifier.interpolation = first, "NONE"
    obj.modifiers.move(len(obj.modifiers) - 1, place)


def register():
    bpy.utils.register_class(ShotOperator)


def unregister():
    bpy.utils.unregister_class(ShotOperator)
