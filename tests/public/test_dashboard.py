"""The dashboard of a notebook: it answers at its address, may be shown in a notebook's frame, and can be closed."""

from __future__ import annotations

import socket
import urllib.error
import urllib.request

import pytest

from granchain import BadInput, dashboard, scene


def test_the_dashboard_answers_with_the_scene_and_ends() -> None:
    with dashboard(scene("sec2").evolve(f=1130.0), height=600) as board:
        assert board.url.endswith("/?v=1&scene=sec2&f=1130.0") and board.url.startswith("http://localhost:")
        shown = board._repr_html_()
        assert 'height="600"' in shown and board.url.replace("&", "&amp;") in shown
        with urllib.request.urlopen(board.url, timeout=60) as answer:
            assert answer.status == 200 and "X-Frame-Options" not in answer.headers
            assert "frame-ancestors 'self' http://localhost:* http://127.0.0.1:*" in answer.headers["Content-Security-Policy"]
    with pytest.raises(urllib.error.URLError):
        urllib.request.urlopen(board.url, timeout=5)


def test_a_taken_port_is_reported_in_the_servers_own_words() -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        with pytest.raises(BadInput, match=rf"^The dashboard did not start: Cannot listen on 127.0.0.1:{port}"):
            dashboard(port=port)


def test_an_unknown_scene_starts_nothing() -> None:
    with pytest.raises(BadInput, match="'sec3'"):
        dashboard("sec3")
