"""What happens when a session ends: the page is notified at once, and Bokeh is asked to drop its own session."""

from __future__ import annotations

import weakref
from collections.abc import Callable
from typing import Any

from bokeh.document import Document

from ...library_internals import Internal, internals

#: What is used of Bokeh beyond its documentation.
INTERNALS = internals(
    __name__,
    Internal("bokeh.server.session.ServerSession", ("request_expiration",),
             "a page that was left counts as a session and stays in memory for a minute, but nothing is computed "
             "for it"),
)

#: What a page does when its session ends.
_PAGES: weakref.WeakKeyDictionary[Document, weakref.WeakMethod[Callable[[], None]]] = weakref.WeakKeyDictionary()


def when_left(document: Document, close: Callable[[], None]) -> None:
    """Let a method, which is not kept alive, be called when the session of this document ends."""
    _PAGES[document] = weakref.WeakMethod(close)


def leave(session: Any) -> None:
    """End a session of Bokeh's, whose page has left; no other page can connect to it."""
    close = _PAGES[session.document]() if session.document in _PAGES else None
    if close is not None:
        close()
    expire = getattr(session, "request_expiration", None)
    if expire is not None:
        expire()
