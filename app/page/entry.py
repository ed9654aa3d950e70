"""The page: what a visitor gets, wired to a session of its own."""

from __future__ import annotations

import panel as pn

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
    session, sentences = session_from_address(pn.state.location.search if pn.state.location else "")
    COMPILER.prepare(session.scene)
    controller = Controller(document, session)
    pn.config.exception_handler = controller.failed
    if sentences:
        controller.say(" ".join(sentences))
    pn.state.on_session_destroyed(controller.close)
    return controller.views.template()


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
