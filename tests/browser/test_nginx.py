"""Two processes behind nginx with the configuration of docs/nginx.conf: each page has one process, and its pictures."""

from __future__ import annotations

import http.client
import http.server
import re
import shutil
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack

import pytest
from knobs import Visit, settled, type_into
from playwright.sync_api import Page, expect
from server import ROOT, free_port

NGINX = shutil.which("nginx") or shutil.which("nginx", path="/usr/sbin")
pytestmark = pytest.mark.skipif(NGINX is None, reason="nginx is not installed")

# The configuration around the file in an installation of nginx; answers name the process that gave them.
AROUND = """
daemon off; pid {folder}/pid; error_log {folder}/error.log;
events {{}}
http {{
    access_log off; client_body_temp_path {folder}/body; proxy_temp_path {folder}/proxy;
    fastcgi_temp_path {folder}/fastcgi; uwsgi_temp_path {folder}/uwsgi; scgi_temp_path {folder}/scgi;
    {configuration}
    {below_a_path}
}}
"""


def below_a_path(port: int, cookie_port: int) -> str:
    """Return a second server with the locations for a path from docs/deployment.md."""
    page = (ROOT / "docs" / "deployment.md").read_text(encoding="utf-8")
    (locations,) = re.findall(r"```nginx\n(.+?)```", page, re.DOTALL)
    whole = (ROOT / "docs" / "nginx.conf").read_text(encoding="utf-8")
    headers = "\n".join(re.findall(r"^    proxy_.+;$", whole, re.MULTILINE))
    (busy,) = re.findall(r"^    location @busy \{.+?^    \}$", whole, re.MULTILINE | re.DOTALL)
    cookies = f"location = /cookie {{ proxy_pass http://127.0.0.1:{cookie_port}; }}"
    return f"server {{ listen 127.0.0.1:{port};\n{headers}\n{locations}\n{busy}\n{cookies}\n}}"


class SetsCookie(http.server.BaseHTTPRequestHandler):
    """A handler that answers with a cookie like Panel's."""

    def do_GET(self) -> None:
        """Answer with only the cookie."""
        self.send_response(204)
        self.send_header("Set-Cookie", "user=ada; HttpOnly; Path=/")
        self.end_headers()

    def log_message(self, format: str, *args: object) -> None:
        """Log nothing."""


def adapted(port: int, plain: int, processes: list[int]) -> str:
    """Return the configuration of the page, with this test's ports and without a certificate."""
    lines = (ROOT / "docs" / "nginx.conf").read_text(encoding="utf-8").splitlines()
    kept = [line for line in lines if not re.match(r"\s*(ssl_|server 127)", line)]
    assert len(lines) - len(kept) == 6  # four processes, a certificate and its key
    servers = " ".join(f"server 127.0.0.1:{one};" for one in processes)
    text = "\n".join(kept).replace("upstream granchain {", f"upstream granchain {{ {servers}")
    assert text.count("listen 443 ssl;") == text.count("listen 80;") == 1
    text = text.replace("listen 443 ssl;", f"listen 127.0.0.1:{port};\n add_header X-Process $upstream_addr always;")
    return text.replace("listen 80;", f"listen 127.0.0.1:{plain};")


def answers(port: int, path: str, source: str = "127.0.0.1") -> http.client.HTTPResponse:
    """Return the answer to a client at the address `source`, which belongs to this machine like all of 127.0.0.0/8."""
    return asked(port, path, source).getresponse()


def asked(port: int, path: str, source: str) -> http.client.HTTPConnection:
    """Send a request and return its connection."""
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60, source_address=(source, 0))
    connection.request("GET", path)
    return connection


@pytest.fixture(scope="module")
def port(ports: tuple[int, int, int]) -> int:
    """The port of nginx, in front of two processes."""
    return ports[0]


@pytest.fixture(scope="module")
def path(ports: tuple[int, int, int]) -> str:
    """The address of the page below a path."""
    return f"http://127.0.0.1:{ports[1]}/tools/granchain"


@pytest.fixture(scope="module")
def ports(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[int, int, int]]:
    """The ports of nginx: one with only the page, one with the page below a path, and one without TLS."""
    folder = tmp_path_factory.mktemp("nginx")
    outside, below, plain, *processes = free_port(), free_port(), free_port(), free_port(), free_port()
    cookies = http.server.HTTPServer(("127.0.0.1", 0), SetsCookie)
    threading.Thread(target=cookies.serve_forever, daemon=True).start()
    (folder / "secret").write_text("0123456789abcdef0123456789abcdef")
    (folder / "nginx.conf").write_text(AROUND.format(folder=folder, configuration=adapted(outside, plain, processes),
                                                      below_a_path=below_a_path(below, cookies.server_port)))
    commands = [[sys.executable, "-m", "app.cli", "serve", "--port", str(one), "--behind-proxy",
                 "--allow-websocket-origin", f"127.0.0.1:{outside}", "--allow-websocket-origin", f"127.0.0.1:{below}",
                 "--secret-file", str(folder / "secret")] for one in processes]
    commands.append([str(NGINX), "-c", str(folder / "nginx.conf"), "-e", str(folder / "error.log")])
    with ExitStack() as stack, (folder / "log").open("wb") as log:
        stack.callback(cookies.server_close)
        stack.callback(cookies.shutdown)
        for command in commands:
            process = stack.enter_context(subprocess.Popen(command, cwd=ROOT, stdout=log, stderr=log))
            stack.callback(process.terminate)
        end = time.monotonic() + 60
        for one in processes:
            while not alive(one):
                assert time.monotonic() < end, (folder / "log").read_text()
                time.sleep(0.1)
        yield outside, below, plain


def alive(port: int) -> bool:
    """Return whether a process answers on this port."""
    try:
        return answers(port, "/liveness").status == 200
    except OSError:
        return False


def answers_a_knob(page: Page) -> None:
    """Check that a picture arrives, and another one after a change of a knob, over the same connection."""
    settled(page)
    type_into(page, "f", "380")
    settled(page)
    expect(page.locator("#foot #regime")).to_contain_text("period 1")
    expect(page.locator("#lost")).to_be_hidden()


def test_a_page_behind_nginx_has_its_pictures_and_answers_a_knob(visit: Visit, port: int) -> None:
    page = visit("?v=1&scene=sec2&f=1130", url=f"http://127.0.0.1:{port}/")
    answers_a_knob(page)


def test_a_page_below_a_path_has_its_pictures_and_answers_a_knob(visit: Visit, path: str) -> None:
    page = visit("?v=1&scene=sec2&f=1130", url=f"{path}/")
    answers_a_knob(page)
    assert "/tools/granchain/?" in page.evaluate("granchain.address.url().href"), "its links stay below the path"


def test_the_path_without_a_slash_leads_to_the_page_and_keeps_the_link(ports: tuple[int, int, int]) -> None:
    answer = answers(ports[1], "/tools/granchain?v=1&scene=sec2")
    assert answer.status == 301 and str(answer.headers["Location"]).endswith("/tools/granchain/?v=1&scene=sec2")
    assert [answers(ports[1], f"/tools/granchain/{name}").status for name in ("liveness", "readiness", "metrics")] == [200, 200, 404]


def test_pages_beyond_the_rate_are_asked_to_try_again_and_none_waits(port: int) -> None:
    """A burst of sixty is answered at once; further requests get a page that reloads itself."""
    source = "127.2.2.2"
    connections = [asked(port, "/", source) for _ in range(90)]
    found = [one.getresponse() for one in connections]
    refused = [one for one in found if one.status == 503]
    assert refused and all(one.headers["Retry-After"] == "10" for one in refused)
    assert all(one.headers["Strict-Transport-Security"] for one in refused)
    assert b"http-equiv=refresh content=10" in refused[0].read()
    assert answers(port, "/liveness", source).status == 200


def test_attempts_to_sign_in_are_limited(port: int) -> None:
    """The limit is per address, whatever comes from others. These processes have no sign-in, and answer 404."""
    found = [answers(port, "/login", "127.3.3.3").status for _ in range(15)]
    assert found[:11] == [404] * 11 and 429 in found[11:]
    assert answers(port, "/login", "127.3.3.4").status == 404
    assert answers(port, "/liveness", "127.3.3.3").status == 200


def test_a_visitor_always_reaches_the_same_process_and_not_all_the_same_one(port: int) -> None:
    def reached(source: str) -> str | None:
        return answers(port, "/liveness", source).headers["X-Process"]

    sources = [f"127.1.1.{number}" for number in range(1, 41)]  # visitors from one network are distributed, too
    first = [reached(source) for source in sources]
    assert len(set(first)) == 2 and None not in first
    assert [reached(source) for source in sources] == first


def test_browsers_are_redirected_to_tls_with_hsts(ports: tuple[int, int, int]) -> None:
    plain = answers(ports[2], "/?v=1&scene=sec2")
    assert plain.status == 301 and plain.headers["Location"] == "https://granchain.example.org/?v=1&scene=sec2"
    for path, status in (("/", 200), ("/liveness", 200), ("/metrics", 404), ("/nothing", 404)):
        answer = answers(ports[0], path, "127.4.4.4")
        assert (answer.status, answer.headers["Strict-Transport-Security"]) == (status, "max-age=31536000")


def test_cookies_are_sent_over_tls_alone(ports: tuple[int, int, int]) -> None:
    flags = set(str(answers(ports[1], "/cookie").headers["Set-Cookie"]).lower().split("; "))
    assert flags == {"user=ada", "httponly", "path=/", "secure", "samesite=lax"}


def test_metrics_are_closed_to_the_outside(port: int) -> None:
    assert answers(port, "/metrics").status == 404
    assert answers(port, "/liveness").status == 200
