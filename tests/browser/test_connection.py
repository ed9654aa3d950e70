"""A page that has lost its server says so at once, blocks its knobs, and is rebuilt from its knobs."""

from __future__ import annotations

import re
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from http.client import HTTPConnection
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from bokeh_figures import FIGURES
from evidence import watch
from knobs import COMPILED, field, knob, play_button, type_into
from playwright.sync_api import Browser, Page, Route, expect
from server import Server


@contextmanager
def running(folder: Path) -> Iterator[Server]:
    """Yield a dashboard that runs until the block ends or it is killed."""
    server = Server(folder / "log")
    server.start()
    try:
        yield server
    finally:
        server.kill()


@contextmanager
def opened(chromium: Browser, server: Server, node: pytest.Item) -> Iterator[Page]:
    """Yield its page, paused at 1130 Hz with another damping, with its pictures drawn."""
    context = chromium.new_context(viewport={"width": 1280, "height": 800})
    context.set_default_timeout(60_000)
    page = context.new_page()
    watch(node, page, server.log)
    page.add_init_script(FIRST + FIGURES)
    page.goto(f"{server.address}?v=1&scene=sec2&f=1130&D=90&start=previous")
    expect(page.locator("#lost")).to_be_hidden()
    page.wait_for_function(BELONGS, arg=1130, timeout=COMPILED)
    yield page
    context.close()


@pytest.fixture(scope="module")
def living(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """A dashboard for several tests, none of which kills it: if one stops it, it is resumed."""
    with running(tmp_path_factory.mktemp("living")) as one:
        yield one


@pytest.fixture
def page(chromium: Browser, living: Server, request: pytest.FixtureRequest) -> Iterator[Page]:
    """A page of the dashboard that keeps running."""
    with opened(chromium, living, request.node) as one:
        yield one


# The contents of a rebuilt page before it has its own pictures.
FIRST = """addEventListener("DOMContentLoaded", () => setTimeout(() => {
  const image = document.getElementById("last-pictures");
  const rest = image && [getComputedStyle(image).filter, document.getElementById("lost").textContent];
  window.first = image && image.decode().then(() => [image.naturalWidth, ...rest]);
}));"""


# Whether the pictures show whole drive periods of a frequency [Hz]; they share one time axis, in ms.
BELONGS = """(frequency) => {
  for (const model of figures.models()) {
    if (model.type !== "Plot" || model.y_range?.start === 1 || !(model.y_range?.start > model.y_range?.end)) continue;
    const periods = model.y_range.start * 1e-3 * frequency;
    return periods > 0.5 && Math.abs(periods - Math.round(periods)) < 1e-3;
  }
  return false;
}"""


def value(page: Page, name: str = "f") -> str:
    return knob(page, name)


def looks_lost(page: Page) -> None:
    """Check for a sentence, grey pictures, and disabled knobs and buttons.

    A silent server is noticed after `PING_TIMEOUT` of connection.js, counted while the page itself is running.
    """
    page.wait_for_selector("#dashboard.lost")
    expect(page.get_by_role("alert").filter(has_text="Connection lost – trying again")).to_be_visible()
    for part in ("stage", "curves"):
        assert "grayscale(1)" in page.evaluate(f"getComputedStyle(document.getElementById('{part}')).filter")
    assert page.locator("[data-knob] input:enabled, [data-knob] select:enabled").count() == 0
    assert page.evaluate("['bar', 'side', 'stage', 'curves', 'foot'].every((id) => document.getElementById(id).inert)")


def starts_again(server: Server, page: Page) -> None:
    """Start the server on its old port; the page reopens itself without help."""
    page.evaluate("window.before = true")
    server.start()
    page.wait_for_function("window.granchain && !window.before")


def drag_slider(page: Page) -> None:
    """Drag the slider of f with the mouse, whether or not it is disabled."""
    box = page.locator('[data-knob="f"] input[type="range"]').bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + 0.6 * box["width"], box["y"] + box["height"] / 2)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.2 * box["width"], box["y"] + box["height"] / 2)
    page.mouse.up()


@dataclass(frozen=True)
class Restarted:
    """A page whose server was killed and restarted, and the knob f after an attempt to move it meanwhile."""

    page: Page
    moved_while_lost: str


@pytest.fixture(scope="module")
def restarted(chromium: Browser, tmp_path_factory: pytest.TempPathFactory, request: pytest.FixtureRequest) -> Iterator[Restarted]:
    """A page at 700 Hz, paused, with another speed and uploaded data, which has its pictures again after a restart."""
    with running(tmp_path_factory.mktemp("restarted")) as server, opened(chromium, server, request.node) as page:
        type_into(page, "f", "700")
        page.wait_for_function(BELONGS, arg=700)
        play_button(page).click()
        page.get_by_role("button", name="More controls").click()
        page.locator("select.speed").select_option("5")
        page.get_by_role("tab", name="data").click()
        data = b"frequency_Hz,force_N\n40,5.5\n60,12.1\n"
        page.locator('input[type="file"]').set_input_files({"name": "mine.csv", "mimeType": "text/csv", "buffer": data})
        page.wait_for_function("!granchain.connection.carried.playing && granchain.connection.carried.uploaded")
        page.wait_for_function("granchain.address.url().search.includes('speed=5')")
        server.kill()
        looks_lost(page)
        drag_slider(page)
        page.keyboard.press("ArrowRight")
        moved = value(page)
        starts_again(server, page)
        page.wait_for_function(BELONGS, arg=700)
        yield Restarted(page, moved)


def test_no_knob_moves_while_the_server_is_gone(restarted: Restarted) -> None:
    assert restarted.moved_while_lost == "700"


def test_the_last_pictures_stand_grey_until_there_are_new_ones(restarted: Restarted) -> None:
    width, look, sentence = restarted.page.evaluate("window.first")
    assert (width, "grayscale(1)" in look, "restoring your settings" in sentence) == (1280, True, True)
    expect(restarted.page.locator("#last-pictures")).to_have_count(0)


def test_knobs_start_and_speed_are_restored(restarted: Restarted) -> None:
    page = restarted.page
    assert (value(page), value(page, "D")) == ("700", "90")
    expect(page.locator("select.start")).to_have_value("previous")
    expect(page.locator("select.speed")).to_have_value("5")


def test_a_paused_motion_stays_paused(restarted: Restarted) -> None:
    expect(play_button(restarted.page)).to_contain_text("play")


def test_a_sentence_says_that_uploaded_data_are_gone(restarted: Restarted) -> None:
    words = "Your settings are restored, but your uploaded data are gone."
    expect(restarted.page.get_by_role("alert").filter(has_text=words)).to_be_visible()
    expect(restarted.page.locator("#lost")).to_be_hidden()


def test_the_page_goes_on_after_the_restart(restarted: Restarted) -> None:
    for frequency in (340, 700):
        type_into(restarted.page, "f", str(frequency))
        restarted.page.wait_for_function(BELONGS, arg=frequency)


def test_a_page_whose_server_was_silent_goes_on(living: Server, page: Page) -> None:
    page.evaluate("window.same = true")
    living.process.send_signal(signal.SIGSTOP)
    try:
        looks_lost(page)
        drag_slider(page)
    finally:
        living.process.send_signal(signal.SIGCONT)
    expect(page.locator("#lost")).to_be_hidden()
    assert page.locator("[data-knob] input:disabled").count() == 0 and value(page) == "1130"
    type_into(page, "f", "700")
    page.wait_for_function(BELONGS, arg=700)
    assert page.evaluate("window.same")


def test_a_silent_socket_is_given_up_while_the_server_answers(page: Page) -> None:
    """This happens behind a proxy that forgot the socket: neither side learns that it is closed."""
    page.evaluate("window.before = true")
    page.evaluate("granchain.connection.answerReceived = () => {}")
    looks_lost(page)
    page.wait_for_function("window.granchain && !window.before")
    page.wait_for_function(BELONGS, arg=1130)
    assert (value(page), value(page, "D")) == ("1130", "90")


def test_knobs_moved_while_the_server_is_silent_are_restored(chromium: Browser, tmp_path: Path, request: pytest.FixtureRequest) -> None:
    """The knobs have the values that the visitor saw last, not those that the server received last."""
    moved = {"f": "700", "kappa": "0.002"}
    with running(tmp_path) as server, opened(chromium, server, request.node) as page:
        type_into(page, "k", "100")
        expect(page.locator("#knobs .aside")).to_contain_text("Hz")
        server.process.send_signal(signal.SIGSTOP)
        for name, typed in moved.items():
            type_into(page, name, typed)
        looks_lost(page)
        assert {name: value(page, name) for name in moved} == moved
        server.kill()
        starts_again(server, page)
        for name, typed in moved.items():
            expect(field(page, name)).to_have_value(typed)
        page.wait_for_function(BELONGS, arg=float(value(page)))


def test_a_page_dropped_before_it_connects_reloads(chromium: Browser, living: Server,
                                                                      request: pytest.FixtureRequest) -> None:
    """Its token is used up here, so its websocket is refused like that of a page that made room for a newer one."""
    context = chromium.new_context(viewport={"width": 1280, "height": 800})
    page = context.new_page()
    watch(request.node, page, living.log)
    place, used = urlsplit(living.address), list[HTTPConnection]()

    def use_token(route: Route) -> None:
        if used:
            route.continue_()
            return
        answer = route.fetch()
        found = re.search(r'"token":"([^"]+)"', answer.text())
        assert found is not None
        used.append(HTTPConnection(str(place.hostname), place.port))
        used[0].request("GET", "/ws", headers={
            "Upgrade": "websocket", "Connection": "Upgrade", "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==",
            "Sec-WebSocket-Version": "13", "Sec-WebSocket-Protocol": f"bokeh, {found[1]}", "Origin": f"http://{place.netloc}"})
        assert used[0].getresponse().status == 101
        route.fulfill(response=answer)

    page.route(lambda address: urlsplit(address).path == "/", use_token)
    page.add_init_script(FIRST + FIGURES)
    page.goto(f"{living.address}?v=1&scene=sec2&f=1130&D=90&start=previous")
    page.wait_for_function(BELONGS, arg=1130, timeout=COMPILED)
    assert len(used) == 1 and (value(page), value(page, "D")) == ("1130", "90")
    expect(page.locator("#lost")).to_be_hidden()
    used[0].close()
    context.close()
