"""Messages that Bokeh would decode but no page sends do not reach Bokeh."""

from __future__ import annotations

import base64
import gzip
import itertools
import json
from typing import Any

import pytest
from event_loop import run_async

from app.serve.http import guarded_socket
from app.serve.http.message_rules import (
    DEEPEST,
    LARGEST_HEADER,
    REPORTED_PROPERTIES,
    UPLOAD,
    RefusedMessage,
    checked_content,
)

pytestmark = pytest.mark.quick

HEADER = json.dumps({"msgid": "1", "msgtype": "PATCH-DOC"})


def content(value: Any, kind: str = "MessageSent") -> str:
    """Return an event with a value."""
    return json.dumps({"events": [{"kind": kind, "msg_type": "bokeh_event", "msg_data": value}]})


def changed(name: object, value: object) -> str:
    """Return a change of one property to a value."""
    return json.dumps({"events": [{"kind": "ModelChanged", "model": {"id": "p1"}, "attr": name, "new": value}]})


def uploaded(do: str, *more: list[str]) -> str:
    """Return a part's message with a file of 200 kB."""
    return of_a_part(["do", do], ["name", "mine.csv"], ["content", "A" * 200_000], *more)


def of_a_part(*entries: list[Any]) -> str:
    """Return a part's message with these entries."""
    values = [["model", {"id": "p1"}], ["data", {"type": "map", "entries": entries}]]
    return content({"type": "event", "name": "data_event", "values": {"type": "map", "entries": values}})


def nested(depth: int) -> list[Any]:
    """Return nested lists."""
    return [nested(depth - 1)] if depth > 1 else []


@pytest.mark.parametrize("value", [
    None, 5, "text", [1, [2]], {"type": "number", "value": "nan"}, {"type": "map", "entries": [["a", {"id": "p2"}]]}, nested(DEEPEST)])
def test_plain_values_pass(value: Any) -> None:
    checked_content(HEADER, content(value))


@pytest.mark.parametrize("value", [
    {"type": "bytes", "data": base64.b64encode(gzip.compress(b"0" * 10**6)).decode()},  # a thousand times as large, decoded
    {"type": "ndarray", "array": [], "dtype": "float64", "shape": [10**9], "order": "little"},
    {"type": "object", "name": "CustomJS", "id": "x"}, {"type": "slice", "start": 0, "stop": 1, "step": 1}, {"type": []},
    {"type": "map", "entries": [["a", {"type": "bytes", "data": "AAAA"}]]}, nested(DEEPEST + 1)])
def test_values_that_no_page_sends_are_refused(value: Any) -> None:
    with pytest.raises(RefusedMessage, match="too deeply" if isinstance(value, list) else "of a kind that no page sends"):
        checked_content(HEADER, content(value))


@pytest.mark.parametrize("name", sorted(REPORTED_PROPERTIES))
@pytest.mark.parametrize("value", [413, 0.5, None])
def test_a_figure_reports_its_size(name: str, value: float | None) -> None:
    checked_content(HEADER, changed(name, value))


@pytest.mark.parametrize("name", ["tags", "name", "data", "children", "state", "subscribed_events", "js_property_callbacks", "title",
                                  "start", "inner_width ", "", None, 5, ["inner_width"], {"type": "map", "entries": []}])
def test_no_other_property_is_set_by_a_browser(name: object) -> None:
    """Bokeh keeps whatever a browser writes into any model's `tags`: 60 messages would take half a gigabyte."""
    with pytest.raises(RefusedMessage, match="property that no page reports"):
        checked_content(HEADER, changed(name, 1))


@pytest.mark.parametrize("value", ["text", [1], {"type": "number", "value": "nan"}, {"type": "map", "entries": []}])
def test_a_size_is_a_number(value: object) -> None:
    with pytest.raises(RefusedMessage, match="not a number"):
        checked_content(HEADER, changed("inner_width", value))


def test_only_an_upload_is_long() -> None:
    checked_content(HEADER, uploaded(UPLOAD))
    for order in itertools.permutations([["do", UPLOAD], ["name", "mine.csv"], ["content", "A" * 200_000]]):
        checked_content(HEADER, of_a_part(*order))
    for given in (uploaded("go"), of_a_part(["do", UPLOAD], ["do", UPLOAD], ["content", "A" * 200_000]),
                  of_a_part(["do", UPLOAD], ["name", 5], ["content", "A" * 200_000]),
                  uploaded(UPLOAD, ["more", "text"]), content("x" * 200_000), changed("tags", "x" * 200_000),
                  json.dumps({"events": [json.loads(uploaded(UPLOAD))["events"][0]] * 2})):
        with pytest.raises(RefusedMessage, match="message too long"):
            checked_content(HEADER, given)
    with pytest.raises(RefusedMessage, match="message too long"):
        checked_content(json.dumps({"msgid": "1", "msgtype": "PULL-DOC-REQ"}), json.dumps({"a": "x" * 200_000}))


@pytest.mark.parametrize(("header", "given", "why"), [
    ("{", "{}", "unreadable header"), ("[" * 100_000, "{}", "unreadable header"), ("[1]", "{}", "unreadable header"),
    ('{"msgtype": "PATCH-DOC"}', content(1), "kind of message"), ('{"msgid": "1", "msgtype": "PUSH-DOC"}', "{}", "kind of message"),
    ('{"msgid": "1", "msgtype": "PATCH-DOC", "num_buffers": 1}', content(1), "binary data"),
    (HEADER, "{}", "no events"), (HEADER, '{"events": []}', "no events"), (HEADER, "[" * 100_000, "unreadable content"),
    (HEADER, '{"events": [5]}', "kind of event"), (HEADER, content(1, "RootAdded"), "kind of event")])
def test_messages_that_no_page_sends_are_refused(header: str, given: str, why: str) -> None:
    with pytest.raises(RefusedMessage, match=why):
        checked_content(header, given)


class Socket:
    """The base class of the guarded websocket here; its frames have been counted."""

    def __init__(self) -> None:
        self.taken: list[str] = []
        self.closed = self.left = 0
        self.request = type("Request", (), {"remote_ip": "127.0.0.1"})

    async def on_message(self, fragment: str) -> None:
        """Record one fragment."""
        self.taken.append(fragment)

    def close(self, code: int, reason: str) -> None:
        """Record the reason."""
        self.closed = code

    def on_close(self) -> None:
        """Fail as Bokeh's method does if the connection has lost its session."""
        self.left += 1


def test_a_refused_message_closes_the_connection_and_nothing_after_it_is_taken() -> None:
    one = type("Both", (guarded_socket.GuardedSocket, Socket), {"__init__": Socket.__init__, "_counted": True, "_has_connection": True})()
    good, bad = (HEADER, "{}", content(1)), (HEADER, "{}", content({"type": "bytes", "data": "AAAA"}))

    async def send() -> None:
        for frame in (*good, *bad, *good):
            if (passed := one.on_message(frame)) is not None:
                await passed

    run_async(send())
    assert one.taken == list(good) and one.closed == 1008


@pytest.mark.parametrize("frames", [("x" * (LARGEST_HEADER + 1),), (HEADER, "x" * (LARGEST_HEADER + 1))])
def test_a_long_header_closes_the_connection_before_the_content_comes(frames: tuple[str, ...]) -> None:
    one = type("Both", (guarded_socket.GuardedSocket, Socket), {"__init__": Socket.__init__, "_counted": True, "_has_connection": True})()
    for frame in frames:
        one.on_message(frame)
    assert one.taken == [] and one.closed == 1008


def test_a_connection_reported_closed_twice_is_counted_once() -> None:
    one = type("Both", (guarded_socket.GuardedSocket, Socket), {"__init__": Socket.__init__, "_counted": True, "_has_connection": True})()
    one.on_close()
    one.on_close()
    assert one.left == 1
