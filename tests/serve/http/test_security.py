"""What docs/security.md promises a server that strangers reach: each sentence is a test here."""

from __future__ import annotations

import contextlib
import json
import logging
import re
import socket
import time
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import waiting
from bokeh.util.token import generate_jwt_token, generate_session_id
from listening import Listening
from tornado.routing import ReversibleRuleRouter
from tornado.web import HTTPError, RequestHandler

from app import server
from app.curve.sweep import CURVES_SHARED
from app.dashboard.main_picture import PICTURES_SHARED
from app.pages.analysis import questions
from app.serve.compiling.compiler import Compiler
from app.serve.computing.worker_pools import LONG
from app.serve.http import frames, guard
from app.serve.http.frames import FRAME_BURST, FRAME_RATE, FRAME_UNIT
from app.serve.http.limits import LARGEST_UPLOAD, MOST_UPLOADED_POINTS
from app.serve.http.message_rules import LARGEST_PLAIN_CONTENT
from app.serve.monitoring.metrics import METRICS, MetricsHandler
from app.server import Access
from app.session import starts
from app.session.budget import FIRST_PICTURE, WHOLE_PICTURE
from app.session.share import LONGEST, PINS
from granchain_core.orbits.branch.branch import MOST_POINTS
from granchain_core.scene.quantities import QUANTITIES

SECRET = b"a secret of this test alone, long enough"


LIMITS = dict(re.findall(r"^\| ([^|]+) \| ([^|]+) \|$", (Path(__file__).parents[3] / "docs" / "security.md").read_text(
    encoding="utf-8").split("| limit | value |")[1].split("\n\n")[0], re.MULTILINE))
STATED_LIMITS = dict(re.findall(r"^\| ([^|]+) \| (\d+) \|$", (Path(__file__).parents[3] / "docs" / "security.md").read_text(
    encoding="utf-8").split("| a visitor asks for | at most |")[1].split("\n\n")[0], re.MULTILINE))


def test_the_limits_of_the_document_are_those_of_the_code() -> None:
    """Literally as the table has them, so that neither changes alone."""
    assert {
        "a request's head": f"{server.IDLE_TIME} s",
        "a request's body": f"{server.BODY_TIME} s, {server.LARGEST_BODY // 1000} kB",
        "a connection that sends nothing": f"{server.IDLE_TIME} s",
        "a websocket that does not answer pings": f"{server.PING_INTERVAL} to {2 * server.PING_INTERVAL} s",
        "a websocket message": f"{server.LARGEST_MESSAGE / 1e6:.1f} MB, for an upload of {LARGEST_UPLOAD / 1e6:g} MB in base64; "
                               f"{LARGEST_PLAIN_CONTENT // 1000} kB without a file",
        "websocket frames": f"{FRAME_RATE:g} a second, {FRAME_BURST:g} at once, of any kind; one counts once more for every {FRAME_UNIT // 1000} kB "
                            "of it; beyond that the connection is closed (1008)",
        "a page that is being loaded": f"{server.UNCONNECTED_MS // 1000} s; at most half of the pages at once",
        "a link": f"{LONGEST} characters",
        "pages at once": f"{Access().most_visitors}",
        "long computations of a visitor at once": f"{LONG.per_owner_limit} (parameter maps, searches, branches, analyses, figures of the paper, virtual "
                                                  "experiments); more wait",
        "first picture, steady state": f"{FIRST_PICTURE:g} s (estimated), {WHOLE_PICTURE:g} s of processor time",
        "pictures and curves kept for all visitors": f"{PICTURES_SHARED.memory / 1e6:g} MB and {CURVES_SHARED.memory / 1e6:g} MB",
    } == LIMITS


def test_what_pages_may_be_asked_is_what_the_document_says() -> None:
    assert {
        "beads of a chain": QUANTITIES["N"].high, "pins": len(PINS), "beads whose state a link holds": starts.MOST_BEADS,
        "points of a measurement": MOST_UPLOADED_POINTS, "points of a branch, each way": MOST_POINTS,
        "Analysis: beads": questions.MOST_BEADS, "Analysis: values of a knob": questions.MOST_VALUES,
        "Analysis: starts of each of two knobs": questions.MOST_STARTS, "Analysis: drive periods": questions.MOST_PERIODS,
        "Analysis: strobes kept": questions.MOST_STROBES,
    } == {name: int(value) for name, value in STATED_LIMITS.items()}


@pytest.fixture(scope="module")
def dashboard() -> Iterator[Listening]:
    """As a public one is served, but here."""
    one = Listening(Access(secret=SECRET))
    yield one
    one.stop()


#: The whole policy of contents. No source is another host or a bare scheme of the network, so that data can neither
#: come from elsewhere nor go there.
POLICY = {
    "default-src": {"'self'"}, "script-src": {"'self'", "'unsafe-inline'", "'unsafe-eval'", "blob:"},
    "style-src": {"'self'", "'unsafe-inline'"}, "img-src": {"'self'", "data:", "blob:"}, "font-src": {"'self'", "data:"},
    "connect-src": {"'self'", "blob:", "data:"}, "worker-src": {"'self'", "blob:"}, "object-src": {"'none'"},
    "base-uri": {"'self'"}, "form-action": {"'self'"}, "frame-ancestors": {"'self'"},
}


def policy(header: str) -> dict[str, set[str]]:
    """The sources of each directive."""
    return {name: set(sources) for name, *sources in (one.split() for one in header.split(";"))}


def test_every_answer_has_its_headers(dashboard: Listening) -> None:
    for path in ("/", "/liveness", "/nothing", "/static/js/bokeh.min.js", "/metrics", "/favicon.ico"):
        headers = dashboard.ask(path)[1]
        assert headers["X-Content-Type-Options"] == "nosniff", path
        assert policy(headers["Content-Security-Policy"]) == POLICY, path
        assert headers["X-Frame-Options"] == "SAMEORIGIN" and re.fullmatch("[0-9a-f]{12}", headers["X-Request-Id"])
        assert headers["Server"] == "granchain"


def test_embedding_is_allowed_where_it_is_asked_for() -> None:
    headers = guard.Rules(embedding=("https://courses.example.org",)).headers()
    assert policy(headers["Content-Security-Policy"]) == {**POLICY, "frame-ancestors": {"'self'", "https://courses.example.org"}}
    assert "X-Frame-Options" not in headers


def test_another_host_is_refused(dashboard: Listening) -> None:
    """A page of a stranger's that resolves its own name to this machine asks under that name."""
    for name in ("evil.example.org", "127.0.0.1.evil.example.org", f"evil.example.org:{dashboard.port}"):
        assert dashboard.ask("/", Host=name)[0] == 421
    assert dashboard.ask("/", Host=f"localhost:{dashboard.port}")[0] == 200


def test_names_may_have_wildcards() -> None:
    rules = guard.Rules(frozenset({"*.example.org", "localhost"}))
    assert rules.serves("granchain.example.org") and rules.serves("LOCALHOST")
    assert not rules.serves("example.org.evil.net") and not rules.serves("127.0.0.1")


@pytest.mark.parametrize(("path", "headers"), [
    ("/?bokeh-session-id=mine", {}), ("/", {"Bokeh_Session_Id": "mine"}), ("/autoload.js?bokeh-session-id=mine", {}),
    ("/?bokeh-token=mine", {}), ("/metadata?bokeh-session-id=mine", {})])
def test_a_clients_own_session_id_is_refused(path: str, headers: dict[str, str], dashboard: Listening) -> None:
    assert dashboard.ask(path, **headers)[0] == 403


def test_a_session_has_one_connection(dashboard: Listening) -> None:
    token = dashboard.token()
    assert dashboard.connect(token) == 101
    assert dashboard.connect(token) == 403, "a second one, or a replayed token"


def strangers_token(secret: bytes | None) -> str:
    """A token that this server has not made: signed with another secret, or not at all."""
    session = generate_session_id(secret_key=secret, signed=secret is not None)
    return generate_jwt_token(session, secret_key=secret, signed=secret is not None)


@pytest.mark.parametrize("secret", [b"another secret, of a stranger", None])
def test_a_token_of_another_secret_gets_no_connection(secret: bytes | None, dashboard: Listening) -> None:
    """Nor is its session's id remembered: anybody could fill the memory with them."""
    assert dashboard.connect(strangers_token(secret)) == 403


def test_tokens_are_signed_also_where_no_secret_is_given() -> None:
    """Otherwise anybody who reaches the port could open sessions without a page, and so more than are allowed."""
    one = Listening(Access())
    try:
        assert [one.connect(strangers_token(secret)) for secret in (b"another secret, of a stranger", None)] == [403, 403]
        assert one.connect(one.token()) == 101
    finally:
        one.stop()


@pytest.mark.parametrize("token", ["", "nonsense", "a.b", "é", "A" * 5000])
def test_no_token_no_connection(token: str, dashboard: Listening) -> None:
    assert dashboard.connect(token) in (400, 403)


def test_another_origin_gets_no_connection(dashboard: Listening) -> None:
    assert dashboard.connect(dashboard.token(), Origin="https://evil.example.org") == 403


def test_an_error_has_an_id_that_is_in_the_log_and_no_traceback(dashboard: Listening, monkeypatch: pytest.MonkeyPatch,
                                                                caplog: pytest.LogCaptureFixture) -> None:
    def fails(*_: object) -> Any:
        raise ZeroDivisionError("the words of an error of ours")

    monkeypatch.setattr("app.serve.monitoring.metrics.METRICS.text", fails)
    with caplog.at_level(logging.WARNING, logger="granchain.requests"):
        status, headers, text = dashboard.ask("/metrics")
    assert status == 500 and headers["X-Request-Id"] in text
    assert not any(word in text for word in ("Traceback", "/", "ZeroDivision", "words of"))
    (record,) = [one for one in caplog.records if getattr(one, "request", "") == headers["X-Request-Id"]]
    assert record.exc_info and "words of an error" in str(record.exc_info[1])


def test_a_page_that_is_only_fetched_starts_no_compiler(dashboard: Listening, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[object] = []
    monkeypatch.setattr(Compiler, "prepare", lambda *words: asked.append(words))
    monkeypatch.setattr(Compiler, "ask", lambda *words: asked.append(words))
    for query in ("/", "/?k=1e5&dissipation=tsuji&tension=cut", "/?scene=rig&F0=10"):
        assert dashboard.ask(query)[0] == 200
    assert asked == []


def test_there_are_at_most_so_many_visitors() -> None:
    one, before = Listening(Access(secret=SECRET, most_visitors=2)), METRICS.opened
    try:
        there = [one.open(one.token()) for _ in range(2)]
        assert [status for status, _ in there] == [101, 101] and one.ask()[0] == 503
        _, headers, text = one.ask()
        seconds = int(headers["Retry-After"])
        assert "try again in a minute" in text and 20 <= seconds <= 60
        assert headers["Content-Type"].startswith("text/html") and f'http-equiv="refresh" content="{seconds}"' in text
        assert one.ask("/liveness")[0] == 200 and one.ask("/readiness")[0] == 503
        for _, each in there:
            each.close()
        waiting.until(lambda: one.ask("/readiness")[0] == 200)
        assert METRICS.opened == before + 2, "neither address makes a page"
    finally:
        one.stop()


def test_a_request_that_becomes_no_connection_takes_none_from_its_page() -> None:
    """Without `Upgrade`, from a stranger's page or without a key: the page itself still connects."""
    one = Listening(Access(secret=SECRET, most_visitors=4))
    try:
        token = one.token()
        offered = {"Sec-WebSocket-Protocol": f"bokeh, {token}"}
        assert one.ask("/ws", **offered)[0] == 400
        assert one.connect(token, Origin="http://elsewhere.example") == 403
        assert one.connect(token, **{"Sec-WebSocket-Key": ""}) == 400
        status, there = one.open(token)
        assert status == 101 and one.connect(token) == 403
        there.close()
    finally:
        one.stop()


def test_pages_that_are_fetched_and_never_connect_leave_half_of_the_places(monkeypatch: pytest.MonkeyPatch) -> None:
    """One client that fetches the page again and again: the oldest page that is still loading makes room."""
    monkeypatch.setattr(server, "SESSION_CHECK_MS", 20)
    one = Listening(Access(secret=SECRET, most_visitors=8))
    try:
        there = [one.open(one.token()) for _ in range(3)]
        first = one.token()
        for _ in range(12):
            assert one.ask()[0] == 200
            time.sleep(0.1)  # until Bokeh has dropped the page that lost its place
        token = one.token()
        assert one.connect(first) in (403, 503), "it has lost its place"
        assert one.connect(token) == 101
        assert [status for status, _ in there] == [101] * 3
        for _, each in there:
            each.close()
    finally:
        one.stop()


@pytest.mark.parametrize("path", ["/autoload.js", "/autoload.js?bokeh-autoload-element=a", "/autoload-js", "/metadata", "/metadata/"])
def test_no_other_address_makes_a_session(path: str, dashboard: Listening) -> None:
    """Bokeh's script for pages that embed it, which ours does not use, would make one for each request."""
    before = METRICS.opened
    assert dashboard.ask(path)[0] == 404
    assert METRICS.opened == before


def test_a_token_of_a_page_that_was_dropped_needs_a_free_place(monkeypatch: pytest.MonkeyPatch) -> None:
    """Bokeh makes its session anew. Otherwise tokens that are collected for five minutes would be as many pages."""
    monkeypatch.setattr(server, "SESSION_CHECK_MS", 20)
    monkeypatch.setattr(server, "UNCONNECTED_MS", 100)
    one = Listening(Access(secret=SECRET, most_visitors=2))
    try:
        tokens = []
        for _ in range(4):
            tokens.append(one.token())
            time.sleep(0.5)  # until it is dropped
        there = [one.open(token) for token in tokens]
        assert [status for status, _ in there] == [101, 101, 503, 503]
        for _, each in there:
            each.close()
    finally:
        one.stop()


def test_every_handler_is_guarded_also_one_that_is_added_later() -> None:
    class Late(RequestHandler):
        """Added to a server that runs."""

        def get(self) -> None:
            """Answer."""
            self.write("late")

    one = Listening(Access(secret=SECRET))
    try:
        for router in (one.server._tornado.default_router, one.server._tornado.wildcard_router):
            for rule in router.rules:
                assert isinstance(rule.target, ReversibleRuleRouter) or issubclass(rule.target, RequestHandler), rule
        one.server._tornado.add_handlers(".*", [("/late", Late)])
        status, headers, text = one.ask("/late")
        assert (status, text) == (200, "late") and "X-Request-Id" in headers
        assert one.ask("/late", Host="evil.example.org")[0] == 421
    finally:
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


@pytest.mark.parametrize(("remote_ip", "allowed"), [
    ("127.0.0.1", True), ("::1", True), ("10.1.2.3", True), ("fd00::7", True), ("8.8.8.8", False), ("2001:4860::1", False),
    ("0.0.0.0", False), (None, False)])
def test_metrics_are_for_known_private_addresses(remote_ip: str | None, allowed: bool) -> None:
    """Tornado says 0.0.0.0 where it does not know the address."""
    asked = SimpleNamespace(request=SimpleNamespace(remote_ip=remote_ip), set_header=lambda *_: None, write=lambda _: None)
    if allowed:
        MetricsHandler.get(asked)  # type: ignore[arg-type]
    else:
        with pytest.raises(HTTPError, match="403"):
            MetricsHandler.get(asked)  # type: ignore[arg-type]


def test_too_large_a_body_is_refused(dashboard: Listening) -> None:
    with socket.create_connection(("127.0.0.1", dashboard.port), timeout=30) as one:
        one.sendall(b"POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1000000000\r\n\r\n")
        answer = one.recv(1000)
        assert answer == b"" or b" 4" in answer.split(b"\r\n")[0]


def masked(opcode: int, payload: bytes = b"", final: bool = True) -> bytes:
    """A frame as a browser sends it (RFC 6455, section 5.2), with a mask of zeros."""
    length = bytes([0x80 | len(payload)]) if len(payload) < 126 else bytes([0x80 | 127]) + len(payload).to_bytes(8)
    return bytes([opcode | 0x80 * final]) + length + bytes(4) + payload


TEXT, CONTINUED, PING, PONG = 1, 0, 9, 10
BOKEH_MESSAGE = masked(TEXT, b'{"msgid": "1", "msgtype": "PULL-DOC-REQ"}') + masked(TEXT, b"{}") * 2
#: Floods of frames, the first bytes of each and what is repeated.
FLOODS = {
    "messages": (b"", BOKEH_MESSAGE), "pings": (b"", masked(PING, b"hello")), "pongs": (b"", masked(PONG)),
    "empty pieces of one message": (masked(TEXT, final=False), masked(CONTINUED, final=False)),
    "frames without a mask": (b"", b"\x89\x00"), "large pieces": (masked(TEXT, final=False), masked(CONTINUED, b"x" * 70_000, final=False)),
}


@pytest.mark.parametrize("kind", FLOODS)
def test_a_flood_of_frames_closes_the_connection(kind: str, dashboard: Listening, monkeypatch: pytest.MonkeyPatch) -> None:
    """Over a raw socket, since Tornado hands over whole messages only. The bucket gets no refill here."""
    monkeypatch.setattr(frames, "FRAME_RATE", 0.0)
    monkeypatch.setattr(frames, "FRAME_BURST", 60.0)
    refused = METRICS.counted["refused_messages"]
    status, flooding = dashboard.open(dashboard.token())
    assert status == 101
    first, repeated = FLOODS[kind]
    with flooding, contextlib.suppress(ConnectionError):
        flooding.sendall(first)
        for _ in range(1000):
            flooding.sendall(repeated)
        while flooding.recv(1_000_000):
            pass
    waiting.until(lambda: METRICS.counted["refused_messages"] == refused + 1, 20)


@pytest.mark.parametrize("kind", ["pings", "pongs", "empty pieces of one message", "frames without a mask"])
def test_as_many_frames_as_are_allowed_at_once_are_taken(kind: str, dashboard: Listening, monkeypatch: pytest.MonkeyPatch) -> None:
    """One more closes the connection with the code of a refusal."""
    first, repeated = FLOODS[kind]
    monkeypatch.setattr(frames, "FRAME_RATE", 0.0)
    monkeypatch.setattr(frames, "FRAME_BURST", 200.5)
    status, sending = dashboard.open(dashboard.token())
    assert status == 101
    with sending:
        sending.sendall(first + repeated * (200 - bool(first)))
        assert not closed_with(sending, 2.0), "it was closed too soon"
        sending.sendall(repeated)
        assert closed_with(sending, 30.0) == 1008


def closed_with(sent: socket.socket, patience: float) -> int:
    """The code in the closing frame that comes within so many seconds; 0 if none does."""
    sent.settimeout(patience)
    came = b""
    with contextlib.suppress(TimeoutError, ConnectionError):
        while more := sent.recv(1_000_000):
            came += more
    at = came.rfind(b"too many frames")
    return int.from_bytes(came[at - 2:at]) if at > 0 else 0


def test_a_server_whose_frames_cannot_be_counted_takes_no_messages(monkeypatch: pytest.MonkeyPatch, dashboard: Listening) -> None:
    """As if Tornado read frames in another way."""
    monkeypatch.delattr(guard.GuardedSocket, "detach")
    refused = METRICS.counted["refused_messages"]
    status, sending = dashboard.open(dashboard.token())
    assert status == 101
    with sending, contextlib.suppress(ConnectionError):
        sending.sendall(BOKEH_MESSAGE)
        waiting.until(lambda: METRICS.counted["refused_messages"] == refused + 1, 20)


def test_with_basic_auth_a_page_asks_who_it_is(tmp_path: Any) -> None:
    (tmp_path / "users.json").write_text(json.dumps({"ada": "lovelace"}))
    one = Listening(Access(secret=SECRET, sign_in=(("basic_auth", str(tmp_path / "users.json")), ("cookie_secret", "x" * 32))))
    try:
        status, headers, _ = one.ask()
        assert status == 302 and "/login" in headers["Location"]
        session = generate_session_id(secret_key=SECRET, signed=True)
        token = generate_jwt_token(session, secret_key=SECRET, signed=True)
        assert one.connect(token) == 403
        assert one.ask("/liveness")[0] == 200
    finally:
        one.stop()


def test_the_metrics_have_the_format_of_prometheus(dashboard: Listening) -> None:
    status, headers, text = dashboard.ask("/metrics")
    assert status == 200 and headers["Content-Type"].startswith("text/plain; version=0.0.4")
    for line in text.splitlines():
        assert re.fullmatch(r'# (HELP|TYPE) granchain_\w+ .+|granchain_\w+(\{(le|queue)="[^"]+"\})? \S+', line), line
    for name in ("visitors", "pictures_total", "answer_seconds_bucket", "queue", "cancelled_total", "picture_cache_hits_total",
                 "resident_memory_bytes"):
        assert f"granchain_{name}" in text
