"""The limits passed to the dashboard's server."""

from __future__ import annotations

import base64
import json
import re
from pathlib import Path
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
            """Serve nothing."""

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


SECURITY = (Path(__file__).parents[2] / "docs" / "security.md").read_text(encoding="utf-8")
#: Hosts, origins and headers by option, from the table of docs/security.md.
ROWS = {row[0]: row[1:] for row in re.findall(r"^\| (.+?) \| (.+?) \| (.+?) \| (.+?) \|$",
        SECURITY.partition("| option | hosts that are answered")[2].partition("\n\n")[0], re.MULTILINE) if not row[0].startswith("-")}
GIVEN = {"none": {}, "`--address 192.0.2.7`": {"address": "192.0.2.7"},
         "`--allow-websocket-origin a.example.org`": {"origins": ("a.example.org",)},
         "`--allow-websocket-origin b.example.org:8443`": {"origins": ("b.example.org:8443",)},
         "`--allow-embedding https://c.example.org`": {"embedding": ("https://c.example.org",)}, "`--behind-proxy`": {"proxy": True}}


def checks_with(monkeypatch: pytest.MonkeyPatch, address: str = "", **access: Any) -> tuple[set[str], set[str], dict[str, str]]:
    """Return hosts, origins and headers of a server at port 5006."""
    given: dict[str, Any] = {}
    monkeypatch.setattr(server.pn, "serve", lambda pages, **options: given.update(options))
    monkeypatch.setattr(server, "install_guards", lambda rules: given.update(rules=rules) or {})
    server.server_at(5006, address, server.Access(**access))
    return set(given["rules"].hosts), set(given["websocket_origin"]), given["rules"].headers()


@pytest.mark.parametrize("option", GIVEN)
def test_options_change_hosts_origins_and_headers_as_the_page_says(option: str, monkeypatch: pytest.MonkeyPatch) -> None:
    assert list(ROWS) == list(GIVEN)
    hosts, origins, headers = checks_with(monkeypatch, **GIVEN[option])
    plain = checks_with(monkeypatch)
    for found, usual, words in ((hosts, plain[0], ROWS[option][0]), (origins, plain[1], ROWS[option][1])):
        named = set(re.findall(r"`([^`]+)`", words))
        assert named == (found if option == "none" else found - usual) and usual <= found
    ancestors = headers["Content-Security-Policy"].partition("frame-ancestors ")[2]
    if option in ("none", "`--allow-embedding https://c.example.org`"):
        assert f"`frame-ancestors {ancestors}`" in ROWS[option][2]
        assert ("X-Frame-Options" in headers) == ("no `X-Frame-Options`" not in ROWS[option][2])
    else:
        assert ROWS[option][2].startswith("the same") and headers == plain[2]
