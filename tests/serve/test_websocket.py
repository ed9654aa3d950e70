"""The private attributes of Tornado, Bokeh and Panel: they are there, and a message is served without each of them."""

from __future__ import annotations

import asyncio
import importlib.util
import sys
import threading
from collections.abc import Iterator
from typing import Any

import panel as pn
import pytest
from bokeh.application import Application
from bokeh.application.handlers import FunctionHandler
from bokeh.client import ClientSession, pull_session
from bokeh.document import Document
from bokeh.events import Event
from bokeh.models import Div
from bokeh.server.connection import ServerConnection
from bokeh.server.server import Server
from bokeh.server.session import ServerSession
from bokeh.server.views.ws import WSHandler
from panel.custom import JSComponent
from tornado.ioloop import IOLoop
from tornado.iostream import IOStream
from tornado.websocket import WebSocketProtocol

from app.parts.component import Component
from app.serve import websocket
from app.serve.websocket import disable_nagle, gather_writes, has_document_lock, with_document_lock

#: Every private attribute that is used of a connection, and whose it is.
PRIVATE: list[tuple[type, str]] = [
    (ServerSession, "_subscribed_connections"), (ServerSession, "_pending_writes"), (ServerConnection, "_socket"),
    (WSHandler, "ws_connection"), (WebSocketProtocol, "stream"), (IOStream, "_handle_write"),
]


def hide(monkeypatch: pytest.MonkeyPatch, owner: type, name: str) -> None:
    """Take an attribute away from `app.serve.websocket` alone: the library still needs its own."""

    def found(self: object, attribute: str) -> Any:
        if attribute == name and sys._getframe(1).f_globals.get("__name__") == websocket.__name__:
            raise AttributeError(name)
        return object.__getattribute__(self, attribute)

    monkeypatch.setattr(owner, "__getattribute__", found)


class Served:
    """A Bokeh server whose document answers a question, with the document locked and in one batch."""

    def __init__(self) -> None:
        self.document: Document | None = None
        self.found: dict[str, Any] = {}
        started = threading.Event()
        self._thread = threading.Thread(target=self._run, args=(started,), daemon=True)
        self._thread.start()
        assert started.wait(20)

    def _run(self, started: threading.Event) -> None:
        asyncio.set_event_loop(asyncio.new_event_loop())
        self.loop = IOLoop.current()
        server = Server({"/": Application(FunctionHandler(self._build))}, port=0, io_loop=self.loop)
        server.start()
        self.address = f"http://localhost:{server.port}/"
        self.loop.add_callback(started.set)
        self.loop.start()
        server.stop()

    def _build(self, document: Document) -> None:
        self.document = document
        question, self.answer = Div(name="question"), Div(name="answer")
        question.on_change("text", lambda _attribute, _old, new: with_document_lock(document, lambda: self.reply(new)))
        document.add_root(question)
        document.add_root(self.answer)

    def reply(self, text: str) -> None:
        """The answer, sent as a picture is."""
        assert self.document is not None
        self.found = {"locked": has_document_lock(self.document), "streams": websocket._streams(self.document)}
        disable_nagle(self.document)
        gather_writes(self.document)
        self.answer.text = f"{text}, yes"

    def stop(self) -> None:
        """End the server."""
        self.loop.add_callback(self.loop.stop)
        self._thread.join(20)


@pytest.fixture
def served(monkeypatch: pytest.MonkeyPatch) -> Iterator[Served]:
    """A server of this test's own whose page counts as drawn."""
    monkeypatch.setattr(type(pn.state), "loaded", property(lambda _: True))
    one = Served()
    yield one
    one.stop()


def ask(session: ClientSession, text: str) -> None:
    """Send a question as the browser does."""
    session.document.select_one({"name": "question"}).text = text


def wait_for(session: ClientSession, text: str) -> None:
    """Until the answer has come as a change of the document, as the browser gets it."""
    loop = session._connection.io_loop
    patience = loop.call_later(10, loop.stop)
    session._connection._loop_until(lambda: session.document.select_one({"name": "answer"}).text == text)
    loop.remove_timeout(patience)
    assert session.document.select_one({"name": "answer"}).text == text


def test_the_private_attributes_of_these_releases_are_used(served: Served) -> None:
    """Fails, with its name, when a release has dropped one: the page still works, some milliseconds slower."""
    session = pull_session(url=served.address)
    ask(session, "there")
    wait_for(session, "there, yes")
    assert served.found["locked"], "ServerSession._pending_writes"
    (stream,) = served.found["streams"]  # by _subscribed_connections, _socket, ws_connection, stream
    assert hasattr(stream, "_handle_write"), "IOStream._handle_write"
    assert hasattr(JSComponent, "_process_bokeh_event"), "JSComponent._process_bokeh_event"
    assert hasattr(JSComponent, "_process_event"), "JSComponent._process_event"
    session.close()


@pytest.mark.parametrize(("owner", "name"), PRIVATE, ids=lambda value: getattr(value, "__name__", value))
def test_a_message_is_served_without_it(owner: type, name: str, served: Served, monkeypatch: pytest.MonkeyPatch) -> None:
    hide(monkeypatch, owner, name)
    session = pull_session(url=served.address)
    for text in ("first", "second"):
        ask(session, text)
        wait_for(session, f"{text}, yes")
    assert not (served.found["streams"] if name not in ("_handle_write", "_pending_writes") else [])
    session.close()


@pytest.mark.parametrize("hidden", [False, True])
def test_a_message_that_comes_while_the_document_is_not_locked_is_answered(hidden: bool, served: Served,
                                                            monkeypatch: pytest.MonkeyPatch) -> None:
    """Bokeh refuses a change there; whether it is locked is unknown where the attribute is gone."""
    if hidden:
        hide(monkeypatch, ServerSession, "_pending_writes")
    session = pull_session(url=served.address)
    document = served.document
    assert document is not None
    served.loop.add_callback(lambda: with_document_lock(document, lambda: served.reply("later")))
    wait_for(session, "later, yes")
    session.close()


class Part(Component):
    """A part of the page that does nothing."""

    _esm = "export function render() {}"


def test_an_event_of_a_part_is_handled_with_and_without_panels_private_method(monkeypatch: pytest.MonkeyPatch) -> None:
    handled: list[tuple[str, Event]] = []
    document, event = Document(), Event()
    monkeypatch.setattr(JSComponent, "_process_event", lambda _, one: handled.append(("directly", one)))
    Part()._process_bokeh_event(document, event)
    monkeypatch.setattr(JSComponent, "_process_bokeh_event", lambda _, __, one: handled.append(("by Panel", one)))
    hide(monkeypatch, Part, "_process_event")
    Part()._process_bokeh_event(document, event)
    assert handled == [("directly", event), ("by Panel", event)]


def test_an_event_of_a_part_is_handled_by_panel_where_that_has_no_set_curdoc(monkeypatch: pytest.MonkeyPatch) -> None:
    """The module is imported without it, and leaves the event to Panel."""
    monkeypatch.delattr(sys.modules["panel.io.state"], "set_curdoc")
    spec = importlib.util.spec_from_file_location("app.serve.without_set_curdoc", websocket.__file__)
    assert spec is not None and spec.loader is not None
    without = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(without)
    assert without.set_curdoc is None
    handled: list[Event] = []

    class Panel:
        """What handles events where a release of Panel does it alone."""

        def _process_bokeh_event(self, document: Document, event: Event) -> None:
            handled.append(event)

        def _process_event(self, event: Event) -> None:
            pytest.fail("it needs set_curdoc")

    event = Event()
    type("Part", (without.WithoutBusyIndicator, Panel), {})()._process_bokeh_event(Document(), event)
    assert handled == [event]
