"""A dashboard in a thread of the test process, queried over its port."""

from __future__ import annotations

import asyncio
import http.client
import re
import socket
import threading

from bokeh.document import Document
from bokeh.io.doc import _PATCHED_CURDOCS, set_curdoc
from tornado.ioloop import IOLoop

from app.server import Access, server_at

SECRET = b"a secret of tests alone, long enough"


class Listening:
    """A dashboard in a thread, reached at an address of this machine."""

    def __init__(self, access: Access, address: str = "127.0.0.1") -> None:
        self.address = address
        started = threading.Event()
        self._thread = threading.Thread(target=self._run, args=(access, started), daemon=True)
        self._thread.start()
        assert started.wait(60)

    def _run(self, access: Access, started: threading.Event) -> None:
        asyncio.set_event_loop(asyncio.new_event_loop())
        self.loop = IOLoop.current()
        one = self.server = server_at(0, self.address, access)
        self.port = one.port
        one.start()
        self.loop.add_callback(started.set)
        self.loop.start()
        one.stop()

    def stop(self) -> None:
        """Stop the server."""
        self.loop.add_callback(self.loop.stop)
        self._thread.join(20)
        # Bokeh leaves a page's document behind as the process's current one, where every later test would find it.
        _PATCHED_CURDOCS.clear()
        set_curdoc(Document())

    def ask(self, path: str = "/", **headers: str) -> tuple[int, dict[str, str], str]:
        """Return status, headers and text of an answer."""
        connection = http.client.HTTPConnection(self.address, self.port, timeout=60)
        connection.request("GET", path, headers={name.replace("_", "-"): value for name, value in headers.items()})
        answer = connection.getresponse()
        found = answer.status, dict(answer.getheaders()), answer.read().decode(errors="replace")
        connection.close()
        return found

    def token(self) -> str:
        """Return the token of a new page."""
        found = re.search(r'"token":"([^"]+)"', self.ask()[2])
        assert found is not None
        return found.group(1)

    def connect(self, token: str, **headers: str) -> int:
        """Return the status that a websocket with this token gets: 101 if it is admitted."""
        return self.open(token, **headers)[0]

    def open(self, token: str, **headers: str) -> tuple[int, socket.socket]:
        """Return the same status, and the socket."""
        one = socket.create_connection((self.address, self.port), timeout=60)
        words = {"Host": f"127.0.0.1:{self.port}", "Upgrade": "websocket", "Connection": "Upgrade",
                 "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==", "Sec-WebSocket-Version": "13",
                 "Sec-WebSocket-Protocol": f"bokeh, {token}", "Origin": f"http://127.0.0.1:{self.port}", **headers}
        one.sendall(("GET /ws HTTP/1.1\r\n" + "".join(f"{a}: {b}\r\n" for a, b in words.items()) + "\r\n").encode())
        answer = b""
        while not answer.endswith(b"\r\n\r\n") and (byte := one.recv(1)):  # everything after the head is for the caller
            answer += byte
        return int(answer.split()[1]), one
