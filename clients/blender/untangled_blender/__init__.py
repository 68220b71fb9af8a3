"""Untangled Cloth, an extension for Blender: finds where cloth passes through itself, and repairs it.

`plain` needs no Blender: objects as one mesh, what to list and draw, caches, the program over a shot. Beside it are
what a user chooses (`properties`), objects as they are evaluated (`sheets`), a repair as a shape key (`keys`), lines in
the viewport (`overlay`), and the sidebar (`panel`); `operators` has what that calls.
"""


def _modules():
    from . import overlay, panel, properties
    from .operators import check, curves, fix, shot, start

    return properties, check, curves, fix, start, shot, overlay, panel


def register():
    for module in _modules():
        module.register()


def unregister():
    for module in reversed(_modules()):
        module.unregister()
