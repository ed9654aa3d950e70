"""A page that is hidden, frozen, or on a sleeping computer ("What happens when" in docs/dashboard-server.md)."""

from __future__ import annotations

import re
import time
import urllib.request
from collections.abc import Iterator
from pathlib import Path

import pytest
from server import Server
from sleeping_browser import SleepingBrowser

#: `PING_INTERVAL` of this server [s].
PING_INTERVAL = 1
#: Records the messages that the page sends.
SENT = """window.sent = [];
const send = WebSocket.prototype.send;
WebSocket.prototype.send = function (data) {
  if (typeof data === "string") for (const [, name] of data.matchAll(/\\["do","([\\w-]+)"\\]/g)) window.sent.push(name);
  send.call(this, data);
};"""


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """A dashboard that quickly notices a browser that no longer answers."""
    one = Server(tmp_path_factory.mktemp("pinging") / "log",
                 before=f"import app.server; app.server.PING_INTERVAL = {PING_INTERVAL}")
    one.start()
    yield one
    one.kill()


@pytest.fixture
def page(server: Server, tmp_path: Path) -> Iterator[SleepingBrowser]:
    """A page with its pictures, in its browser."""
    browser = SleepingBrowser(tmp_path)
    browser.open(f"{server.address}?v=1&scene=sec2&f=1130", SENT)
    browser.until("granchain.shown.final && granchain.address.isSettled()")
    browser.evaluate("window.same = true")
    yield browser
    browser.close()
    end = time.monotonic() + 30
    while sessions(server):
        assert time.monotonic() < end, "the page's session stayed"
        time.sleep(0.1)


def metric(server: Server, name: str) -> float:
    with urllib.request.urlopen(server.address + "metrics", timeout=60) as answer:
        found = re.search(rf"^granchain_{name} (\S+)$", answer.read().decode(), re.MULTILINE)
    assert found is not None
    return float(found[1])


def sessions(server: Server) -> float:
    return metric(server, "sessions")


def goes_on(page: SleepingBrowser) -> None:
    """Check that the same page accepts a knob and shows its picture."""
    page.until("document.getElementById('lost').hidden")
    page.evaluate("""(() => {
      const find = (root) => root.querySelector('[data-knob="f"] input[type="text"]')
        ?? [...root.querySelectorAll("*")].map((node) => node.shadowRoot && find(node.shadowRoot)).find(Boolean);
      const field = find(document);
      field.focus();
      field.value = "700";
      field.dispatchEvent(new Event("change"));
      field.blur();
    })()""")
    page.until("granchain.shown.f === 700 && granchain.shown.final")
    assert page.evaluate("window.same")


def comes_back(page: SleepingBrowser) -> None:
    """Check that the page has opened its own link: it is a new page with the same knobs."""
    page.until("!window.same && granchain.shown.f === 1130 && granchain.shown.final")


def test_a_hidden_page_sends_no_pings_and_goes_on_when_it_is_shown(server: Server, page: SleepingBrowser) -> None:
    page.until("sent.includes('ping')")
    page.hide()
    pings = "sent.filter((name) => name === 'ping').length"
    before = page.evaluate(pings)
    time.sleep(3 * PING_INTERVAL)  # so that the server would close a silent connection
    assert page.evaluate(pings) == before and sessions(server) == 1
    page.show()
    page.until("sent.includes('window-shown')")
    goes_on(page)


def test_a_running_chain_waits_for_a_hidden_page(server: Server, page: SleepingBrowser) -> None:
    page.evaluate("""[...document.querySelectorAll("*")].flatMap((node) => [...(node.shadowRoot?.querySelectorAll("button") ?? [])])
      .find((button) => button.title.startsWith("The run continues")).click()""")
    page.until("granchain.shown.live")
    page.hide()
    time.sleep(1)
    sent = metric(server, "pictures_total")
    time.sleep(1)
    assert metric(server, "pictures_total") == sent
    page.show()
    number = page.evaluate("granchain.shown.number")
    page.until(f"granchain.shown.number > {number} + 3")


def test_a_frozen_page_keeps_its_session_and_then_opens_its_link(server: Server, page: SleepingBrowser) -> None:
    """The browser answers the server's pings for the page, and closes the websocket when the page is resumed."""
    page.evaluate("document.addEventListener('freeze', () => { sessionStorage.frozen = true; })")
    page.hide()
    page.freeze()
    time.sleep(3 * PING_INTERVAL)
    assert sessions(server) == 1 and page.evaluate("window.same")
    page.resume()
    page.until("!window.same")
    page.show()
    comes_back(page)
    assert page.evaluate("sessionStorage.frozen")


def test_a_page_goes_on_after_a_short_sleep(server: Server, page: SleepingBrowser) -> None:
    page.sleep(0.5 * PING_INTERVAL)
    goes_on(page)
    assert sessions(server) == 1


def test_a_page_opens_its_link_after_a_long_sleep(server: Server, page: SleepingBrowser) -> None:
    page.sleep(3 * PING_INTERVAL)
    comes_back(page)
