"""The extension as `dist/extension` makes it, installed by Blender's own means into a folder of its own."""

import os
import pathlib
import subprocess
import sys
from importlib.util import find_spec

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[3]
ZIPS = sorted((ROOT / "target/extension").glob("*.zip"))
SCRIPT = """
import os, sys
import bpy
import addon_utils

# A package of this environment must not hide the one in the extension.
wheels = f"lib/python{sys.version_info.major}.{sys.version_info.minor}/site-packages"
sys.path.insert(0, os.environ["BLENDER_USER_RESOURCES"] + "/extensions/.local/" + wheels)
os.makedirs(sys.path[0])
bpy.ops.wm.read_factory_settings(use_empty=True)
addon_utils.enable("bl_pkg")
installed = bpy.ops.extensions.package_install_files(
    filepath=sys.argv[1], repo="user_default", enable_on_install=True
)
assert installed == {"FINISHED"}, installed
import untangled_cloth

assert untangled_cloth.__file__.startswith(os.environ["BLENDER_USER_RESOURCES"]), untangled_cloth.__file__
# An installed wheel has no rights of files: the program gets its own here.
print(os.popen(untangled_cloth.program() + " --version").read(), bpy.ops.untangled.fix.get_rna_type().name)
bpy.ops.preferences.addon_disable(module="bl_ext.user_default.untangled_cloth")
assert not hasattr(bpy.types, "UNTANGLED_PT_panel")
sys.stdout.flush()
os._exit(0)
"""


@pytest.fixture
def extension():
    if not ZIPS:
        pytest.skip("there is no extension: make it with dist/wheel and dist/extension")
    if find_spec("bpy") is None:
        pytest.skip("there is no bpy here: pip install 'bpy==4.5.*', on Python 3.11")
    return ZIPS[-1]


def test_extension_is_valid_by_blenders_own_check(extension):
    folder = pathlib.Path(find_spec("bpy").origin).parent
    checker = next(folder.glob("*/scripts/addons_core/bl_pkg/cli/blender_ext.py"))
    done = subprocess.run([sys.executable, str(checker), "validate", str(extension)], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_extension_installs_with_its_wheel_and_program_and_goes_again(extension, tmp_path):
    command = [sys.executable, "-c", SCRIPT, str(extension)]
    environment = {**os.environ, "BLENDER_USER_RESOURCES": str(tmp_path)}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "untangled " + extension.stem.split("-")[1] in done.stdout and "Fix Cloth" in done.stdout
