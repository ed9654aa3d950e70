"""The end of a connection: notifies the web page's controller at once and asks Bokeh to drop the session."""

from __future__ import annotations

import weakref
from collections.abc import Callable
from typing import Any

from bokeh.document import Document

from ...library_internals import Internal, internals

#: The undocumented parts of Bokeh that are used here.
INTERNALS = internals(
    __name__,
    Internal("bokeh.server.session.ServerSession", ("request_expiration",),
             "a web page that was left counts as a session and stays in memory for a minute, but nothing is computed "
             "for it"),
)

#: The method to be called when the session ends, by document.
_CLOSERS: weakref.WeakKeyDictionary[Document, weakref.WeakMethod[Callable[[], None]]] = weakref.WeakKeyDictionary()


def when_left(document: Document, close: Callable[[], None]) -> None:
    """Call a method when the session of this document ends; this does not keep the method's object alive."""
    _CLOSERS[document] = weakref.WeakMethod(close)


def end_session(session: Any) -> None:
    """End the Bokeh session of a web page that was left; no other web page can connect to it."""
    close = _CLOSERS[session.document]() if session.document in _CLOSERS else None
    if close is not None:
        close()
    expire = getattr(session, "request_expiration", None)
    if expire is not None:
        expire()
