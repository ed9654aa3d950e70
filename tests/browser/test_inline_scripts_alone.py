"""The inline scripts without the page: its address, steps of the history, events, a lost connection.

The test controls the clock.
"""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from empty_page import ORIGIN, Answers
from playwright.sync_api import BrowserContext, Page, expect
from server import until


@pytest.fixture
def answers() -> Answers:
    """The answers that the inline scripts get from their address."""
    return Answers()


@pytest.fixture(scope="module")
def origin(profile: BrowserContext) -> Iterator[None]:
    """Keep a page open at the address, and with it the process that renders all pages there.

    Without it, the process ends with the page of each test, and calls to the next page may then never return.
    """
    page = profile.new_page()
    page.route(f"{ORIGIN}**", Answers())
    page.goto(ORIGIN)
    yield
    page.close()


@pytest.fixture
def page(profile: BrowserContext, answers: Answers, origin: None) -> Iterator[Page]:
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
