"""What docs/security.md promises a server that strangers reach: each sentence is a test here."""

from __future__ import annotations

import itertools
import json
import logging
import re
import socket
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from bokeh.util.token import generate_jwt_token, generate_session_id
from event_loop import run_async
from listening import Listening
from tornado.web import HTTPError

from app import server
from app.curve.sweep import CURVES_SHARED
from app.dashboard.main_picture import PICTURES_SHARED
from app.pages.analysis import questions
from app.serve.compiling.compiler import Compiler
from app.serve.computing.worker_pools import LONG
from app.serve.http import guard
from app.serve.http.limits import LARGEST_UPLOAD, MOST_UPLOADED_POINTS
from app.serve.http.message_rules import LARGEST_PLAIN_CONTENT
from app.serve.monitoring.metrics import MetricsHandler
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
        "websocket frames": f"{guard.FRAME_RATE:g} a second, {guard.FRAME_BURST:g} at once; then the connection is closed "
                            "(1008)",
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
    one = Listening(Access(secret=SECRET, most_visitors=2))
    try:
        assert [one.ask()[0] for _ in range(3)] == [200, 200, 503]
        assert "try again in a minute" in one.ask()[2]
        assert one.ask("/liveness")[0] == 200
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


class Socket:
    """What a guarded websocket is mixed with here."""

    def __init__(self) -> None:
        self.taken, self.closed = 0, 0
        self.request = type("Request", (), {"remote_ip": "127.0.0.1"})

    async def on_message(self, fragment: str) -> None:
        """One more."""
        self.taken += 1

    def close(self, code: int, reason: str) -> None:
        """Closed with a reason."""
        self.closed = code


def test_a_flood_of_messages_closes_the_connection(monkeypatch: pytest.MonkeyPatch) -> None:
    """A thousand a second by the guard's clock, however fast this machine sends them."""
    clock = iter(0.001 * number for number in itertools.count())
    monkeypatch.setattr(guard, "time", SimpleNamespace(monotonic=lambda: next(clock)))
    one = type("Both", (guard.GuardedSocket, Socket), {"__init__": Socket.__init__})()

    async def flood() -> None:
        for frame in itertools.cycle(('{"msgid": "1", "msgtype": "PULL-DOC-REQ"}', "{}", "{}")):
            if one.closed:
                break
            if (passed := one.on_message(frame)) is not None:
                await passed

    run_async(flood())
    # what is left of every message after a millisecond's allowance empties the store
    assert one.closed == 1008 and one.taken == pytest.approx(guard.FRAME_BURST / (1.0 - 1e-3 * guard.FRAME_RATE), rel=1e-3)


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
