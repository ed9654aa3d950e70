"""The limits of docs/security.md have the values of the code, and each is enforced.

A raw socket sends what a browser would not send. Constants are lowered so that a test takes about a second.
"""

from __future__ import annotations

import contextlib
import json
import logging
import re
import socket
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
import waiting
from listening import SECRET, Listening

from app import server
from app.curve.computation import CURVES_SHARED
from app.dashboard.picture_work import PICTURES_SHARED
from app.pages.analysis import questions
from app.serve.computing.worker_pools import LONG
from app.serve.http import frame_rate, guarded_socket, message_rules
from app.serve.http.frame_rate import FRAME_BURST, FRAME_RATE, FRAME_UNIT
from app.serve.http.limits import LARGEST_UPLOAD, MOST_UPLOADED_POINTS
from app.serve.http.message_rules import LARGEST_PLAIN_CONTENT, UPLOAD
from app.serve.http.unsent import UnsentBytes
from app.serve.monitoring.metrics import METRICS
from app.server import Access
from app.session.budget import FIRST_PICTURE, UNASKED_CURVE, WHOLE_PICTURE
from app.session.initial_state import MOST_BEADS_IN_LINK
from app.session.share import LONGEST_LINK, PINS
from granchain_core.orbits.branch.branch import MOST_POINTS
from granchain_core.scene.quantities import QUANTITIES

TESTS = Path(__file__).parents[2]


PAGE = (TESTS.parent / "docs" / "security.md").read_text(encoding="utf-8")
#: The rows of the table of the server's limits: limit, value, constant and file, tests.
ROWS = re.findall(r"^\| ([^|]+) \| ([^|]+) \| ([^|]+) \| ([^|]+) \|$",
                  PAGE.split("| limit | value | constant and file | tested by |")[1].split("\n\n")[0], re.MULTILINE)
#: The limits of the server: a value, and the names of its tests.
LIMITS = {limit: (value, re.findall(r"`(\w+)`", tests)) for limit, value, _, tests in ROWS}
#: The rows of the table of what visitors may ask for: what, value, constant and file.
ASKED_ROWS = re.findall(r"^\| ([^|]+) \| (\d+) \| ([^|]+) \|$",
                        PAGE.split("| a visitor asks for | at most | constant and file |")[1].split("\n\n")[0], re.MULTILINE)
#: The section of the promises, without and with the table of their tests.
PROMISES, _, PROMISE_TABLE = PAGE.split("## What is promised\n")[1].split("`--max-sessions` is the only limit")[0].partition(
    "| promise | tested by |")
PROMISE_ROWS = re.findall(r"^\| ([^|`]+) \| ([^|]+) \|$", PROMISE_TABLE, re.MULTILINE)


def constants_in(cell: str) -> tuple[str, ...]:
    """Return the names of constants in a cell, by which rows are found: their words may change."""
    return tuple(re.findall(r"`(\w+)`", cell))


def contains(text: str, value: str) -> bool:
    """Return whether a text contains a value that is no part of a longer number."""
    return re.search(rf"(?<![\w.]){re.escape(value)}(?!\w|\.\d)", text) is not None


def test_the_limits_of_the_document_are_those_of_the_code() -> None:
    """Each row of the table contains the values of its constants, so that neither changes without the other."""
    values = {
        ("IDLE_TIME",): [f"{server.IDLE_TIME} s"],
        ("BODY_TIME", "LARGEST_BODY"): [f"{server.BODY_TIME} s", f"{server.LARGEST_BODY // 1000} kB"],
        ("PING_INTERVAL",): [f"{server.PING_INTERVAL} to {2 * server.PING_INTERVAL} s"],
        ("LARGEST_MESSAGE", "LARGEST_UPLOAD", "LARGEST_PLAIN_CONTENT"): [
            f"{server.LARGEST_MESSAGE / 1e6:.1f} MB", f"{LARGEST_UPLOAD / 1e6:g} MB", f"{LARGEST_PLAIN_CONTENT // 1000} kB"],
        ("FRAME_RATE", "FRAME_BURST", "FRAME_UNIT"): [
            f"{FRAME_RATE:g} a second", f"{FRAME_BURST:g} at once", f"{FRAME_UNIT // 1000} kB"],
        ("MOST_UNSENT",): [f"{guarded_socket.MOST_UNSENT // 1_000_000} MB"],
        ("MOST_UNSENT_TOGETHER",): [f"{guarded_socket.MOST_UNSENT_TOGETHER // 1_000_000} MB"],
        ("UNCONNECTED_MS", "Sessions"): [f"{server.UNCONNECTED_MS // 1000} s", "half of the sessions"],
        ("LONGEST_LINK",): [f"{LONGEST_LINK} characters"],
        ("USUAL_SESSIONS",): [f"{Access().max_sessions}"],
        ("LONG",): [f"{LONG.per_owner_limit} ({LONG.purpose})"],
        ("FIRST_PICTURE", "WHOLE_PICTURE"): [f"{FIRST_PICTURE:g} s (estimated)", f"{WHOLE_PICTURE:g} s of processor time"],
        ("UNASKED_CURVE",): [f"{UNASKED_CURVE:g} s (estimated)"],
        ("PICTURES_SHARED", "CURVES_SHARED"): [f"{PICTURES_SHARED.memory / 1e6:g} MB", f"{CURVES_SHARED.memory / 1e6:g} MB"],
    }
    assert {constants_in(where) for _, _, where, _ in ROWS} == set(values)
    for limit, stated, where, _ in ROWS:
        assert [value for value in values[constants_in(where)] if not contains(stated, value)] == [], limit


def test_the_stated_limits_of_pages_are_those_of_the_code() -> None:
    assert {
        "QUANTITIES": QUANTITIES["N"].high, "PINS": len(PINS), "MOST_BEADS_IN_LINK": MOST_BEADS_IN_LINK,
        "MOST_UPLOADED_POINTS": MOST_UPLOADED_POINTS, "MOST_POINTS": MOST_POINTS,
        "MOST_BEADS": questions.MOST_BEADS, "MOST_VALUES": questions.MOST_VALUES, "MOST_STARTS": questions.MOST_STARTS,
        "MOST_PERIODS": questions.MOST_PERIODS, "MOST_STROBES": questions.MOST_STROBES,
    } == {" ".join(constants_in(where)): int(value) for _, value, where in ASKED_ROWS}


@pytest.mark.parametrize("where", [*(row[2] for row in ROWS), *(row[2] for row in ASKED_ROWS)])
def test_the_constant_of_a_limit_is_in_the_file_that_the_document_names(where: str) -> None:
    places = [re.fullmatch(r"((?:`\w+`(?:, | and )?)+) in `([\w/]+\.py)`", place) for place in where.split("; ")
              if place != "set by `--max-sessions`"]
    for place in places:
        assert place is not None, where
        source = (TESTS.parent / place[2]).read_text(encoding="utf-8")
        for name in re.findall(r"`(\w+)`", place[1]):
            assert re.search(rf"^(class )?{name}\b", source, re.MULTILINE), (name, place[2])


@pytest.mark.parametrize(("what", "tests"), [*((limit, tests) for limit, (_, tests) in LIMITS.items()),
                                             *((promise, list(constants_in(tests))) for promise, tests in PROMISE_ROWS)])
def test_every_limit_and_every_promise_names_its_tests(what: str, tests: list[str]) -> None:
    sources = "\n".join(path.read_text(encoding="utf-8") for path in TESTS.rglob("test_*.py"))
    assert tests and all(f"\ndef {test}(" in sources for test in tests), what


def test_the_table_of_tests_has_every_promise() -> None:
    """A promise with parts in the list has a row for each part."""
    promises: list[str] = []
    for outer, inner in re.findall(r"^(?:- \*\*(.+?)\.\*\*|  - \*(.+?):\*)", PROMISES, re.MULTILINE):
        if outer:
            promises.append(outer)
            heading = outer
        else:
            promises = [name for name in promises if name != heading] + [f"{heading}: {inner.lower()}"]
    assert [name for name, _ in PROMISE_ROWS] == promises


@pytest.fixture(scope="module")
def dashboard() -> Iterator[Listening]:
    """Yield a dashboard with the settings of a public server, on localhost."""
    one = Listening(Access(secret=SECRET))
    yield one
    one.stop()


def test_a_connection_that_sends_half_a_request_is_closed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(server, "IDLE_TIME", 1)
    one = Listening(Access(secret=SECRET))
    try:
        with socket.create_connection(("127.0.0.1", one.port), timeout=30) as half:
            half.sendall(b"GET / HTTP/1.1\r\nHost: local")
            assert half.recv(100) == b""
    finally:
        one.stop()


def test_a_websocket_that_answers_no_ping_is_closed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(server, "PING_INTERVAL", 1)
    one = Listening(Access(secret=SECRET))
    try:
        status, silent = one.open(one.token())
        assert status == 101
        silent.settimeout(60)
        while silent.recv(4096):
            pass
        silent.close()
    finally:
        one.stop()


@pytest.mark.parametrize("ended", [b"GET /liveness HTTP/1.1\r\nHost: localhost\r\n\r\n", b""])
def test_a_connection_that_asks_nothing_more_is_closed(ended: bytes, monkeypatch: pytest.MonkeyPatch) -> None:
    """One connection has received a whole answer, the other never asks anything."""
    monkeypatch.setattr(server, "IDLE_TIME", 1)
    one = Listening(Access(secret=SECRET))
    try:
        with socket.create_connection(("127.0.0.1", one.port), timeout=30) as idle:
            began = time.monotonic()
            idle.sendall(ended)
            came = received(idle, 30)
            assert came.endswith(b'{"/liveness": true}') if ended else came == b""
            assert 0.9 < time.monotonic() - began < 25, "the server closed it, but not at once"
    finally:
        one.stop()


def test_a_body_that_does_not_come_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(server, "BODY_TIME", 1)
    one = Listening(Access(secret=SECRET))
    try:
        with socket.create_connection(("127.0.0.1", one.port), timeout=30) as slow:
            began = time.monotonic()
            slow.sendall(b"POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 10\r\n\r\nhalf")
            assert received(slow, 30) == b""
            assert 0.9 < time.monotonic() - began < 25
    finally:
        one.stop()


@pytest.mark.parametrize(("length", "status"), [(server.LARGEST_BODY, b"405"), (server.LARGEST_BODY + 1, b"400"), (10**9, b"400")])
@pytest.mark.parametrize("chunked", [False, True])
def test_too_large_a_body_is_refused(length: int, status: bytes, chunked: bool, dashboard: Listening) -> None:
    """The largest allowed body is read, and refused by the page, which accepts none; a larger one is not read."""
    head = b"Transfer-Encoding: chunked\r\n\r\n%x\r\n" % length if chunked else b"Content-Length: %d\r\n\r\n" % length
    sent = b"x" * length + (b"\r\n0\r\n\r\n" if chunked else b"") if length <= server.LARGEST_BODY else b""
    with socket.create_connection(("127.0.0.1", dashboard.port), timeout=30) as one:
        one.sendall(b"POST / HTTP/1.1\r\nHost: localhost\r\n" + head + sent)
        assert one.recv(1000).split()[1] == status


def masked(opcode: int, payload: bytes = b"", final: bool = True) -> bytes:
    """Return a frame as a browser sends it (RFC 6455, section 5.2), with a mask of zeros."""
    length = bytes([0x80 | len(payload)]) if len(payload) < 126 else bytes([0x80 | 127]) + len(payload).to_bytes(8)
    return bytes([opcode | 0x80 * final]) + length + bytes(4) + payload


TEXT, CONTINUED, PING, PONG = 1, 0, 9, 10




def message(content: str = "{}", kind: str = "PULL-DOC-REQ") -> bytes:
    """Return a message as BokehJS sends it, in three frames."""
    return b"".join(masked(TEXT, part.encode()) for part in (json.dumps({"msgid": "1", "msgtype": kind}), "{}", content))


BOKEH_MESSAGE = message()
#: Floods of frames: the first bytes of each, and the repeated bytes.
FLOODS = {
    "messages": (b"", BOKEH_MESSAGE), "pings": (b"", masked(PING, b"hello")), "pongs": (b"", masked(PONG)),
    "empty pieces of one message": (masked(TEXT, final=False), masked(CONTINUED, final=False)),
    "frames without a mask": (b"", b"\x89\x00"), "large pieces": (masked(TEXT, final=False), masked(CONTINUED, b"x" * 70_000, final=False)),
}


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


def received(sent: socket.socket, patience: float, until: bytes | None = None) -> bytes:
    """Return the bytes received until the other side closes, the time is up, or `until` has arrived."""
    sent.settimeout(patience)
    came = b""
    with contextlib.suppress(TimeoutError, ConnectionError):
        while more := sent.recv(1_000_000):
            came += more
            if until is not None and until in came:
                break
    return came


def connected(one: Listening) -> socket.socket:
    """Return a new page's websocket that Bokeh has acknowledged; before that, it accepts no messages."""
    status, there = one.open(one.token())
    assert status == 101 and b'"ACK"' in received(there, 30, b'"ACK"')
    return there


def closed_with(sent: socket.socket, patience: float, reason: bytes = b"too many frames") -> int:
    """Return the code of the closing frame with this reason; 0 if none arrives within this many seconds."""
    return code_of(received(sent, patience), reason)


def code_of(came: bytes, reason: bytes) -> int:
    """Return the code of a closing frame with this reason; 0 if there is none."""
    at = came.rfind(reason)
    return int.from_bytes(came[at - 2:at]) if at > 1 else 0


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
        sending.sendall(BOKEH_MESSAGE)
        waiting.until(lambda: METRICS.counted["refused_messages"] == refused + 1, 20)
