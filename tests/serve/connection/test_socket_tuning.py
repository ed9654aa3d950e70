"""The private attributes behind a page's sockets exist, and messages are served even if one of them is missing."""

from __future__ import annotations

import pytest
from answering_server import Served, ask, wait_for
from bokeh.client import pull_session
from bokeh.server.connection import ServerConnection
from bokeh.server.session import ServerSession
from bokeh.server.views.ws import WSHandler
from event_loop import in_a_thread
from missing_attribute import hide
from tornado.iostream import IOStream
from tornado.websocket import WebSocketProtocol

from app.serve.connection import socket_tuning

#: Every undocumented attribute on the way to a stream, with its owner.
ATTRIBUTES: list[tuple[type, str]] = [
    (ServerSession, "_subscribed_connections"), (ServerConnection, "_socket"), (WSHandler, "ws_connection"),
    (WebSocketProtocol, "stream"),
]


@in_a_thread
def test_the_attributes_of_these_releases_are_used(served: Served) -> None:
    """The test fails when a release has dropped one; the page then still works, but is some milliseconds slower."""
    session = pull_session(url=served.address)
    ask(session, "there")
    wait_for(session, "there, yes")
    (stream,) = served.found["streams"]  # by _subscribed_connections, _socket, ws_connection, stream
    assert isinstance(stream, IOStream)
    session.close()


@pytest.mark.parametrize(("owner", "name"), ATTRIBUTES, ids=lambda value: getattr(value, "__name__", value))
@in_a_thread
def test_a_message_is_served_without_a_private_name(owner: type, name: str, served: Served, monkeypatch: pytest.MonkeyPatch) -> None:
    hide(monkeypatch, socket_tuning, owner, name)
    session = pull_session(url=served.address)
    for text in ("first", "second"):
        ask(session, text)
        wait_for(session, f"{text}, yes")
    assert not served.found["streams"]
    session.close()
