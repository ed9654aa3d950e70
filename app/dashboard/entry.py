"""The entry point of a session: makes the document and its session."""

from __future__ import annotations

import weakref
from collections.abc import Callable
from urllib.parse import urlsplit

import panel as pn
from bokeh.core.properties import validate
from bokeh.document import Document

from ..serve.connection.leaving import when_left
from ..serve.monitoring.faults import session_label
from ..serve.monitoring.metrics import METRICS
from ..session.session import Session
from .addresses import apply_address
from .controller import Controller


def open_web_page() -> None:
    """Fill the document of the present request with a web page; the address may be a share link."""
    pn.extension("katex", browser_info=False)  # otherwise Panel would add a root for it with every part
    document = pn.state.curdoc
    if document is None:
        raise RuntimeError("the web page can only be made inside a request; serve it instead of calling it")
    context = document.session_context
    session = Session(label="" if context is None else session_label(context.id))
    query = _query(document)
    initial_state, sentences = apply_address(session, query) if query.strip("?") else (None, [])
    with validate(False):  # validation takes a sixth of the time to open a web page, and the tests find such errors
        controller = Controller(document, session, initial_state)
        controller.views.put_into(document)
    pn.config.exception_handler = _handler(controller)
    if sentences:
        controller.show_sentence(" ".join(sentences))
    when_left(document, controller.close)
    pn.state.on_session_destroyed(controller.session_dropped)
    METRICS.session_opened()  # counted after `when_left`, so that its end is counted too
    controller.on_close(METRICS.session_closed)


def _handler(controller: Controller) -> Callable[[Exception], None]:
    """Return a handler that reports a failure to the controller without keeping the controller alive.

    Panel keeps the handler as long as the document lives, and the controller refers to the document. With a strong
    reference, no document would ever be freed.
    """
    show_failure = weakref.WeakMethod(controller.show_failure)

    def failed(error: Exception) -> None:
        show = show_failure()
        if show is not None:
            show(error)

    return failed


def _query(document: Document) -> str:
    """Return the query of the address, read from the request.

    Panel's `Location` would read numbers in the query with Python's `int`, and digits that `int` refuses would cause a
    server error, so the page is served without `Location`.
    """
    context = document.session_context
    return urlsplit(context.request.uri or "").query if context is not None and context.request is not None else ""
