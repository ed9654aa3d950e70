"""A page that sends too many or too long frames, or that does not read its own, is closed.

Constants are lowered so that a test takes about a second.
"""

from __future__ import annotations

import contextlib
import json
import logging
import socket
from collections.abc import Iterator

import pytest
import waiting
from frames import CONTINUED, PING, PONG, TEXT, closed_with, code_of, connected, masked, message, received
from listening import SECRET, Listening

from app import server
from app.serve.http import frame_rate, guarded_socket, message_rules
from app.serve.http.message_rules import UPLOAD
from app.serve.http.unsent import UnsentBytes
from app.serve.monitoring.metrics import METRICS
from app.server import Access

#: Floods of frames: the first bytes of each, and the repeated bytes.
FLOODS = {
    "messages": (b"", message()), "pings": (b"", masked(PING, b"hello")), "pongs": (b"", masked(PONG)),
    "empty pieces of one message": (masked(TEXT, final=False), masked(CONTINUED, final=False)),
    "frames without a mask": (b"", b"\x89\x00"), "large pieces": (masked(TEXT, final=False), masked(CONTINUED, b"x" * 70_000, final=False)),
}


@pytest.fixture(scope="module")
def dashboard() -> Iterator[Listening]:
    """Yield a dashboard with the settings of a public server, on localhost."""
    one = Listening(Access(secret=SECRET))
    yield one
    one.stop()


@pytest.mark.parametrize("kind", FLOODS)
def test_a_flood_of_frames_closes_the_connection(kind: str, dashboard: Listening, monkeypatch: pytest.MonkeyPatch) -> None:
    """The flood goes over a raw socket, since Tornado only delivers whole messages. The bucket is not refilled here."""
    monkeypatch.setattr(frame_rate, "FRAME_RATE", 0.0)
    monkeypatch.setattr(frame_rate, "FRAME_BURST", 60.0)
    refused = METRICS.counted["refused_messages"]
    first, repeated = FLOODS[kind]
    with connected(dashboard) as flooding, contextlib.suppress(ConnectionError):
        flooding.sendall(first)
        for _ in range(1000):
            flooding.sendall(repeated)
        while flooding.recv(1_000_000):
            pass
    waiting.until(lambda: METRICS.counted["refused_messages"] == refused + 1, 20)


@pytest.mark.parametrize("kind", ["pings", "pongs", "empty pieces of one message", "frames without a mask"])
def test_as_many_frames_as_are_allowed_at_once_are_taken(kind: str, dashboard: Listening, monkeypatch: pytest.MonkeyPatch) -> None:
    """One more frame closes the connection with the code of a refusal."""
    first, repeated = FLOODS[kind]
    monkeypatch.setattr(frame_rate, "FRAME_RATE", 0.0)
    monkeypatch.setattr(frame_rate, "FRAME_BURST", 200.5)
    status, sending = dashboard.open(dashboard.token())
    assert status == 101
    with sending:
        sending.sendall(first + repeated * (200 - bool(first)))
        assert not closed_with(sending, 2.0), "it was closed too soon"
        sending.sendall(repeated)
        assert closed_with(sending, 30.0) == 1008


@pytest.fixture
def unlimited_frames(monkeypatch: pytest.MonkeyPatch) -> Iterator[Listening]:
    """Yield a separate server that accepts any number of frames."""
    monkeypatch.setattr(frame_rate, "FRAME_RATE", 1e6)
    monkeypatch.setattr(frame_rate, "FRAME_BURST", 1e6)
    server = Listening(Access(secret=SECRET))
    yield server
    server.stop()


def read_nothing(silent: socket.socket, refused: int) -> None:
    """Send messages without reading their answers until the connection is refused.

    Meanwhile, the page may answer pings. Its frames are within all limits, and the answers would fill the memory.
    """
    silent.settimeout(60)
    silent.sendall((masked(PONG) + message()) * 500)  # the system buffers a few more megabytes
    waiting.until(lambda: METRICS.counted["refused_messages"] > refused, 60)


def test_a_page_that_does_not_read_is_closed(unlimited_frames: Listening, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(guarded_socket, "MOST_UNSENT", 100_000)
    refused = METRICS.counted["refused_messages"]
    with connected(unlimited_frames) as silent, contextlib.suppress(ConnectionError):
        read_nothing(silent, refused)
    waiting.until(lambda: METRICS.counted["refused_messages"] == refused + 1, 20)
    waiting.until(lambda: not unlimited_frames.server._tornado.get_sessions("/"), 30)


def test_the_page_with_the_most_unsent_bytes_is_closed_if_all_pages_have_too_many(
        unlimited_frames: Listening, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(guarded_socket, "MOST_UNSENT_TOGETHER", 100_000)
    refused = METRICS.counted["refused_messages"]
    with connected(unlimited_frames) as reading, connected(unlimited_frames) as silent:
        with contextlib.suppress(ConnectionError):
            read_nothing(silent, refused)
        reading.sendall(masked(PING, b"there"))
        assert b"there" in received(reading, 30, b"there")
    assert METRICS.counted["refused_messages"] == refused + 1


def test_unsent_bytes_are_counted_by_connection() -> None:
    unsent: UnsentBytes[str] = UnsentBytes()
    unsent.add("a", 5)
    unsent.add("b", 7)
    unsent.add("a", 4)
    assert (unsent.total, unsent.of("a"), unsent.of("b"), unsent.largest()) == (16, 9, 7, "a")
    unsent.remove("a", 5)
    assert (unsent.total, unsent.largest()) == (11, "b")
    unsent.remove("b", 7)
    unsent.remove("a", 4)
    assert (unsent.total, unsent.of("a"), unsent.of("b")) == (0, 0, 0)


@pytest.mark.parametrize("pieces", [1, 3])
def test_a_message_may_have_so_many_bytes_and_no_more(pieces: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """This is true of one frame, and of several that Tornado joins."""

    def of_bytes(length: int) -> bytes:
        content = json.dumps({"a": "x" * (length - len(json.dumps({"a": ""})))}).encode()
        step = -(-length // pieces)
        parts = [content[at:at + step] for at in range(0, length, step)]
        return message()[:-len(masked(TEXT, b"{}"))] + b"".join(
            masked(CONTINUED if at else TEXT, part, final=at == len(parts) - 1) for at, part in enumerate(parts))

    monkeypatch.setattr(server, "LARGEST_MESSAGE", 20_000)
    one = Listening(Access(secret=SECRET))
    try:
        for length, taken in ((20_000, True), (20_001, False)):
            with connected(one) as sending:
                sending.sendall(of_bytes(length))
                came = received(sending, 30, b"PULL-DOC-REPLY")
                assert (b"PULL-DOC-REPLY" in came) == taken and code_of(came, b"message too big") == (0 if taken else 1009)
    finally:
        one.stop()


def test_only_a_message_with_a_file_may_be_long(dashboard: Listening, monkeypatch: pytest.MonkeyPatch) -> None:
    """A long message with a file is accepted, and the next message is answered."""
    monkeypatch.setattr(message_rules, "LARGEST_PLAIN_CONTENT", 5000)
    for do, taken in ((UPLOAD, True), ("go", False)):
        entries = [["do", do], ["name", "mine.csv"], ["content", "A" * 5000]]
        values = [["model", {"id": "p1"}], ["data", {"type": "map", "entries": entries}]]
        event = {"type": "event", "name": "data_event", "values": {"type": "map", "entries": values}}
        content = json.dumps({"events": [{"kind": "MessageSent", "msg_type": "bokeh_event", "msg_data": event}]})
        with connected(dashboard) as sending:
            sending.sendall(message(content, "PATCH-DOC") + message())
            came = received(sending, 30, b"PULL-DOC-REPLY")
            assert (b"PULL-DOC-REPLY" in came) == taken and code_of(came, b"message too long") == (0 if taken else 1008)


def test_a_refused_message_closes_the_connection_and_what_comes_after_it_is_not_answered(
        dashboard: Listening, caplog: pytest.LogCaptureFixture) -> None:
    """The log has one line about it, however many messages follow."""
    with caplog.at_level(logging.WARNING, "granchain.requests"), connected(dashboard) as sending:
        sending.sendall(message("{}", "PUSH-DOC") * 3 + message() * 3)
        came = received(sending, 30)
    assert code_of(came, b"unknown kind of message") == 1008 and b"PULL-DOC-REPLY" not in came
    assert [one.getMessage() for one in caplog.records if one.name == "granchain.requests"] == ["refused: unknown kind of message"]


@pytest.mark.parametrize("name", ["detach", "select_subprotocol"])
def test_a_socket_that_tornado_treats_otherwise_takes_no_messages(name: str, monkeypatch: pytest.MonkeyPatch, dashboard: Listening) -> None:
    """This simulates a release that reads frames in another way, which are then not counted, or gives no connection."""
    monkeypatch.delattr(guarded_socket.GuardedSocket, name)
    refused = METRICS.counted["refused_messages"]
    status, sending = dashboard.open(dashboard.token())
    assert status == 101
    with sending, contextlib.suppress(ConnectionError):
        sending.sendall(message())
        waiting.until(lambda: METRICS.counted["refused_messages"] == refused + 1, 20)
