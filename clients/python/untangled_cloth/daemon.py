"""A daemon for as long as a `with` lasts."""

from __future__ import annotations

import itertools
import os
import pathlib
import socket
import subprocess
import tempfile
import time
from typing import Optional, Union

from ._native import NoDaemon
from ._program import program as packaged

POLL_S = 0.1
_numbers = itertools.count()


class Daemon:
    """A daemon of this process's own, as a child process::

        with untangled.Daemon() as daemon, untangled.Session(triangles, domain=daemon.domain) as session:
            ...

    One that runs for all programs of a user, ``untangled-cloth serve``, needs none of this: sessions find it in the
    domain ``default``.
    """

    def __init__(
        self,
        domain: Optional[str] = None,
        *,
        config: Optional[Union[str, os.PathLike[str]]] = None,
        program: Optional[Union[str, os.PathLike[str]]] = None,
        timeout: float = 30.0,
    ) -> None:
        """Starts it, and returns when it serves.

        Args:
            domain: where sessions meet it; without one, a name of its own.
            config: file with its settings, as ``untangled-cloth config`` prints them.
            program: path of the program, instead of the one in this package.
            timeout: seconds after which it must serve.

        Raises:
            FileNotFoundError: there is no program. NoDaemon: it ended at once, or does not serve in time; what it
                said is on standard error.
        """
        self.domain = domain or f"python-{os.getpid()}-{next(_numbers)}"
        command = [os.fspath(program or packaged()), "serve", "--domain", self.domain]
        command += [] if config is None else ["--config", os.fspath(config)]
        with tempfile.TemporaryDirectory() as folder, socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as ready:
            # The daemon says that it serves as it says it to systemd.
            address = str(pathlib.Path(folder) / "ready")
            ready.bind(address)
            ready.settimeout(POLL_S)
            self.process = subprocess.Popen(command, env={**os.environ, "NOTIFY_SOCKET": address})
            try:
                self._wait(ready, time.monotonic() + timeout)
            except BaseException:
                self.stop()
                raise

    def _wait(self, ready: socket.socket, end: float) -> None:
        while time.monotonic() < end:
            try:
                if b"READY=1" in ready.recv(4096).split(b"\n"):
                    return
            except socket.timeout:
                pass
            if self.process.poll() is not None:
                raise NoDaemon(f"the daemon ended with exit code {self.process.returncode}")
        raise NoDaemon("the daemon does not serve in time")

    def stop(self) -> None:
        """Ends it, after the frames in work."""
        self.process.terminate()
        try:
            self.process.wait(10)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()

    def __enter__(self) -> "Daemon":
        return self

    def __exit__(self, *error: object) -> None:
        self.stop()
