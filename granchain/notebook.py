"""The dashboard in a notebook: `granchain serve` runs in a separate process and is shown in a cell."""

from __future__ import annotations

import atexit
import contextlib
import html
import http.client
import os
import socket
import subprocess
import sys
import tempfile
import time
from types import TracebackType

from granchain_core import BadInput, Scene, scene

from .pictures import part_of_app

#: The process's program: the command `granchain`, independent of the PATH. It ends when this process ends.
_PROGRAM = ("import sys; from granchain_core.execution.child_processes import end_with_parent; "
            "end_with_parent(int(sys.argv.pop(1))); import granchain_start; sys.exit(granchain_start.entry())")
#: Longest wait for the server's first answer [s]: the first start on a machine compiles kernels.
_START_TIMEOUT = 120.0
#: Time between two checks for an answer of the server [s].
_POLL_INTERVAL = 0.05
#: Origins whose pages may show the dashboard in a frame: notebooks on this machine, at any port.
_EMBEDDING = ("http://localhost:*", "http://127.0.0.1:*")


class Dashboard:
    """A running dashboard, which a notebook shows if it is the last value of a cell.

    Attributes
    ----------
    url : str
        Address of the dashboard, including the scene.
    height : int
        Height of the frame in a cell [px].

    Examples
    --------
    >>> from granchain import Dashboard
    >>> Dashboard("http://localhost:5006/?scene=sec2", 600, None)._repr_html_().count("iframe")
    2
    """

    def __init__(self, url: str, height: int, process: subprocess.Popen[bytes] | None) -> None:
        self.url, self.height, self._process = url, height, process
        atexit.register(self.stop)

    def stop(self) -> None:
        """Stop the server, which otherwise stops when the notebook's kernel ends."""
        atexit.unregister(self.stop)
        if self._process is not None and self._process.poll() is None:
            self._process.terminate()
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._process.wait(timeout=5)
            self._process.kill()

    def __enter__(self) -> Dashboard:
        return self

    def __exit__(self, kind: type[BaseException] | None, problem: BaseException | None,
                 where: TracebackType | None) -> None:
        self.stop()

    def _repr_html_(self) -> str:
        return (f'<iframe src="{html.escape(self.url)}" title="granchain" width="100%" height="{self.height}" '
                'style="border:0"></iframe>')

    def __repr__(self) -> str:
        return f"The dashboard is at {self.url}; stop() ends it."


def dashboard(shown: Scene | str = "sec2", height: int = 800, port: int = 0) -> Dashboard:
    """Start the dashboard with a scene, for a notebook's cell or for a browser at its address.

    The server runs in a process of its own, so that it answers while the notebook computes. It can be reached only from
    this machine. If the notebook's browser is on another machine, forward the port to it under the same number:
    `ssh -L 5006:localhost:5006 …` and `dashboard(port=5006)`.

    Parameters
    ----------
    shown : Scene or str
        A scene or the name of a preset. Of a scene, the dashboard uses its preset and the knobs that differ from it.
    height : int
        Height of the frame in a cell [px].
    port : int
        Port at which the server listens; 0 chooses a free one.

    Returns
    -------
    Dashboard
        The running dashboard, with `url` and `stop()`; it ends when this process ends.

    Raises
    ------
    BadInput
        The scene is unknown, or the server did not start; the message contains the server's last line of output.

    Examples
    --------
    >>> from granchain import dashboard, scene
    >>> with dashboard(scene("sec2").evolve(f=1130.0)) as board:              # doctest: +SKIP
    ...     print(board.url)
    http://localhost:41563/?v=1&scene=sec2&f=1130.0
    """
    chain = scene(shown) if isinstance(shown, str) else shown
    port = port or _free_port()
    words = ["serve", "--port", str(port)]
    for origin in _EMBEDDING:
        words += ["--allow-embedding", origin]
    query = part_of_app("session.share").encode(chain, {})
    with tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace") as said:
        process = subprocess.Popen([sys.executable, "-c", _PROGRAM, str(os.getpid()), *words],
                                   stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=said)
        board = Dashboard(f"http://localhost:{port}/?{query}", height, process)
        if not _answers(process, port):
            board.stop()
            said.seek(0)
            last = said.read().strip().splitlines()[-1:] or ["it did not answer"]
            raise BadInput(f"The dashboard did not start: {last[0]}")
    return board


def _free_port() -> int:
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        port: int = one.getsockname()[1]
        return port


def _answers(process: subprocess.Popen[bytes], port: int) -> bool:
    """Wait until the server answers; return False if it ends first or does not answer in time."""
    end = time.monotonic() + _START_TIMEOUT
    while process.poll() is None and time.monotonic() < end:
        connection = http.client.HTTPConnection("127.0.0.1", port, timeout=1.0)
        try:
            connection.request("GET", "/liveness")
            if connection.getresponse().status == 200:
                return True
        except (OSError, http.client.HTTPException):
            pass
        finally:
            connection.close()
        time.sleep(_POLL_INTERVAL)
    return False
