"""Untangled Cloth, an extension for Blender: finds where cloth passes through itself, and repairs it.

Modules that need no Blender: `world` (objects as one mesh), `findings` (what to list and draw), `caches`, `child` (the
program over a shot), `solve`. The others: `properties`, `sheets` (objects as they are evaluated), `keys` (a repair as a
shape key), `overlay`, `curves`, `jobs` (progress and Esc), the operators `check`, `fix`, `start` and `shot`, `panel`.
"""


def _modules():
    from . import check, curves, fix, overlay, panel, properties, shot, start

    return properties, check, curves, fix, start, shot, overlay, panel


def register():
    for module in _modules():
        module.register()


def unregister():
    for module in reversed(_modules()):
        module.unregister()
