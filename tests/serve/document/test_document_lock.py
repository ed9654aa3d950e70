"""A message is answered whether or not the document is locked, and whether or not its lock can be inspected."""

from __future__ import annotations

import pytest
from answering_server import Served, ask, wait_for
from bokeh.client import pull_session
from bokeh.server.session import ServerSession
from event_loop import in_a_thread
from missing_attribute import hide

from app.serve.document import document_lock
from app.serve.document.document_lock import run_when_locked


@in_a_thread
def test_a_lock_of_this_release_is_known(served: Served) -> None:
    """The test fails if a release has no `_pending_writes`; messages then wait for the event loop's next iteration."""
    session = pull_session(url=served.address)
    ask(session, "there")
    wait_for(session, "there, yes")
    assert served.found["locked"], "ServerSession._pending_writes"
    session.close()


@in_a_thread
def test_messages_are_answered_where_a_lock_is_not_known(served: Served, monkeypatch: pytest.MonkeyPatch) -> None:
    missed = hide(monkeypatch, document_lock, ServerSession, "_pending_writes")
    session = pull_session(url=served.address)
    for text in ("first", "second"):
        ask(session, text)
        wait_for(session, f"{text}, yes")
        assert missed and not served.found["locked"]
    session.close()


@pytest.mark.parametrize("hidden", [False, True])
@in_a_thread
def test_a_message_that_comes_while_the_document_is_not_locked_is_answered(hidden: bool, served: Served,
                                                            monkeypatch: pytest.MonkeyPatch) -> None:
    """Bokeh refuses a change in that case. Without the attribute, it is unknown whether the document is locked."""
    if hidden:
        hide(monkeypatch, document_lock, ServerSession, "_pending_writes")
    session = pull_session(url=served.address)
    document = served.document
    assert document is not None
    served.loop.add_callback(lambda: run_when_locked(document, lambda: served.reply("later")))
    wait_for(session, "later, yes")
    session.close()
