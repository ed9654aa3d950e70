"""The page: what a visitor gets, wired to a session of its own."""

from __future__ import annotations

import panel as pn

from .controller import Controller
from .session import MODES, STARTS, Session
from .share import decode


def page() -> pn.Template:
    """A new page for a new visitor; the address may carry a shared scene."""
    pn.extension("katex")
    session, sentences = session_from_address(pn.state.location.search if pn.state.location else "")
    controller = Controller(pn.state.curdoc, session)
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
    for name, known in (("mode", MODES), ("start", STARTS)):
        value = extras.get(name)
        if value in known:
            setattr(session, name, value)
        elif value is not None:
            sentences.append(f"The link's {name} {str(value)[:40]!r} is not one of {', '.join(known)}.")
    return session, sentences
