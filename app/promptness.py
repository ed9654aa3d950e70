"""Small messages without delay: the browser's websocket with Nagle's algorithm switched off."""

from __future__ import annotations

from bokeh.document import Document


def send_at_once(document: Document) -> None:
    """Send every websocket message of this page when it is written.

    A picture is a score of small messages, and the system otherwise holds some of them back until the browser's
    system has acknowledged earlier ones, which it may do 40 ms late. Neither Bokeh nor Panel has a switch for
    it, hence the way through the session's connections.
    """
    session = getattr(document.session_context, "session", None)
    for connection in getattr(session, "_subscribed_connections", ()):
        connection._socket.set_nodelay(True)
