"""Messages for parts of the page reach them as Bokeh would have decoded them, and all others go to Bokeh."""

from __future__ import annotations

import asyncio
import json
import math
from typing import Any

import pytest
from bokeh.core.serialization import Deserializer
from bokeh.document import Document
from bokeh.server.session import ServerSession
from event_loop import run_async
from tornado.ioloop import IOLoop

from app.serve.document.locked_callbacks import LockedCallbacks, run_locked
from app.serve.document.part_messages import dispatch, register

pytestmark = pytest.mark.quick

VALUE = {"type": "map", "entries": [
    ["do", "set"], ["value", 850.3], ["low", {"type": "number", "value": "-inf"}], ["list", [1, None, True, "é", []]],
    ["inner", {"type": "map", "entries": [["a", {"type": "number", "value": "nan"}]]}], ["none", {"type": "map", "entries": []}]]}


class Part:
    """A stand-in for a part of the page, which records its messages."""

    def __init__(self) -> None:
        self.heard: list[Any] = []

    def hear(self, message: Any) -> None:
        """Record one message."""
        self.heard.append(message)


def content(data: Any, model: str = "p1", **changes: Any) -> dict[str, Any]:
    """Return the content of a message as BokehJS writes it."""
    event = {"kind": "MessageSent", "msg_type": "bokeh_event", "msg_data": {"type": "event", "name": "data_event", "values": {
        "type": "map", "entries": [["model", {"id": model}], ["data", data]]}}}
    return json.loads(json.dumps({"events": [{**event, **changes}]}))


def heard(sent: dict[str, Any]) -> tuple[bool, list[Any]]:
    """Return whether a message was accepted, and the messages that the part received."""
    session, part = ServerSession("tested", Document()), Part()  # type: ignore[arg-type]
    register(session.document, "p1", part.hear)

    async def send() -> bool:
        return dispatch(session, sent)

    return run_async(send()), part.heard


def test_a_part_receives_the_values_that_bokeh_decodes() -> None:
    taken, (message,) = heard(content(VALUE))
    expected = Deserializer().decode(json.loads(json.dumps(VALUE)))
    assert taken and math.isnan(message["inner"].pop("a")) and math.isnan(expected["inner"].pop("a"))
    assert message == expected


@pytest.mark.parametrize("sent", [
    content(VALUE, model="p2"), content(VALUE, kind="ModelChanged"), content(VALUE, msg_type="other"), content([1, 2]),
    content({"type": "map", "entries": [["do", {"type": "set", "entries": [1]}]]}),
    content({"type": "map", "entries": [["do", {"type": "number", "value": "7"}]]}),
    content({"type": "map", "entries": [[1, 2]]}), content({"type": "map", "entries": [["a"]]}), content({"type": "map"}),
    content({"type": "map", "entries": "ab"}), {"events": content(VALUE)["events"] * 2}, {"events": []}, {},
])
def test_other_messages_are_left_to_bokeh(sent: dict[str, Any]) -> None:
    assert heard(sent) == (False, [])


def test_a_removed_part_is_not_kept_and_receives_nothing() -> None:
    session = ServerSession("tested", Document())  # type: ignore[arg-type]
    register(session.document, "p1", Part().hear)
    assert not dispatch(session, content(VALUE))


def test_an_action_waits_for_the_lock_and_callbacks_of_threads_run_in_order(monkeypatch: pytest.MonkeyPatch) -> None:
    order: list[Any] = []

    async def act() -> None:
        IOLoop.current()  # as the server creates it
        session = ServerSession("tested", Document())  # type: ignore[arg-type]
        context = type("Context", (), {"session": session})()
        monkeypatch.setattr(Document, "session_context", context)
        channel = LockedCallbacks(session.document)
        with await session._lock.acquire():
            run_locked(session, [lambda: order.append("later")])
            await asyncio.to_thread(lambda: [channel.next_tick(lambda n=n: order.append(n)) for n in range(5)])  # type: ignore[misc]
            channel.call_later(0.0, lambda: order.append("timed"))
            await asyncio.sleep(0.01)
            assert order == []
        while len(order) < 7:
            await asyncio.sleep(0.001)
        assert session._pending_writes is None

    run_async(asyncio.wait_for(act(), 20))
    assert order == ["later", 0, 1, 2, 3, 4, "timed"]


def test_messages_for_a_destroyed_document_are_dropped(monkeypatch: pytest.MonkeyPatch) -> None:
    """E.g. a picture that is ready after Bokeh ends a session and before the page knows: 8 of 10,200 visits saw it."""

    async def act() -> None:
        IOLoop.current()
        session = ServerSession("tested", Document())  # type: ignore[arg-type]
        context = type("Context", (), {"session": session})()
        monkeypatch.setattr(Document, "session_context", context)
        channel = LockedCallbacks(session.document)
        monkeypatch.setattr(Document, "session_context", None)
        session.document.destroy(session)
        channel.next_tick(pytest.fail)
        channel.call_later(0.0, pytest.fail)
        await asyncio.sleep(0.01)

    run_async(act())


def test_an_action_that_fails_keeps_no_other_from_running() -> None:
    order: list[str] = []

    def fail() -> None:
        raise ValueError

    async def act() -> None:
        run_locked(ServerSession("tested", Document()), [fail, lambda: order.append("next")])  # type: ignore[arg-type]

    run_async(act())
    assert order == ["next"]
