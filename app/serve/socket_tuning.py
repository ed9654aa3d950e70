"""Socket writes: without delay, and all writes of one turn of the event loop together.

Tornado and Bokeh have no public way to a page's streams. Each attribute saves some milliseconds; where a release has it
no longer, messages leave as the library sends them.
"""

from __future__ import annotations

import socket
import weakref

from bokeh.document import Document
from tornado.iostream import IOStream


def _streams(document: Document) -> list[IOStream]:
    """The streams behind this page's websockets; empty if a release keeps them elsewhere."""
    session = getattr(document.session_context, "session", None)
    connections = getattr(session, "_subscribed_connections", ())
    sockets = [getattr(getattr(connection, "_socket", None), "ws_connection", None) for connection in connections]
    streams = [getattr(one, "stream", None) for one in sockets]
    return [stream for stream in streams if isinstance(stream, IOStream) and not stream.closed()]


def disable_nagle(document: Document) -> None:
    """Turn off Nagle's algorithm, which can delay a message by 40 ms until earlier ones are acknowledged."""
    for stream in _streams(document):
        stream.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)


def gather_writes(document: Document) -> None:
    """Hand what is written in one turn of the event loop to the network together.

    A moved knob and its picture are about sixty small writes; sent singly, each costs 0.3 ms here and a wake-up in the
    browser. Where Tornado empties its buffer in another way than `_handle_write`, each goes by itself.
    """
    for stream in _streams(document):
        if hasattr(stream, "_handle_write") and "_handle_write" not in vars(stream):
            stream._handle_write = _Gathered(stream)  # type: ignore[method-assign]


class _Gathered:
    """Replaces a stream's `_handle_write`: empties the buffer when the present turn of the event loop is over."""

    def __init__(self, stream: IOStream) -> None:
        self._stream = weakref.ref(stream)
        self._loop = stream.io_loop
        self._due = False

    def __call__(self) -> None:
        """There is something to write."""
        if not self._due:
            self._due = True
            self._loop.add_callback(self._write)

    def _write(self) -> None:
        self._due = False
        stream = self._stream()
        if stream is not None and not stream.closed():
            type(stream)._handle_write(stream)
