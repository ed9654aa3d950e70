"""Scripts and styles are sent compressed, once for all visitors, with unchanged content."""

from __future__ import annotations

import asyncio
import gzip
import http.client
import os
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest
from tornado.httpserver import HTTPServer
from tornado.ioloop import IOLoop
from tornado.netutil import bind_sockets
from tornado.web import Application, StaticFileHandler

from app.serve.http import compressed as module
from app.serve.http.compressed import compressed
from app.serve.http.rules import Rules
from app.serve.monkeypatches.request_handlers import Guards

SCRIPT = b"// a line that is there often enough\n" * 200


@pytest.fixture
def port(tmp_path: Path) -> Iterator[int]:
    """Yield the port of a server of the files in `tmp_path`."""
    for name, content in (("a.js", SCRIPT), ("small.js", b"1;"), ("a.png", SCRIPT), ("random.js", os.urandom(4000))):
        (tmp_path / name).write_bytes(content)
    socket = bind_sockets(0, "127.0.0.1")[0]
    loops: list[IOLoop] = []
    started = threading.Event()

    def run() -> None:
        asyncio.set_event_loop(asyncio.new_event_loop())
        loops.append(IOLoop.current())
        HTTPServer(Application([(r"/(.*)", Guards(Rules()).before(StaticFileHandler), {"path": str(tmp_path)})])).add_sockets([socket])
        loops[0].add_callback(started.set)
        loops[0].start()

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    assert started.wait(60)
    yield socket.getsockname()[1]
    loops[0].add_callback(loops[0].stop)
    thread.join(20)
    socket.close()


def ask(port: int, name: str, method: str = "GET", **headers: str) -> tuple[int, dict[str, str], bytes]:
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=20)
    connection.request(method, f"/{name}", headers={key.replace("_", "-"): value for key, value in headers.items()})
    answer = connection.getresponse()
    found = answer.status, dict(answer.getheaders()), answer.read()
    connection.close()
    return found


def test_a_script_is_compressed_for_a_browser_that_takes_it(port: int) -> None:
    status, headers, content = ask(port, "a.js", Accept_Encoding="gzip, deflate, br")
    assert status == 200 and headers["Content-Encoding"] == "gzip" and headers["Vary"] == "Accept-Encoding"
    assert int(headers["Content-Length"]) == len(content) < len(SCRIPT) / 10
    assert gzip.decompress(content) == SCRIPT
    assert headers["X-Content-Type-Options"] == "nosniff"  # the guard comes first
    head = ask(port, "a.js", "HEAD", Accept_Encoding="gzip")
    assert head[1]["Content-Length"] == headers["Content-Length"] and head[2] == b""


def test_clients_without_gzip_or_with_a_range_get_the_plain_file(port: int) -> None:
    status, headers, content = ask(port, "a.js")
    assert status == 200 and content == SCRIPT and "Content-Encoding" not in headers and headers["Vary"] == "Accept-Encoding"
    status, headers, content = ask(port, "a.js", Accept_Encoding="gzip", Range="bytes=3-9")
    assert status == 206 and content == SCRIPT[3:10] and "Content-Encoding" not in headers


@pytest.mark.parametrize(("wanted", "accepted"), [
    ("gzip", True), ("deflate, GZIP;q=0.5", True), ("gzip; q=1.0, *;q=0", True), ("gzip;q=0", False), ("br, gzip ; q=0.000", False),
    ("gzip;q=0.001", True), ("*", False), ("", False), ("x-gzipped", False)])
def test_gzip_with_the_weight_zero_is_not_accepted(wanted: str, accepted: bool, port: int) -> None:
    _, headers, content = ask(port, "a.js", Accept_Encoding=wanted)
    assert (headers.get("Content-Encoding") == "gzip") == accepted
    assert (gzip.decompress(content) if accepted else content) == SCRIPT


@pytest.mark.parametrize("name", ["small.js", "a.png", "random.js"])
def test_files_that_would_not_shrink_are_not_compressed(name: str, port: int, tmp_path: Path) -> None:
    _, headers, content = ask(port, name, Accept_Encoding="gzip")
    assert content == (tmp_path / name).read_bytes() and "Content-Encoding" not in headers


def test_etags_avoid_a_second_copy_and_differ_for_plain_and_compressed(port: int) -> None:
    packed, plain = ask(port, "a.js", Accept_Encoding="gzip")[1]["Etag"], ask(port, "a.js")[1]["Etag"]
    assert packed != plain
    assert ask(port, "a.js", Accept_Encoding="gzip", If_None_Match=packed)[0] == 304
    assert ask(port, "a.js", Accept_Encoding="gzip", If_None_Match=plain)[0] == 200


def test_a_file_is_compressed_once_until_it_changes(port: int, tmp_path: Path) -> None:
    compressed.cache_clear()
    for _ in range(3):
        ask(port, "a.js", Accept_Encoding="gzip")
    assert compressed.cache_info().misses == 1
    (tmp_path / "a.js").write_bytes(2 * SCRIPT)
    assert gzip.decompress(ask(port, "a.js", Accept_Encoding="gzip")[2]) == 2 * SCRIPT


def test_a_missing_file_is_not_found(port: int) -> None:
    assert ask(port, "b.js", Accept_Encoding="gzip")[0] == 404


def test_addresses_that_are_refused_leave_nothing_in_memory(port: int) -> None:
    """Tornado refuses absolute paths, of which a stranger may send any number."""
    def remembered() -> int:
        return sum(len(one) for name, one in vars(module).items() if isinstance(one, dict) and not name.startswith("__"))

    before = remembered()
    for number in range(20):
        assert ask(port, f"/x{number:0500d}")[0] == 403
    assert remembered() == before
