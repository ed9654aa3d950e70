"""Answers browsers while `granchain serve` starts: with a skeleton of the page, which reloads when the server is ready.

The server needs a few seconds for its imports. Until then, a thread that uses only the standard library answers every
request with status 503, so that a health check waits. It can be reached only from this machine.
"""

from __future__ import annotations

import contextlib
import socket
import threading
from pathlib import Path

from ..plots.theme import style_sheet

#: Longest wait for a request's head [s].
_LONGEST_WAIT = 2.0
#: Longest head that is read [bytes].
_LONGEST_HEAD = 8192
#: The addresses at which a visitor on this machine reaches the server, with their address families.
_HERE = {"127.0.0.1": socket.AF_INET, "localhost": socket.AF_INET, "::1": socket.AF_INET6}


def answer() -> bytes:
    """Return the complete response: the skeleton with the layout and themes of the page."""
    folder = Path(__file__).resolve().parent
    layout = folder.parent / "dashboard"
    files = [layout / name for name in ("dashboard.css", "skeleton.css")]
    sheets = style_sheet() + "".join(sheet.read_text(encoding="utf-8") for sheet in files)
    body = (folder / "waiting.html").read_text(encoding="utf-8").replace("/* style sheets */", sheets).encode()
    head = ("HTTP/1.1 503 Service Unavailable\r\nContent-Type: text/html; charset=utf-8\r\nCache-Control: no-store\r\n"
            "Retry-After: 1\r\nX-Content-Type-Options: nosniff\r\nConnection: close\r\n"
            f"Content-Length: {len(body)}\r\n\r\n")
    return head.encode() + body


class Waiting:
    """A listener that answers at an address of this machine until it is closed; at other addresses it does nothing."""

    def __init__(self, address: str, port: int) -> None:
        self._listening: socket.socket | None = None
        if address not in _HERE or port == 0:
            return
        listening = socket.socket(_HERE[address])
        try:
            listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            listening.bind((address, port))
            listening.listen()
        except OSError:  # the server will report what is wrong with the port
            listening.close()
            return
        self._listening, self._answer = listening, answer()
        self._thread = threading.Thread(target=self._serve, args=(listening,), daemon=True)
        self._thread.start()

    def _serve(self, listening: socket.socket) -> None:
        while True:
            try:
                connection, _ = listening.accept()
            except OSError:  # closed
                return
            threading.Thread(target=self._reply, args=(connection,), daemon=True).start()

    def _reply(self, connection: socket.socket) -> None:
        with connection, contextlib.suppress(OSError):
            connection.settimeout(_LONGEST_WAIT)
            head = b""
            while b"\r\n\r\n" not in head and len(head) < _LONGEST_HEAD and (more := connection.recv(_LONGEST_HEAD)):
                head += more
            connection.sendall(self._answer)

    def close(self) -> None:
        """Leave the port to the server."""
        if self._listening is None:
            return
        with contextlib.suppress(OSError):
            self._listening.shutdown(socket.SHUT_RDWR)  # the thread that waits in accept() returns
        self._listening.close()
        self._thread.join()
        self._listening = None
