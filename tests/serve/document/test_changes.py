"""A page's gathered changes are sent as the message that Bokeh would send, in the order in which they were made."""

from __future__ import annotations

import base64
import gzip
import json
import socket
import struct
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from answering_server import Served, ask, wait_for
from bokeh.client import pull_session
from bokeh.document import Document
from bokeh.document.events import ColumnDataChangedEvent, MessageSentEvent, ModelChangedEvent
from bokeh.models import ColumnDataSource, Div, Range1d
from bokeh.protocol import Protocol
from bokeh.server.session import ServerSession
from bokeh.server.views.ws import WSHandler
from event_loop import in_a_thread, run_async
from missing_attribute import hide, lose
from panel.models.esm import ESMEvent
from panel.models.vega import VegaPlot
from tornado.iostream import IOStream
from tornado.locks import Lock

from app.library_internals import Internal
from app.serve.document import changes
from app.serve.document.changes import encode_patch, set_properties

pytestmark = pytest.mark.quick


def parts_of(data: bytes) -> list[bytes]:
    """Return the payloads of complete, unmasked and uncompressed websocket frames."""
    parts = []
    while data:
        kind, length = data[0], data[1]
        assert kind in (0x81, 0x82)
        start = 2
        if length == 126:
            (length,), start = struct.unpack("!H", data[2:4]), 4
        elif length == 127:
            (length,), start = struct.unpack("!Q", data[2:10]), 10
        parts.append(data[start : start + length])
        data = data[start + length :]
    return parts


def without_ids(value: Any, buffers: dict[str, bytes]) -> Any:
    """Return a message's content with its arrays instead of their ids."""
    if isinstance(value, dict):
        if value.get("type") == "bytes":
            data = value["data"]  # within the text: base64 of gzip, without which the browser shows nothing at all
            return gzip.decompress(base64.b64decode(data)) if isinstance(data, str) else buffers[data["id"]]
        return {name: without_ids(one, buffers) for name, one in value.items()}
    return [without_ids(one, buffers) for one in value] if isinstance(value, list) else value


def read(data: bytes) -> Any:
    """Return the content of a written message."""
    header, metadata, content, *buffers = parts_of(data)
    assert json.loads(header)["msgtype"] == "PATCH-DOC" and json.loads(metadata) == {}
    assert json.loads(header).get("num_buffers", 0) == len(buffers) // 2
    return without_ids(json.loads(content), {json.loads(name)["id"]: one
                                             for name, one in zip(buffers[::2], buffers[1::2], strict=True)})


def events_of(document: Document) -> list[Any]:
    source, axis, words = ColumnDataSource(), Range1d(), Div()
    for one in (source, axis, words):
        document.add_root(one)
    document.models.flush_synced()  # the browser has them
    said = {"type": "frames", "number": 3, "radii": [0.5, float("nan"), -float("inf")], "knobs": {}, "fit": None, "live": True,
            "values": np.linspace(0, 1, 7, dtype=np.float32), "peaks": [("max 2", "N")], "a": {"b": [{"c": "é"}]}}
    return [
        ModelChangedEvent(document, axis, "start", np.float64(0.25)), ModelChangedEvent(document, words, "text", "é" * 40_000),
        ColumnDataChangedEvent(document, source, "data", {
            "time": np.arange(5, dtype=np.float32), "long": np.arange(30_000, dtype=np.float32).reshape(2, -1)[:, ::2],
            "image": [np.ones((2, 3), np.float32)], "none": np.zeros(0), "label": ["a", "b"]}),
        MessageSentEvent(document, "bokeh_event", ESMEvent(model=words, data=said)),
    ]


def test_a_message_equals_the_one_that_bokeh_writes() -> None:
    document = Document()
    events = events_of(document)
    theirs = Protocol().create("PATCH-DOC", events)
    data = encode_patch(events)
    assert data is not None
    buffers = {one.ref["id"]: bytes(one.to_bytes()) for one in theirs.buffers}
    expected = without_ids(json.loads(theirs.content_json), buffers)

    def plain(value: Any) -> Any:  # Bokeh leaves out entries that are None
        if isinstance(value, dict):
            found = {name: plain(one) for name, one in value.items()}
            return {"entries": [], **found} if value.get("type") == "map" else found
        return [plain(one) for one in value] if isinstance(value, list) else value

    assert plain(read(data)) == plain(expected)


def test_values_that_are_not_plain_are_encoded_by_bokeh() -> None:
    document = Document()
    words = Div()
    document.add_root(words)
    assert encode_patch([ModelChangedEvent(document, words, "tags", [Range1d()])]) is None


def test_outside_a_gathering_a_change_goes_to_the_model() -> None:
    document = Document()
    axis = Range1d(start=0, end=1)
    document.add_root(axis)
    seen: list[Any] = []
    axis.on_change("start", lambda _attribute, _old, new: seen.append(new))
    set_properties(axis, start=3)
    assert axis.start == 3 and seen == [3]


def test_the_last_change_of_a_property_is_kept_and_an_equal_value_is_no_change() -> None:
    document = Document()
    axis = Range1d(start=3, end=7)
    document.add_root(axis)
    document.callbacks.hold()
    for start, end in ((2, 7), (4, 7)):
        set_properties(axis, start=start, end=end)
    events = [(one.attr, one.new) for one in document.callbacks._held_events]
    assert events == [("start", 4)] and axis.start == 4


def test_a_property_called_data_is_one_of_columns_in_data_sources_alone() -> None:
    document = Document()
    source, plot = ColumnDataSource(data={"x": [1]}), VegaPlot(data={"values": [1]})
    document.add_root(source)
    document.add_root(plot)
    document.callbacks.hold()
    set_properties(source, data={"x": [2]})
    set_properties(plot, data={"values": [2]})
    set_properties(plot, data={"values": [2]})
    assert [type(one) for one in document.callbacks._held_events] == [ColumnDataChangedEvent, ModelChangedEvent]


@pytest.mark.parametrize("closing", [False, True])
def test_nothing_follows_a_closing_frame(closing: bool) -> None:
    """By RFC 6455, section 5.5.1, the stream is still open until the other side has answered."""
    async def written() -> list[bytes]:
        there, here = socket.socketpair()
        stream, sent = IOStream(there), list[bytes]()
        stream.write = sent.append  # type: ignore[assignment, method-assign]
        ws_connection = SimpleNamespace(stream=stream, is_closing=lambda: closing)
        page = changes._Socket(SimpleNamespace(_socket=SimpleNamespace(write_lock=Lock(), ws_connection=ws_connection)))
        assert page.usable
        page.write(b"a frame")
        stream.close()
        here.close()
        return sent

    assert run_async(written()) == ([] if closing else [b"a frame"])


@pytest.mark.parametrize("row", changes.INTERNALS, ids=lambda row: row.owner)
def test_a_release_without_a_needed_name_is_noticed(row: Internal, monkeypatch: pytest.MonkeyPatch) -> None:
    assert changes.is_complete()
    for name in row.names:
        with monkeypatch.context() as patch:
            lose(patch, row.owner, name)
            assert not changes.is_complete()


def writes(monkeypatch: pytest.MonkeyPatch) -> list[bytes]:
    """Return a list that gets each message that is written without Bokeh from now on."""
    written: list[bytes] = []
    write = changes._Socket.write

    def noted(self: changes._Socket, data: bytes) -> None:
        written.append(data)
        write(self, data)

    monkeypatch.setattr(changes._Socket, "write", noted)
    return written


@in_a_thread
def test_an_answer_is_one_message_that_bokeh_does_not_write(served: Served, monkeypatch: pytest.MonkeyPatch) -> None:
    written = writes(monkeypatch)
    session = pull_session(url=served.address)
    ask(session, "first")
    wait_for(session, "first, yes")
    session.close()
    assert len(written) == 1


@in_a_thread
def test_actions_are_answered_without_a_needed_part_of_bokeh(served: Served, monkeypatch: pytest.MonkeyPatch) -> None:
    """In that case, Bokeh sends the changes itself."""
    monkeypatch.setattr(changes, "_COMPLETE", False)
    written = writes(monkeypatch)
    session = pull_session(url=served.address)
    ask(session, "first")
    wait_for(session, "first, yes")
    session.close()
    assert not written


@pytest.mark.parametrize(("owner", "name"), [(ServerSession, "_subscribed_connections"), (WSHandler, "ws_connection"),
                                             (WSHandler, "write_lock")], ids=lambda value: getattr(value, "__name__", value))
@in_a_thread
def test_actions_are_answered_without_a_private_name_of_bokeh(owner: type, name: str, served: Served, monkeypatch: pytest.MonkeyPatch) -> None:
    """In that case as well, Bokeh sends the changes itself."""
    written = writes(monkeypatch)
    missed = hide(monkeypatch, changes, owner, name)
    session = pull_session(url=served.address)
    for text in ("first", "second"):
        ask(session, text)
        wait_for(session, f"{text}, yes")
    session.close()
    assert missed and not written
