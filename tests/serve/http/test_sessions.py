"""Sessions of a public server: their owners, their maximum number, and their single connection."""

from __future__ import annotations

import json
import logging
import time
from collections.abc import Iterator

import pytest
import waiting
from bokeh.util.token import generate_jwt_token, generate_session_id
from listening import SECRET, Listening

from app import server
from app.serve.monitoring.metrics import METRICS
from app.server import Access


@pytest.fixture(scope="module")
def dashboard() -> Iterator[Listening]:
    """Yield a dashboard with the settings of a public server, on localhost."""
    one = Listening(Access(secret=SECRET))
    yield one
    one.stop()


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
    """Return a token that this server has not issued: signed with another secret, or unsigned."""
    session = generate_session_id(secret_key=secret, signed=secret is not None)
    return generate_jwt_token(session, secret_key=secret, signed=secret is not None)


@pytest.mark.parametrize("secret", [b"another secret, of a stranger", None])
def test_a_token_of_another_secret_gets_no_connection(secret: bytes | None, dashboard: Listening) -> None:
    """Its session's id is not remembered either; otherwise, anybody could fill the memory with them."""
    assert dashboard.connect(strangers_token(secret)) == 403


def test_tokens_are_signed_also_where_no_secret_is_given() -> None:
    """Otherwise, anybody who reaches the port could open sessions without a page, and thus more than are allowed."""
    one = Listening(Access())
    try:
        assert [one.connect(strangers_token(secret)) for secret in (b"another secret, of a stranger", None)] == [403, 403]
        assert one.connect(one.token()) == 101
    finally:
        one.stop()


@pytest.mark.parametrize("token", ["", "nonsense", "a.b", "é", "A" * 5000])
def test_a_connection_needs_a_token(token: str, dashboard: Listening) -> None:
    assert dashboard.connect(token) in (400, 403)


def test_another_origin_gets_no_connection(dashboard: Listening) -> None:
    assert dashboard.connect(dashboard.token(), Origin="https://evil.example.org") == 403


def test_the_number_of_sessions_is_limited(caplog: pytest.LogCaptureFixture) -> None:
    one, before = Listening(Access(secret=SECRET, max_sessions=2)), METRICS.opened
    try:
        there = [one.open(one.token()) for _ in range(2)]
        assert [status for status, _ in there] == [101, 101] and one.ask()[0] == 503
        _, headers, text = one.ask()
        seconds = int(headers["Retry-After"])
        assert "try again in a minute" in text and 20 <= seconds <= 60
        assert headers["Content-Type"].startswith("text/html") and f'http-equiv="refresh" content="{seconds}"' in text
        assert one.ask("/liveness")[0] == 200
        caplog.clear()
        with caplog.at_level(logging.DEBUG, "granchain.requests"):
            status, headers, text = one.ask("/readiness")
            one.ask("/liveness")  # by then, everything about the previous answer is in the log
        assert status == 503 and 20 <= int(headers["Retry-After"]) <= 60
        assert json.loads(text) == {"/readiness": False, "reason": "all 2 places for sessions are taken"}
        assert caplog.messages == [], "waiting pages repeat the request"
        for _, each in there:
            each.close()
        waiting.until(lambda: one.ask("/readiness")[0] == 200)
        assert METRICS.opened == before + 2, "neither address makes a page"
    finally:
        one.stop()


def test_a_request_that_becomes_no_connection_takes_none_from_its_page() -> None:
    """Such requests lack `Upgrade` or a key, or come from a stranger's page. The page itself can still connect."""
    one = Listening(Access(secret=SECRET, max_sessions=4))
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
    """If one client fetches the page repeatedly, the oldest page that is still loading makes room."""
    monkeypatch.setattr(server, "SESSION_CHECK_MS", 20)
    one = Listening(Access(secret=SECRET, max_sessions=8))
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
    """Bokeh's script for embedding, which granchain does not use, would create one for each request."""
    before = METRICS.opened
    assert dashboard.ask(path)[0] == 404
    assert METRICS.opened == before


def test_a_token_of_a_page_that_was_dropped_needs_a_free_place(monkeypatch: pytest.MonkeyPatch) -> None:
    """Bokeh creates its session again. Otherwise, tokens collected over five minutes would open as many pages."""
    monkeypatch.setattr(server, "SESSION_CHECK_MS", 20)
    monkeypatch.setattr(server, "UNCONNECTED_MS", 100)
    one = Listening(Access(secret=SECRET, max_sessions=2))
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
