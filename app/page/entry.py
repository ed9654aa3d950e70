"""The page: what a visitor gets, wired to a session of its own."""

from __future__ import annotations

from urllib.parse import urlsplit

import panel as pn
from bokeh.document import Document

from ..serve.compiler import COMPILER
from ..session.session import Session
from ..session.share import decode
from .controller import Controller


def page() -> pn.Template:
    """A new page for a new visitor; the address may carry a shared scene."""
    pn.extension("katex")
    document = pn.state.curdoc
    if document is None:
        raise RuntimeError("the page is made inside a request; serve it, do not call it")
    session, sentences = session_from_address(_query(document))
    COMPILER.prepare(session.scene)
    controller = Controller(document, session)
    pn.config.exception_handler = controller.failed
    if sentences:
        controller.say(" ".join(sentences))
    pn.state.on_session_destroyed(controller.close)
    return controller.views.template()


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
    scene, extras, sentences = decode(query)
    session.scene = scene
    session.mode = extras.get("mode", session.mode)
    session.start = extras.get("start", session.start)
    session.theme = extras.get("look", session.theme)
    return session, sentences
