"""Connections that send requests slowly, or none, and bodies that are too large, are closed.

A raw socket sends what a browser would not send. Constants are lowered so that a test takes about a second.
"""

from __future__ import annotations

import socket
import time
from collections.abc import Iterator

import pytest
from frames import received
from listening import SECRET, Listening

from app import server
from app.server import Access


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
