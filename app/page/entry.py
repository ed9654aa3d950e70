"""The page: what a visitor gets, wired to a session of its own."""

from __future__ import annotations

import weakref
from collections.abc import Callable
from urllib.parse import urlsplit

import panel as pn
from bokeh.document import Document

from ..session.session import Session
from ..session.share import decode
from .controller import Controller
from .table import overlay_names, tab_names


def page() -> pn.Template:
    """A new page for a new visitor; the address may carry a shared scene."""
    pn.extension("katex")
    document = pn.state.curdoc
    if document is None:
        raise RuntimeError("the page is made inside a request; serve it, do not call it")
    session, sentences = session_from_address(_query(document))
    controller = Controller(document, session)
    pn.config.exception_handler = _handler(controller)
    if sentences:
        controller.say(" ".join(sentences))
    pn.state.on_session_destroyed(controller.close)
    return controller.views.template()


def _handler(controller: Controller) -> Callable[[Exception], None]:
    """Tells the controller of a failure, and does not keep it alive.

    Panel keeps the handler for as long as there is a document, and the controller has the document: no page would ever
    be forgotten.
    """
    there = weakref.WeakMethod(controller.failed)

    def failed(error: Exception) -> None:
        tell = there()
        if tell is not None:
            tell(error)

    return failed


def _query(document: Document) -> str:
    """What the address says after its question mark.

    Panel's own `Location` reads it, too, with Python's `int`: digits that `int` does not take end in an error of the
    server. So the page is served without it, and the link is read from the request.
    """
    context = document.session_context
    return urlsplit(context.request.uri or "").query if context is not None and context.request is not None else ""


def session_from_address(query: str) -> tuple[Session, list[str]]:
    """The session a link describes, and a sentence for every field that could not be used."""
    session = Session()
    if not query.strip("?"):
        return session, []
    places = {"tab": tab_names(), "page": overlay_names()}
    scene, extras, sentences = decode(query, places)
    session.scene = scene
    session.mode = extras.get("mode", session.mode)
    session.start = extras.get("start", session.start)
    session.scale = extras.get("scale", session.scale)
    session.curves = extras.get("curves", session.curves)
    session.place = {name: extras[name] for name in places if name in extras}
    session.theme = extras.get("look", session.theme)
    return session, sentences
