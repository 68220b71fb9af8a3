"""The program inside of the package: `check`, `fix`, the daemon.

A wheel made by ``dist/wheel`` has it; a package that pip compiled from the sources has not.
"""

import os
import pathlib
import sys

PACKAGED = pathlib.Path(__file__).with_name("bin") / "untangled"


def program() -> str:
    """Path of the program ``untangled`` inside of this package.

    Raises:
        FileNotFoundError: this package was installed without it.
    """
    if not PACKAGED.is_file():
        raise FileNotFoundError(
            f"{PACKAGED}: this package was compiled from the sources, without the program: install the wheel, or the "
            "program by `cargo install --locked --path .`"
        )
    if not os.access(PACKAGED, os.X_OK):
        # Some installers unpack without the rights of files.
        PACKAGED.chmod(PACKAGED.stat().st_mode | 0o755)
    return str(PACKAGED)


def main() -> None:
    """The command ``untangled-cloth``: this process becomes the program."""
    try:
        found = program()
    except OSError as error:
        sys.exit(f"untangled-cloth: {error}")
    os.execv(found, ["untangled-cloth", *sys.argv[1:]])
