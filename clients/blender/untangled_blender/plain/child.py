"""`untangled fix --cache` as a child process, watched and not waited for. Nothing here needs Blender."""

from __future__ import annotations

import json
import pathlib
import subprocess
import tempfile
import threading
from typing import List, Optional

from .world import Unusable


class Shot:
    """A run of the program over all frames of a cache; `poll` it until `done`, then `result` says how it ended."""

    def __init__(self, command: List[str]) -> None:
        self.lines: List[dict] = []
        self._said = tempfile.TemporaryFile("w+")
        self._process = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=self._said, text=True
        )
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self) -> None:
        for line in self._process.stdout:
            self.lines.append(json.loads(line))

    @property
    def done(self) -> bool:
        """Whether it has ended, and all that it said is read."""
        return not self._reader.is_alive() and self._process.poll() is not None

    @property
    def num_frames(self) -> int:
        """Frames that are finished."""
        return sum("frame" in line for line in self.lines)

    def stop(self) -> None:
        """Ends it, if it has not ended; its output stays unfinished."""
        if self._process.poll() is None:
            self._process.terminate()
            self._process.wait()
        self._reader.join()
        self._process.stdout.close()
        self._said.close()

    def totals(self) -> dict:
        """What it says of the whole, once it is `done`.

        Raises:
            Unusable: it refused the input, in its own words.
        """
        totals: Optional[dict] = next((line["totals"] for line in self.lines if "totals" in line), None)
        if self._process.returncode in (0, 1) and totals:
            return totals
        self._said.seek(0)
        words = [line for line in self._said.read().splitlines() if line.strip()]
        raise Unusable(words[-1] if words else f"the program ended with exit code {self._process.returncode}")


def command(
    program: str,
    folder: pathlib.Path,
    out: pathlib.Path,
    *,
    cloth: List[str],
    bodies: List[str],
    layers: bool,
    pins: bool,
    gap: float,
    quality: str,
) -> List[str]:
    """The command line over files in `folder`: `NAME.obj` of each sheet, `cloth.pc2`, `NAME.pc2` of each body."""
    arguments = [program, "fix", *(str(folder / f"{name}.obj") for name in cloth)]
    arguments += ["--cache", str(folder / "cloth.pc2"), "-o", str(out), "--overwrite", "--json", "--quality", quality]
    # Vertices of an object are what its user made them: none are welded.
    arguments += ["--weld", "off"]
    for name in bodies:
        arguments += ["--body", str(folder / f"{name}.obj"), "--body-cache", str(folder / f"{name}.pc2")]
    if layers:
        arguments.append("--layers")
    if pins:
        arguments += ["--pin", str(folder / "pins.txt")]
    if gap > 0:
        arguments += ["--gap", repr(gap)]
    return arguments
