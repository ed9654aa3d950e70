"""One dashboard and one Chromium for all browser tests of a worker. A test opens its own page (`visit`), navigates the
page shared by the tests of its file (`at`), or inspects a page that stays open (`shared`).

A failed test saves screenshots and messages of its pages in a folder named in its report (evidence.py).
"""

from __future__ import annotations

import urllib.request
from collections.abc import Callable, Generator, Iterator
from pathlib import Path
from typing import Any

import pytest
from bokeh_figures import FIGURES
from evidence import WATCHED, folder_of, leave, watch
from knobs import COMPILED, look_seldom
from playwright.sync_api import Browser, BrowserContext, Page, ViewportSize, expect, sync_playwright
from pointer import POINTER_TESTS
from server import dashboard, launch_with_profile

HERE = Path(__file__).parent

#: Options with which most pages are opened.
USUAL: dict[str, Any] = {"viewport": ViewportSize(width=1280, height=800), "reduced_motion": "reduce"}

#: Stash key: whether a test has failed.
FAILED = pytest.StashKey[bool]()
#: Options of a context that can be set for a single page.
MEDIA = ("reduced_motion", "color_scheme")

# Two workers, each with a browser and a server, share two processors: results arrive, but not always within
# Playwright's five seconds.
expect.set_options(timeout=60_000)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Let failed tests of `POINTER_TESTS` run once more; `.ci/run` allows few repetitions."""
    for item in items:
        if item.path.is_relative_to(HERE) and getattr(item, "originalname", "") in POINTER_TESTS.get(item.path.stem, ()):
            item.add_marker(pytest.mark.flaky(reruns=1))


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item,
                              call: pytest.CallInfo[None]) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Save the evidence of a failed test while its pages are still open."""
    report = yield
    item.stash[FAILED] = report.failed
    if report.failed and item.stash.get(WATCHED, None):
        folder = folder_of(item)
        report.sections.append(("What the browser showed and said", f"{leave(item.stash[WATCHED], folder)}, in {folder}"))
    return report


@pytest.fixture(scope="session")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the log file of the dashboard that all tests share."""
    return tmp_path_factory.mktemp("dashboard") / "log"


@pytest.fixture(scope="session")
def address(log: Path) -> Iterator[str]:
    """Yield the address of the running dashboard; in the end, none of the pages' messages may have been refused."""
    with dashboard(log) as url:
        yield url
        with urllib.request.urlopen(url + "metrics", timeout=60) as answer:
            assert "granchain_refused_messages_total 0\n" in answer.read().decode()


@pytest.fixture(scope="session")
def chromium(profile: BrowserContext) -> Browser:
    """Return the running Chromium."""
    assert profile.browser is not None
    return profile.browser


@pytest.fixture(scope="session")
def profile(tmp_path_factory: pytest.TempPathFactory) -> Iterator[BrowserContext]:
    """Yield the context of an on-disk profile in a separate Chromium, which caches compiled scripts.

    A context without a profile compiles four megabytes of scripts for every page, a third of its processor time.
    """
    with sync_playwright() as playwright:
        context = launch_with_profile(playwright, tmp_path_factory.mktemp("profile"), **USUAL)
        context.set_default_timeout(60_000)
        yield context
        context.close()


@pytest.fixture(scope="session")
def prepared(profile: BrowserContext, address: str) -> str:
    """Return the address once the first scene's curve and names are cached; a page that is closed earlier drops them.

    A small page of the server stays open, and with it the process that renders all pages of the profile, so that each
    new page finds its scripts compiled.
    """
    profile.pages[0].goto(address + "liveness")
    page = profile.new_page()
    page.goto(address)
    page.wait_for_selector(".peak-names button", timeout=COMPILED)
    page.close()
    return address


class Pages:
    """Pages of the dashboard, with their errors and warnings."""

    def __init__(self, profile: BrowserContext, url: str) -> None:
        self.complaints: list[str] = []
        self._profile, self._url = profile, url
        self._opened: list[Page | BrowserContext] = []

    def open(self, query: str = "", url: str = "", script: str = "", **options: Any) -> Page:
        """Open a page and wait until it shows a picture."""
        url = url or self._url
        of_the_page = {name: options.pop(name) for name in ("viewport", *MEDIA) if name in options}
        if options:
            assert self._profile.browser is not None
            context = self._profile.browser.new_context(**{**USUAL, **of_the_page, **options})
            context.set_default_timeout(60_000)
            page = context.new_page()
            self._opened.append(context)
            begin = ""
        else:
            page, begin = self._profile.new_page(), NOTHING_KEPT
            self._opened.append(page)
            page.set_viewport_size(of_the_page.pop("viewport", USUAL["viewport"]))
            page.emulate_media(**of_the_page)
        look_seldom(page)
        page.on("console", lambda message: (message.type == "error" or "initial ranges" in message.text)
                and self.complaints.append(message.text))  # the latter: a figure that was drawn before it had points
        page.on("pageerror", lambda error: self.complaints.append(str(error)))
        page.on("request", lambda request: request.url.startswith((url, "data:", "blob:"))
                or self.complaints.append(f"asked another host: {request.url}"))
        page.add_init_script(begin + RUNTIME + FIGURES + script)
        page.goto(url + query)
        page.wait_for_function("window.painted.length > 0", timeout=180_000)
        return page

    def close(self) -> None:
        """Close all pages."""
        while self._opened:
            self._opened.pop().close()


@pytest.fixture
def visit(profile: BrowserContext, prepared: str, log: Path, request: pytest.FixtureRequest) -> Iterator[Callable[..., Page]]:
    """Yield a function that opens the dashboard. At the end, no page may have logged errors or contacted another host.

    The browser is set to reduced motion, so that pages start paused and leave the processor to the tests;
    `reduced_motion="no-preference"` opens one that plays. A page is in the browser's profile, where nothing remains of
    earlier pages; only a page with context options has its own context.
    """
    pages = Pages(profile, prepared)

    def open_page(query: str = "", **options: Any) -> Page:
        page = pages.open(query, **options)
        watch(request.node, page, log)
        return page

    yield open_page
    pages.close()
    assert pages.complaints == []


@pytest.fixture(scope="module")
def shared(profile: BrowserContext, prepared: str) -> Iterator[Callable[..., Page]]:
    """Yield a function that opens a page for several tests of a file, which each check one fact and change nothing.

    A test `watch`es the page (evidence.py). At the end of the file, none of these pages may have logged errors.
    """
    pages = Pages(profile, prepared)
    yield pages.open
    pages.close()
    assert pages.complaints == []


@pytest.fixture(scope="module")
def kept(profile: BrowserContext, prepared: str) -> Iterator[tuple[Pages, list[Page]]]:
    """Yield the pages of a file, and a list with the page that `at` navigates, once there is one."""
    pages = Pages(profile, prepared)
    yield pages, []
    pages.close()


@pytest.fixture
def at(kept: tuple[Pages, list[Page]], log: Path, request: pytest.FixtureRequest) -> Iterator[Callable[..., Page]]:
    """Yield a function that navigates a page to an address, for tests that do not depend on the way. No errors either.

    All tests of a file share a page, which is navigated like a step of the browser's history, because opening one takes
    two seconds of processor time. The address has scene, knobs, curves, scale, pins, look, tab, page and story; a test
    must undo any other change. After a failed test, a new page is opened.
    """
    pages, pair = kept

    def move(query: str = "?v=1&scene=sec2", viewport: ViewportSize = USUAL["viewport"]) -> Page:
        if not pair:
            pair.append(pages.open(query, viewport=viewport))
            watch(request.node, pair[0], log)
            return pair[0]
        (page,) = pair
        watch(request.node, page, log)
        page.set_viewport_size(viewport)
        page.mouse.move(0, 0)
        page.evaluate(MOVE, query)
        page.wait_for_function("!granchain.steps.returning && location.search.includes(`scene=${granchain.shown.scene}`)")
        return page

    yield move
    if request.node.stash.get(FAILED, False):
        pages.close()
        pair.clear()
    complaints = list(pages.complaints)
    pages.complaints.clear()
    assert complaints == []


# Like a step back: the page goes to the address.
MOVE = """(query) => {
  window.sent = [];
  history.pushState({ at: granchain.steps.at }, "", query);
  dispatchEvent(new PopStateEvent("popstate", { state: history.state }));
}"""

# Runs once in a page, before its own scripts.
NOTHING_KEPT = """
try {
  if (!sessionStorage.getItem("granchain-test")) localStorage.clear();
  sessionStorage.setItem("granchain-test", "begun");
} catch { /* about:blank keeps nothing */ }
"""

RUNTIME = """
// Only the tests of the tour are a first visit.
try { localStorage.setItem("granchain-toured", "yes"); } catch { /* about:blank keeps nothing */ }
window.painted = [];
document.addEventListener("DOMContentLoaded", () => {
  if (window.granchain) granchain.on("painted", (event) => window.painted.push(event));
});
// The messages that the page has sent (their "do", name and value), so that a test can check that something was not requested.
window.sent = [];
// Resolves when the last drawing is on the screen.
window.shown = () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(true))));
window.canvasIn = (id) => {
  const find = (node) => {
    for (const element of node.querySelectorAll("*")) {
      if (element.tagName === "CANVAS") return element;
      const inner = element.shadowRoot && find(element.shadowRoot);
      if (inner) return inner;
    }
    return null;
  };
  return find(document.getElementById(id));
};
window.pixels = (id) => {
  const canvas = canvasIn(id);
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  let sum = 0;
  for (let i = 0; i < data.length; i += 7) sum = (sum * 31 + data[i]) >>> 0;
  return sum;
};
// A stand-in for a visitor's own script: forges the value in the next message of a knob.
const send = WebSocket.prototype.send;
WebSocket.prototype.send = function (data) {
  if (typeof data === "string")
    for (const [, ...words] of data.matchAll(/\\["do","([\\w-]+)"\\](?:,\\["name","([^"]*)"\\])?(?:,\\["value",([^\\]]*)\\])?/g))
      window.sent.push(words.filter((word) => word !== undefined).join(" "));
  if (window.forged !== undefined && typeof data === "string" && data.includes('["do","set"]'))
    data = data.replace(/\\["value",[^\\]]*\\]/, `["value",${window.forged}]`);
  send.call(this, data);
};
"""
