"""While `granchain serve` starts, a browser is shown a waiting page; afterwards, the port is free for the server."""

from __future__ import annotations

import socket
import threading
import urllib.error
import urllib.request
from collections.abc import Callable
from typing import Any

import pytest

import app.server
from app.cli import main
from app.cli.waiting import Waiting


def free_port() -> int:
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return int(one.getsockname()[1])


def asked(port: int, path: str = "/") -> tuple[int, str]:
    try:
        with urllib.request.urlopen(f"http://127.0.0.1:{port}{path}", timeout=60) as answer:
            return answer.status, answer.read().decode()
    except urllib.error.HTTPError as refused:
        return refused.code, refused.read().decode()


def listens(port: int) -> bool:
    with socket.socket() as one:
        return one.connect_ex(("127.0.0.1", port)) == 0


def test_the_command_answers_before_its_server_and_leaves_it_the_port(monkeypatch: pytest.MonkeyPatch) -> None:
    port, seen = free_port(), []

    def served(place: int, address: str, on_ready_to_listen: Callable[[], None], **_: Any) -> None:
        seen.extend([asked(place), asked(place, "/liveness")])
        on_ready_to_listen()
        assert not listens(place)
        with socket.socket() as server:  # as in Tornado
            server.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            server.bind((address, place))

    monkeypatch.setattr(app.server, "serve", served)
    assert main(["serve", "--port", str(port)]) == 0
    (status, page), (health, _) = seen
    assert (status, health) == (503, 503), "a health check waits"
    assert "granchain is starting" in page and 'id="dashboard" class="starting"' in page and 'fetch("liveness"' in page
    assert not listens(port)


def test_a_silent_client_does_not_block_the_start() -> None:
    port = free_port()
    waiting = Waiting("127.0.0.1", port)
    with socket.create_connection(("127.0.0.1", port)):
        assert asked(port)[0] == 503
    waiting.close()
    assert not listens(port)
    waiting.close()  # closing it again has no effect


def test_the_early_answer_is_local_and_leaves_a_taken_port_to_the_server() -> None:
    before = set(threading.enumerate())  # threads of other tests may end in the meantime
    port = free_port()
    Waiting("0.0.0.0", port).close()
    with socket.socket() as other:
        other.bind(("127.0.0.1", port))
        other.listen()
        Waiting("127.0.0.1", port).close()
    assert not set(threading.enumerate()) - before
