"""The promises of docs/security.md for a public server: headers, hosts, errors, signing in, metrics.

Promises about sessions are tested in test_sessions.py, those about limits in test_limits.py and test_frames.py.
"""

from __future__ import annotations

import json
import logging
import re
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import pytest
from bokeh.util.token import generate_jwt_token, generate_session_id
from listening import SECRET, Listening
from tornado.routing import ReversibleRuleRouter
from tornado.web import HTTPError, RequestHandler

from app.serve.compiling.compiler import Compiler
from app.serve.http.health import MetricsHandler
from app.serve.http.rules import Rules
from app.server import Access


@pytest.fixture(scope="module")
def dashboard() -> Iterator[Listening]:
    """Yield a dashboard served like a public one, but locally."""
    one = Listening(Access(secret=SECRET))
    yield one
    one.stop()


#: The complete content security policy. No source is another host or a bare network scheme, so data can neither come
#: from elsewhere nor go there.
POLICY = {
    "default-src": {"'self'"}, "script-src": {"'self'", "'unsafe-inline'", "'unsafe-eval'", "blob:"},
    "style-src": {"'self'", "'unsafe-inline'"}, "img-src": {"'self'", "data:", "blob:"}, "font-src": {"'self'", "data:"},
    "connect-src": {"'self'", "blob:", "data:"}, "worker-src": {"'self'", "blob:"}, "object-src": {"'none'"},
    "base-uri": {"'self'"}, "form-action": {"'self'"}, "frame-ancestors": {"'self'"},
}


def policy(header: str) -> dict[str, set[str]]:
    """Return the sources of each directive."""
    return {name: set(sources) for name, *sources in (one.split() for one in header.split(";"))}


def test_every_answer_has_its_headers(dashboard: Listening) -> None:
    for path in ("/", "/liveness", "/nothing", "/static/js/bokeh.min.js", "/metrics", "/favicon.ico"):
        headers = dashboard.ask(path)[1]
        assert headers["X-Content-Type-Options"] == "nosniff", path
        assert policy(headers["Content-Security-Policy"]) == POLICY, path
        assert headers["X-Frame-Options"] == "SAMEORIGIN" and re.fullmatch("[0-9a-f]{12}", headers["X-Request-Id"])
        assert headers["Server"] == "granchain"


def test_embedding_is_allowed_where_it_is_asked_for() -> None:
    headers = Rules(embedding=("https://courses.example.org",)).headers()
    assert policy(headers["Content-Security-Policy"]) == {**POLICY, "frame-ancestors": {"'self'", "https://courses.example.org"}}
    assert "X-Frame-Options" not in headers


def test_another_host_is_refused(dashboard: Listening) -> None:
    """A stranger's page whose own name resolves to this machine makes requests under that name."""
    for name in ("evil.example.org", "127.0.0.1.evil.example.org", f"evil.example.org:{dashboard.port}"):
        assert dashboard.ask("/", Host=name)[0] == 421
    assert dashboard.ask("/", Host=f"localhost:{dashboard.port}")[0] == 200


def test_names_may_have_wildcards() -> None:
    rules = Rules(frozenset({"*.example.org", "localhost"}))
    assert rules.serves("granchain.example.org") and rules.serves("LOCALHOST")
    assert not rules.serves("example.org.evil.net") and not rules.serves("127.0.0.1")


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


def test_every_handler_is_guarded_also_one_that_is_added_later() -> None:
    class Late(RequestHandler):
        """A handler added to a running server."""

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


@pytest.mark.parametrize(("remote_ip", "allowed"), [
    ("127.0.0.1", True), ("::1", True), ("10.1.2.3", True), ("fd00::7", True), ("8.8.8.8", False), ("2001:4860::1", False),
    ("0.0.0.0", False), (None, False)])
def test_metrics_are_for_known_private_addresses(remote_ip: str | None, allowed: bool) -> None:
    """Tornado reports 0.0.0.0 if it does not know the address."""
    asked = SimpleNamespace(request=SimpleNamespace(remote_ip=remote_ip), set_header=lambda *_: None, write=lambda _: None)
    if allowed:
        MetricsHandler.get(asked)  # type: ignore[arg-type]
    else:
        with pytest.raises(HTTPError, match="403"):
            MetricsHandler.get(asked)  # type: ignore[arg-type]


def test_with_basic_auth_a_page_needs_a_sign_in(tmp_path: Any) -> None:
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
        assert re.fullmatch(r"# (HELP|TYPE) (granchain|process)_\w+ .+", line) or re.fullmatch(
            r'(granchain|process)_\w+(\{((stage="\w+",)?le|pool|queue|stage|version)="[^"]+"\})? \S+', line), line
    for name in ("sessions", "pictures_total", "answer_seconds_bucket", "pool_queued", "cancelled_total", "picture_cache_hits_total"):
        assert f"granchain_{name}" in text
    assert "process_resident_memory_bytes" in text


def test_secrets_are_not_in_the_text_of_objects_that_hold_them() -> None:
    """A log or a traceback may contain that text."""
    access = Access(secret=SECRET, sign_in=(("oauth_secret", "of the provider"),))
    for one in (access, Rules(secret=SECRET)):
        assert "secret" not in repr(one) and "of the provider" not in repr(one) and SECRET.decode() not in repr(one)
