"""The document lock: whether a document may be changed now, and calls that wait for that moment."""

from __future__ import annotations

from collections.abc import Callable

import panel as pn
from bokeh.document import Document

from ...library_internals import Internal, internals

#: The undocumented parts of Bokeh that are used here.
INTERNALS = internals(
    __name__,
    Internal("bokeh.server.session.ServerSession", ("_pending_writes",),
             "every message waits for the next iteration of the event loop"),
)


def may_change(document: Document) -> bool:
    """Return whether Bokeh is known to hold the document's lock, without which the document must not be changed.

    True for a document without a session, as in tests and while a document is being filled.

    While Bokeh holds the lock, it keeps a list of pending writes. A message can arrive while answers to an earlier
    message are still being written; Bokeh then refuses every change. If a release keeps the list elsewhere, a change
    waits for the next iteration of the event loop.
    """
    session = getattr(document.session_context, "session", None)
    return session is None or getattr(session, "_pending_writes", None) is not None


def run_when_locked(document: Document, action: Callable[[], None]) -> None:
    """Run `action` as soon as the document may be changed and changes reach the browser.

    The browser can send requests before it has reported that all parts are rendered. Until then, Panel drops changes.
    """
    if not pn.state.loaded:
        pn.state.onload(action)
    elif may_change(document):
        action()
    else:
        document.add_next_tick_callback(action)
