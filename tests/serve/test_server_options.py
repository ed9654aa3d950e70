"""What the dashboard's server is told of its limits."""

from __future__ import annotations

import base64
import json
from types import SimpleNamespace
from typing import Any

import pytest

from app import server
from app.serve.http.limits import LARGEST_UPLOAD


def test_the_servers_websocket_takes_the_largest_upload(monkeypatch: pytest.MonkeyPatch) -> None:
    given: dict[str, Any] = {}

    class Served:
        """A server that ends at once."""

        io_loop = SimpleNamespace(start=lambda: None, spawn_callback=lambda _: None)
        _tornado = SimpleNamespace(wildcard_router=SimpleNamespace(rules=[]), websocket_origins=set())

        def start(self) -> None:
            """Nothing to serve."""

    monkeypatch.setattr(server.pn, "serve", lambda pages, **options: given.update(options) or Served())
    monkeypatch.setattr(server.COMPILER, "prepare", lambda scene: None)
    monkeypatch.setattr(server.logs, "configure", lambda level: None)
    monkeypatch.setattr(server.gc, "freeze", lambda: None)
    monkeypatch.setattr(server.settings.perform_document_validation, "set_value", lambda value: None)
    server.serve()
    message = json.dumps({"do": "measurement", "name": "x" * 1000, "content": base64.b64encode(bytes(LARGEST_UPLOAD)).decode()})
    assert len(message) < given["websocket_max_message_size"] < 3_000_000
    assert given["websocket_ping_interval"] == given["websocket_ping_timeout"] == 20
    assert given["http_server_kwargs"]["idle_connection_timeout"] == 60 and given["http_server_kwargs"]["body_timeout"] == 30
