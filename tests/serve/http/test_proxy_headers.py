"""Behind a proxy, a visitor cannot choose a request's address or protocol; the tests use a raw socket."""

from __future__ import annotations

import socket
from collections.abc import Iterator

import pytest
from listening import SECRET, Listening
from tornado.httputil import HTTPHeaders, HTTPServerRequest, RequestStartLine

from app.cli import main
from app.serve.http.proxy_headers import read_proxy_headers
from app.server import Access

OUTSIDE, PRIVATE = "8.8.8.8", "10.0.0.1"
BEHIND = pytest.mark.parametrize("behind", [Access(secret=SECRET, proxy=True)], indirect=True)


@pytest.fixture
def behind(request: pytest.FixtureRequest) -> Iterator[Listening]:
    """Yield a server behind a proxy, whose part the test plays."""
    one = Listening(request.param)
    yield one
    one.stop()


def metrics(behind: Listening, *lines: str) -> int:
    """Return the status of `/metrics` with these header lines in the request."""
    with socket.create_connection(("127.0.0.1", behind.port), timeout=60) as one:
        head = ["GET /metrics HTTP/1.1", f"Host: 127.0.0.1:{behind.port}", "Connection: close", *lines, "", ""]
        one.sendall("\r\n".join(head).encode())
        return int(one.recv(100).split()[1])


@BEHIND
def test_metrics_are_closed_to_a_visitor_who_names_a_private_address(behind: Listening) -> None:
    """The proxy adds one of the headers. The other header, and anything before the proxy's entry, is the visitor's."""
    own = (f"X-Real-IP: {PRIVATE}", f"X-Forwarded-For: {OUTSIDE}")
    assert metrics(behind, *own) == metrics(behind, *reversed(own)) == 403
    assert metrics(behind, f"X-Forwarded-For: {PRIVATE}", f"X-Real-IP: {OUTSIDE}") == 403
    assert metrics(behind, f"X-Forwarded-For: {PRIVATE}, {OUTSIDE}") == 403
    assert metrics(behind, f"X-Forwarded-For: {PRIVATE}", f"X-Forwarded-For: {OUTSIDE}") == 403
    assert metrics(behind, f"X-Real-IP: {PRIVATE}", f"X-Real-IP: {OUTSIDE}") == 403
    assert metrics(behind, "X-Forwarded-For: nonsense") == 403


@BEHIND
def test_metrics_are_open_to_private_addresses_behind_a_proxy(behind: Listening) -> None:
    assert metrics(behind) == metrics(behind, f"X-Real-IP: {PRIVATE}") == metrics(behind, f"X-Forwarded-For: {OUTSIDE}, {PRIVATE}") == 200
    assert metrics(behind, f"X-Real-IP: {PRIVATE}", f"X-Forwarded-For: {OUTSIDE}, {PRIVATE}") == 200


@pytest.mark.parametrize("behind", [Access(secret=SECRET, proxy=True, proxy_header="X-Forwarded-For")], indirect=True)
def test_with_a_named_header_no_other_is_read(behind: Listening) -> None:
    assert metrics(behind, f"X-Forwarded-For: {PRIVATE}", f"X-Real-IP: {OUTSIDE}") == 200
    assert metrics(behind, f"X-Forwarded-For: {OUTSIDE}", f"X-Real-IP: {PRIVATE}") == 403


@pytest.mark.quick
@pytest.mark.parametrize(("given", "protocol"), [
    ({"X-Forwarded-Proto": "https", "X-Scheme": "http"}, "https"), ({"X-Scheme": "https"}, "http"),
    ({"X-Forwarded-Proto": "http, https"}, "https"), ({"X-Forwarded-Proto": "gopher"}, "http"), ({}, "http")])
def test_the_protocol_is_in_one_header(given: dict[str, str], protocol: str) -> None:
    request = HTTPServerRequest(start_line=RequestStartLine("GET", "/", "HTTP/1.1"), headers=HTTPHeaders({"Host": "localhost", **given}))
    read_proxy_headers(request)
    assert request.protocol == protocol


def test_a_header_needs_a_proxy(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["serve", "--proxy-header", "X-Real-IP"]) == 2
    assert "--behind-proxy" in capsys.readouterr().err
