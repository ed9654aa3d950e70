"""Makes a page's sockets send every message at once.

Tornado and Bokeh have no public access to a page's streams. If a release lacks one of the attributes, messages leave as
the libraries send them.
"""

from __future__ import annotations

import socket

from bokeh.document import Document
from tornado.iostream import IOStream

from ...library_internals import Internal, internals

_WITHOUT = "messages wait for the acknowledgement of earlier ones"
#: The undocumented parts of Bokeh and Tornado that are used here.
INTERNALS = internals(
    __name__,
    Internal("bokeh.server.session.ServerSession", ("_subscribed_connections",), _WITHOUT),
    Internal("bokeh.server.connection.ServerConnection", ("_socket",), _WITHOUT),
    Internal("tornado.websocket.WebSocketHandler", ("ws_connection",), _WITHOUT),
    Internal("tornado.websocket.WebSocketProtocol", ("stream",), _WITHOUT),
)


def _streams(document: Document) -> list[IOStream]:
    """Return the streams of this page's websockets; empty if a release keeps them elsewhere."""
    session = getattr(document.session_context, "session", None)
    connections = getattr(session, "_subscribed_connections", ())
    ws_connections = [getattr(getattr(connection, "_socket", None), "ws_connection", None)
                      for connection in connections]
    streams = [getattr(ws_connection, "stream", None) for ws_connection in ws_connections]
    return [stream for stream in streams if isinstance(stream, IOStream) and not stream.closed()]


def disable_nagle(document: Document) -> None:
    """Turn off Nagle's algorithm, which can delay a message by 40 ms until earlier ones are acknowledged."""
    for stream in _streams(document):
        stream.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
