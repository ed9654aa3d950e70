"""Functions of the page's scripts without the page: tables of values, steps of the history, a lost connection.

The modules are served unchanged from `app` to an otherwise empty page, without a server, and the test controls the
clock.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import BrowserContext, Page, Route, expect
from server import until

from app.format import prefixed
from app.frames import chain_series, drawn_values
from app.scripts import FILES, INLINE_SCRIPTS
from app.session.page_constants import page_constants

APP = Path(__file__).parents[2] / "app"
ORIGIN = "http://scripts.test/"
#: The elements that the inline scripts look up, and a minimal Bokeh.
BLANK = """<!doctype html><div id="dashboard">
  <div id="lost" hidden></div><div id="bar"></div><div id="side"></div><div id="stage"></div><div id="curves"><div id="curve"></div></div>
  <div id="overlay"><div data-overlay="probe" hidden></div></div><div id="foot"></div></div>
<script>window.Bokeh = { documents: [{ on_event: (name, act) => { window.closeSocket = act; } }] };</script>"""


class Answers:
    """The answers at the address of the scripts: modules, the blank page, and `readiness` for whether there is room."""

    readiness = 502
    reason = ""

    def __init__(self) -> None:
        self.opened: list[str] = []
        self.asked = 0

    def __call__(self, route: Route) -> None:
        """Answer a request."""
        path = route.request.url.removeprefix(ORIGIN).partition("?")[0]
        if path == "readiness":
            self.asked += 1
            route.fulfill(status=self.readiness, body=self.reason)
        elif path.endswith(".js"):
            route.fulfill(path=APP / path, content_type="text/javascript")
        else:
            self.opened.append(route.request.url)
            inline = "".join(FILES[name].read_text(encoding="utf-8") for name in INLINE_SCRIPTS)
            scripts = f"window.pageConstants = {page_constants()};" + inline
            route.fulfill(body=f"{BLANK}<script>{scripts}</script>", content_type="text/html")


@pytest.fixture(scope="module")
def blank(profile: BrowserContext) -> Iterator[Page]:
    """Yield a page for the modules."""
    page = profile.new_page()
    page.route(f"{ORIGIN}**", Answers())
    page.goto(ORIGIN)
    yield page
    page.close()


def called(page: Page, script: str, name: str, cases: list[Any]) -> list[Any]:
    """Call a function of a module with each list of arguments, and return the results."""
    return list(page.evaluate("""async ([script, name, cases]) => {
      const module = await import(`/${script}`);
      return cases.map((one) => module[name](...one));
    }""", [script, name, cases]))


@pytest.mark.parametrize(("scale", "low", "high", "middle"), [
    ("linear", 10.0, 30.0, 20.0), ("log", 1.0, 100.0, 10.0), ("cubic", 0.0, 8.0, 1.0)])
def test_a_slider_goes_from_place_to_value_and_back(blank: Page, scale: str, low: float, high: float, middle: float) -> None:
    values, places = blank.evaluate("""async ([scale, low, high]) => {
      const { RANGE } = await import("/parts/knobs/knob.js");
      const values = [0, 0.25, 0.5, 0.75, 1].map((place) => RANGE[scale].value(place, { low, high }));
      return [values, values.map((value) => RANGE[scale].place(value, { low, high }))];
    }""", [scale, low, high])
    assert places == pytest.approx([0.0, 0.25, 0.5, 0.75, 1.0])
    assert (values[0], values[2], values[-1]) == pytest.approx((low, middle, high))


#: A value in SI units, the factor of its unit, and the text of the field.
WRITTEN = [(340.0, 1.0, "340"), (0.0, 1.0, "0"), (5e-7, 1e-6, "0.5"), (1.23456789, 1.0, "1.23457"), (1e-4, 1.0, "1e-4"),
           (-2.5e-4, 1.0, "-2.5e-4"), (1234567.0, 1.0, "1.23457e6"), (193e9, 1e9, "193"), (0.1 + 0.2, 1.0, "0.3"),
           (999999.0, 1.0, "999999")]


def test_a_number_in_a_knobs_field_has_six_figures(blank: Page) -> None:
    assert called(blank, "parts/knobs/knob.js", "written", [case[:2] for case in WRITTEN]) == [case[2] for case in WRITTEN]
    assert called(blank, "parts/knobs/knob.js", "rounded", [[340.123], [0.00123456], [99999]]) == [340.1, 0.001235, 100000]


def test_ticks_are_round_and_inside(blank: Page) -> None:
    script = "parts/toolkit/round_numbers.js"
    assert called(blank, script, "ticks", [[0, 10, 5], [-1, 1, 4], [0.13, 0.47, 3], [0, 1e-9, 2], [20, 160, 5]]) == [
        [0, 2, 4, 6, 8, 10], [-1, -0.5, 0, 0.5, 1], [0.2, 0.4], [0, 5e-10, 1e-9], [50, 100, 150]]
    below = called(blank, script, "stepBelow", [[1], [7], [0.03], [9.99], [10], [450]])
    assert below == pytest.approx([1, 5, 0.02, 5, 10, 200])


def test_the_browser_takes_the_prefixes_that_the_server_takes(blank: Page) -> None:
    values = [0.0, 1e-19, 999.4e-18, 999.6e-9, 1e-6, 0.001, 0.9994, 0.9996, 1.0, 999.4, 999.6, 1e3, 4.2e6, 1e9, 1e12]
    found = called(blank, "parts/toolkit/round_numbers.js", "prefixed", [[value] for value in values])
    assert [letter for _, letter in found] == [prefixed(value)[1] for value in values]
    assert [factor for factor, _ in found] == pytest.approx([prefixed(value)[0] for value in values], rel=1e-12, abs=0.0)


def test_a_place_of_the_map_is_the_finest_cell_that_covers_it(blank: Page) -> None:
    """A map of 4 × 3 has the first cell of spacing 4, one of spacing 2 and one of spacing 1."""
    found = blank.evaluate("""async () => {
      const { MAP, cellAt, finest, valuesOf } = await import("/pages/map/map_state.js");
      const none = cellAt(0, 0, (MAP.head = { x: [10, 20, 30, 40], y: [1, 2, 3] }));
      MAP.cells.rows = { cells: { number: [0, 2, 5], spacing: [4, 2, 1] } };
      return [none, [[0, 0], [1, 1], [1, 3], [2, 3], [0, 3]].map(([i, j]) => cellAt(i, j)), finest([0, 1, 2]), valuesOf(2)];
    }""")
    assert found == [-1, [0, 2, 1, 0, 1], 2, {"x": 20, "y": 2}]


@pytest.fixture
def answers() -> Answers:
    """The answers that the inline scripts get from their address."""
    return Answers()


@pytest.fixture
def page(profile: BrowserContext, answers: Answers) -> Iterator[Page]:
    """A page with the inline scripts at an address; the test advances the clock, and the server has sent a link."""
    page = profile.new_page()
    page.route(f"{ORIGIN}**", answers)
    page.clock.install()
    page.goto(f"{ORIGIN}?v=1&scene=sec2")
    page.evaluate("""() => {
      granchain.knobNames = ["f", "k", "kappa"];
      window.gone = [];
      granchain.go = (query) => gone.push(query);
      granchain.address.linkReceived("v=1&scene=sec2", [], ["mode", "scale"]);
    }""")
    page.clock.run_for(500)
    yield page
    page.close()


def query(page: Page, expression: str = "granchain.address.url().search") -> str:
    """Return the current query of the address."""
    return str(page.evaluate(expression)).removeprefix("?")


def test_requests_are_in_the_address_until_the_server_has_answered_them(page: Page) -> None:
    page.evaluate("granchain.address.requested('f', 615)")
    assert query(page) == "v=1&scene=sec2&f=615"
    page.evaluate("granchain.address.requested('kappa', 0.001); granchain.address.requested('k', 5)")
    assert query(page) == "v=1&scene=sec2&f=615&k=5", "k and kappa are one knob"
    page.evaluate("granchain.address.linkReceived('v=1&scene=sec2&f=615&k=5&scale=fit', ['f', 'k', 'kappa'])")
    page.evaluate("granchain.address.requested('scene', 'rig')")
    assert query(page) == "v=1&scale=fit&scene=rig", "a scene takes no knobs of the one before"


def test_a_picture_is_settled_when_it_is_final_and_of_the_knobs_that_were_asked_for(page: Page) -> None:
    shown = "granchain.shown = { knobs: 'v=1&scene=sec2&f=615', final: true }"
    assert not page.evaluate("granchain.address.isSettled()")
    page.evaluate("granchain.address.requested('f', 615)")
    assert not page.evaluate(f"{shown}; granchain.address.isSettled()"), "the server has not answered"
    page.evaluate("granchain.address.linkReceived('v=1&scene=sec2&f=615&scale=fit', ['f'])")
    assert page.evaluate("granchain.address.isSettled()")
    assert not page.evaluate("granchain.shown.final = false; granchain.address.isSettled()")


def test_a_change_followed_by_a_rest_is_a_step_and_a_refined_link_is_none(page: Page) -> None:
    for link in ("f=615", "f=616"):
        page.evaluate("link => granchain.address.linkReceived(`v=1&scene=sec2&${link}`, [])", link)
        page.clock.run_for(200)
    assert query(page, "location.search") == "v=1&scene=sec2"
    page.clock.run_for(300)
    assert query(page, "location.search") == "v=1&scene=sec2&f=616" and page.evaluate("granchain.steps.at") == 1
    page.evaluate("granchain.address.linkRefined('v=1&scene=sec2&f=616&from=here')")
    page.evaluate("granchain.address.setPlace({ tab: 'probe' })")
    page.evaluate("granchain.address.setPlace({ tab: '' })")
    page.clock.run_for(500)
    assert page.evaluate("[granchain.steps.at, history.state.at]") == [2, 2]
    page.evaluate("granchain.address.linkRefined('v=1&scene=sec2&f=616&from=there')")
    page.clock.run_for(500)
    assert query(page, "location.search").endswith("from=there") and page.evaluate("granchain.steps.at") == 2


def test_undo_and_redo_go_to_the_server_and_wait_for_its_answer(page: Page) -> None:
    page.evaluate("granchain.on('steps', (one) => { window.told = one; })")
    for number in (1, 2):
        page.evaluate("number => granchain.address.linkReceived(`v=1&scene=sec2&f=${number}`, [])", number)
        page.clock.run_for(500)
    assert page.evaluate("told") == {"back": True, "forward": False}
    page.evaluate("granchain.steps.undo()")
    until(page, lambda: page.evaluate("gone") == ["v=1&scene=sec2&f=1"])
    assert page.evaluate("[told, granchain.steps.returning]") == [{"back": True, "forward": True}, True]
    page.evaluate("granchain.address.applied('v=1&scene=sec2&f=1')")
    assert not page.evaluate("granchain.steps.returning")
    page.evaluate("granchain.steps.redo()")
    until(page, lambda: len(page.evaluate("gone")) == 2)
    assert page.evaluate("granchain.steps.at") == 2
    page.evaluate("granchain.address.applied('v=1&scene=sec2&f=2'); granchain.steps.redo()")
    assert page.evaluate("[granchain.steps.at, granchain.steps.newest]") == [2, 2], "there is nothing ahead"


def test_an_event_that_is_not_declared_is_an_error(page: Page) -> None:
    """Otherwise, events with misspelt names would be silently ignored."""
    for call in ("on('step', () => {})", "emit('step')"):
        said = page.evaluate(f"() => {{ try {{ granchain.{call}; }} catch (error) {{ return error.message; }} }}")
        assert said == "there is no event step"
    assert page.evaluate("granchain.on('page:map', (data) => { window.heard = data; }); granchain.publish('map', 3); heard") == 3


def test_state_kept_before_a_reload_is_restored_once(page: Page) -> None:
    page.evaluate("sessionStorage.setItem('granchain-resume', JSON.stringify({ playing: false }))")
    page.reload()
    taken = page.evaluate("[granchain.connection.resumeState, granchain.connection.takeResumeState(),"
                          " granchain.connection.takeResumeState()]")
    assert taken == [{"playing": False}, {"playing": False}, None] and page.evaluate("granchain.connection.resumeState") is None


def test_a_silent_server_is_asked_counted_as_lost_and_taken_back(page: Page) -> None:
    page.evaluate("window.pings = 0; granchain.connection.connect(() => { pings += 1; })")
    page.clock.run_for(700)
    assert page.evaluate("pings") == 1, "one ping is unanswered, and no other follows"
    page.clock.run_for(1000)
    assert not page.evaluate("granchain.connection.lost")
    page.clock.run_for(500)
    assert page.evaluate("[granchain.connection.lost, stage.inert, lost.hidden, lost.textContent.slice(0, 15)]") == [
        True, True, False, "Connection lost"]
    page.evaluate("granchain.connection.answerReceived()")
    assert page.evaluate("[granchain.connection.lost, stage.inert, lost.hidden]") == [False, False, True]
    for _ in range(4):
        page.clock.run_for(700)
        page.evaluate("granchain.connection.answerReceived()")
    assert not page.evaluate("granchain.connection.lost") and page.evaluate("pings") == 5


def test_a_hidden_window_asks_nothing_and_a_closed_socket_is_lost_at_once(page: Page) -> None:
    page.evaluate("""() => {
      window.pings = 0;
      granchain.connection.connect(() => { pings += 1; });
      Object.defineProperty(document, "hidden", { configurable: true, get: () => true });
    }""")
    page.clock.run_for(3000)
    assert page.evaluate("[pings, granchain.connection.lost]") == [0, False]
    page.evaluate("closeSocket()")
    assert page.evaluate("granchain.connection.lost")


@pytest.mark.parametrize("status", [502, 503])
def test_a_page_asks_ever_more_rarely_and_opens_nothing_while_there_is_no_room(status: int, page: Page, answers: Answers) -> None:
    """Otherwise, all pages of a restarted server would arrive at once, and those beyond its limit would be lost."""
    answers.readiness = status
    page.evaluate("() => { granchain.connection.connect(() => {}); closeSocket(); }")
    for _ in range(60):
        page.clock.run_for(500)
    assert 3 <= answers.asked <= 20, "in 30 s; every 0.4 s it would be 75 times"
    assert len(answers.opened) == 1 and page.evaluate("granchain.connection.lost")
    answers.readiness = 200
    until(page, lambda: page.clock.run_for(500) is None and len(answers.opened) == 2)


def test_a_full_server_is_not_called_a_lost_connection(page: Page, answers: Answers) -> None:
    answers.readiness = 503
    page.evaluate("() => { granchain.connection.connect(() => {}); closeSocket(); }")
    banner = page.locator("#lost")
    until(page, lambda: page.clock.run_for(500) is None and answers.asked > 0)
    expect(banner).to_contain_text("Connection lost")  # a proxy may answer 503 as well
    answers.reason = '{"/readiness": false, "reason": "all 200 places for sessions are taken"}'
    until(page, lambda: page.clock.run_for(500) is None and "The server is full" in banner.inner_text())
    answers.readiness, answers.reason = 502, ""
    until(page, lambda: page.clock.run_for(500) is None and "Connection lost" in banner.inner_text())


def test_pictures_without_room_in_the_storage_cost_nothing_else(page: Page, answers: Answers) -> None:
    page.evaluate("""() => {
      granchain.connection.connect(() => {});
      granchain.connection.carryOver({ playing: false, uploaded: true });
      HTMLCanvasElement.prototype.toDataURL = () => "x".repeat(20e6);
      closeSocket();
    }""")
    answers.readiness = 200
    until(page, lambda: page.clock.run_for(500) is None and len(answers.opened) == 2)
    until(page, lambda: page.evaluate("Boolean(window.granchain?.connection?.resumeState)"))
    state = page.evaluate("granchain.connection.resumeState")
    assert (state["playing"], state["uploaded"], "snapshot" in state) == (False, True, False)


def test_a_page_that_lost_its_server_opens_its_own_link_when_that_answers_again(page: Page, answers: Answers) -> None:
    page.evaluate("""() => {
      granchain.connection.connect(() => {});
      granchain.address.linkReceived("v=1&scene=sec2&f=616", []);
      granchain.connection.carryOver({ playing: false });
      closeSocket();
    }""")
    page.clock.run_for(1000)
    assert len(answers.opened) == 1, "it does not answer yet"
    answers.readiness = 200
    until(page, lambda: page.clock.run_for(500) is None and len(answers.opened) == 2)
    assert answers.opened[-1] == f"{ORIGIN}?v=1&scene=sec2&f=616"
    until(page, lambda: page.evaluate("window.granchain?.connection?.resumeState?.playing") is False)
    assert page.evaluate("[lost.hidden, lost.textContent.slice(0, 15), Boolean(document.getElementById('last-pictures'))]") == [
        False, "Connected again", True]


def test_errors_of_scripts_are_reported_and_no_more_than_a_few(blank: Page) -> None:
    reported = blank.evaluate("""async () => {
      const { watchScriptErrors } = await import("/parts/header/script_errors.js");
      const reported = [];
      watchScriptErrors((words) => reported.push(words));
      dispatchEvent(new ErrorEvent("error", { message: "ResizeObserver loop completed with undelivered notifications." }));
      dispatchEvent(new ErrorEvent("error", { message: "x is null", filename: "http://a.test/b/chain.js?v=1", lineno: 7 }));
      const rejected = new Promise((done) => addEventListener("unhandledrejection", done, { once: true }));
      Promise.reject(new Error("y".repeat(1000)));
      await rejected;
      for (let i = 0; i < 10; i++) dispatchEvent(new ErrorEvent("error", { message: "again" }));
      return reported;
    }""")
    assert reported[0] == "x is null (chain.js:7)"
    assert reported[1].startswith("unhandled rejection: Error: yyy") and len(reported[1]) == 400
    assert len(reported) == 5


def test_the_chain_is_unpacked_in_the_order_in_which_it_was_packed(blank: Page) -> None:
    """`chain_series` in app/frames.py and `unpack` in chain_series.js use the same order."""
    rows, beads = 3, 2
    widths = {"displacement": beads, "force": beads + 1, "energy": beads, "drive": 1}
    arrays = {name: 100.0 * number + np.arange(rows * width).reshape(rows, width)
              for number, (name, width) in enumerate(widths.items())}
    values = drawn_values(chain_series(*arrays.values()))
    found = blank.evaluate("""async ([rows, beads, list]) => {
      const { unpack } = await import("/parts/chain/chain_series.js");
      const { series, end } = unpack({ rows, beads, values: new Float32Array([-1, ...list]) }, 1);
      return [Object.entries(series).map(([name, values]) => [name, [...values]]), end];
    }""", [rows, beads, values.tolist()])
    assert found == [[[name, array.ravel().tolist()] for name, array in arrays.items()], 1 + len(values)]
