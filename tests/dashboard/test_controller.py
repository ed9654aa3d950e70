"""Messages that a browser may send and the answers to them, without a browser."""

from __future__ import annotations

import base64
import threading
from functools import partial
from typing import Any

import pytest
from bokeh.events import Tap
from headless_dashboard import Dashboard

from app.dashboard.table import PAGES, watched_pages
from app.pages.data import page as data_page
from app.serve.compiling.compiler import COMPILER
from app.serve.http.limits import LARGEST_UPLOAD
from app.session.initial_state import MOST_BEADS_IN_LINK
from app.session.page import all_actions


@pytest.mark.parametrize(("message", "sentence"), [
    ({"do": "branches-start", "period": True}, "period of a branch 'True' is not a whole number"),
    ({"do": "branches-start", "period": 9}, "period of a branch '9' is not a whole number"),
    ({"do": "branches-orbit", "arm": False, "place": 0}, "That branch is no longer on the page"),
    ({"do": "branches-double", "place": True}, "That special point is no longer on the page"),
    ({"do": "map-load", "number": True}, "That attractor is no longer on the page"),
    ({"do": "stability-section", "bead": True, "phase": 0}, "bead 'True' is not a whole number")])
def test_a_value_that_is_no_number_gets_a_sentence(dashboard: Dashboard, message: dict[str, Any], sentence: str) -> None:
    dashboard.received(message)
    assert sentence in dashboard.session.sentence


def test_a_click_on_the_curve_without_a_frequency_gets_the_knobs_sentence(dashboard: Dashboard) -> None:
    dashboard.views.curve.figure._trigger_event(Tap(dashboard.views.curve.figure, x=None, y=None))
    assert dashboard.session.sentence.startswith("drive frequency f must be a number")
    assert dashboard.session.scene.f == 340.0


@pytest.mark.parametrize(("text", "sentence", "understood"), [
    ("frequency_Hz,force_N\n40,5.5\n60,12.1\n", "", "mine.csv: 2 points"),
    ("frequency_Hz,force_N\n40,five\n", "Line 2", ""), ("4" * (LARGEST_UPLOAD + 1), "larger than 2 MB", "")])
def test_a_measurement_is_read_in_the_background(dashboard: Dashboard, text: str, sentence: str, understood: str,
                                                 monkeypatch: pytest.MonkeyPatch) -> None:
    """Reading 2 MB with the document locked would delay every visitor."""
    threads = []
    read = data_page.read_data
    monkeypatch.setattr(data_page, "read_data",
                        lambda *given, **named: (threads.append(threading.current_thread().name), read(*given, **named))[1])
    dashboard.received({"do": "measurement", "name": "mine.csv", "content": base64.b64encode(text.encode()).decode()})
    assert not dashboard.views.tabs.state.get("understood")
    dashboard.run_callbacks_until(lambda: bool(dashboard.session.sentence or dashboard.views.tabs.state.get("understood")))
    assert sentence in dashboard.session.sentence
    assert dashboard.views.tabs.state.get("understood", "").startswith(understood)
    assert all(name.startswith("files") for name in threads) and bool(threads) == (len(text) <= LARGEST_UPLOAD)


def test_the_effects_panel_receives_the_slot_of_each_effect(dashboard: Dashboard,
                                                                                monkeypatch: pytest.MonkeyPatch) -> None:
    """Its table shows the slot's type next to each switch; with a separate list, it would miss a new effect."""
    monkeypatch.setattr(COMPILER, "has", lambda *_: False)
    dashboard.received({"do": "visible", "name": "effects", "value": True})
    panel = dashboard.views.tabs.state["panel"]
    assert sorted([*(one["slot"] for one in panel["effects"]), *panel["always"]]) == sorted(
        one["slot"] for one in panel["slots"])
    assert {one["name"]: one["slot"] for one in panel["effects"]}["dashpot"] == "dissipation"


def test_a_step_to_another_scene_has_the_curves_of_its_address(dashboard: Dashboard) -> None:
    """Without `curves`, an address means its scene's own. A scene from the menu keeps the chosen starts."""
    dashboard.received({"do": "go", "query": "v=1&scene=sec2&curves=rest.up"})
    assert dashboard.session.curves == "rest.up"
    dashboard.received({"do": "scene", "name": "rig"})
    assert dashboard.session.curves == "rest.up.features"
    dashboard.received({"do": "go", "query": "v=1&scene=sec2"})  # two steps back
    bar = dashboard.views.curve_bar.state
    assert dashboard.session.curves == "auto" and (bar["rest"], bar["up"], bar["features"]) == (True, False, False)


def test_visibility_is_reported_to_each_page_and_the_curve(dashboard: Dashboard) -> None:
    told: list[tuple[str, bool]] = []
    for row, page in zip(PAGES, dashboard.pages, strict=True):
        page.visibility_changed = partial(lambda *one: told.append(one), row.name)  # type: ignore[method-assign]
    for name in watched_pages():
        dashboard.received({"do": "visible", "name": name, "value": True})
    assert told == [(row.name, True) for row in PAGES]
    dashboard.received({"do": "visible", "name": "curve", "value": False})
    assert ("resonance curve, from rest", "off", "not on the screen") in dashboard.curves.activities()
    assert not dashboard.session.sentence


@pytest.mark.parametrize(("name", "value"), [("regimes", True), (None, True), (["map"], True), ("map", "yes"), ("map", None)])
def test_unknown_pages_and_answers_are_refused(dashboard: Dashboard, name: object, value: object) -> None:
    dashboard.received({"do": "visible", "name": name, "value": value})
    assert dashboard.session.sentence == f"There is no page {str(name)!r} to look at."


def test_a_reconnected_page_has_its_pause_back_and_the_rest_from_its_link(dashboard: Dashboard) -> None:
    dashboard.received({"do": "go", "query": "v=1&scene=sec2&speed=5&account=on"})
    dashboard.received({"do": "reconnected", "playing": False, "uploaded": True})
    session = dashboard.session
    assert (session.speed, session.playing, session.energy_account) == (5.0, False, True)
    assert not dashboard.views.header.state["playing"]
    assert session.sentence.endswith("Your settings are restored, but your uploaded data are gone.")


@pytest.mark.parametrize(("query", "different"), [
    ("", ""), (f"&N={MOST_BEADS_IN_LINK}&start=previous", ""),
    (f"&N={MOST_BEADS_IN_LINK + 1}&start=previous", ", but the motion starts from rest"),
    (f"&N={MOST_BEADS_IN_LINK + 1}&drive=rest&strike=1", ""), ("&mode=live", ", but the live run has started again")])
def test_a_reconnected_page_names_state_that_its_link_lacks(dashboard: Dashboard, query: str,
                                                                   different: str) -> None:
    """A settled motion starts from the same state as before, unless its chain is too long for a link."""
    dashboard.received({"do": "go", "query": f"v=1&scene=sec2{query}"})
    dashboard.received({"do": "reconnected", "playing": False})
    assert dashboard.session.sentence == f"The connection was lost. Your settings are restored{different}."


def test_an_action_of_two_pages_is_refused_with_both_names() -> None:
    """Otherwise, one of them would never be called."""
    with pytest.raises(TypeError, match="page `map` and page `branches` both have an action 'stop'"):
        all_actions({"page `map`": {"stop": print, "go": print}, "page `branches`": {"stop": print}})
    assert set(all_actions({"one": {"a": print}, "other": {"b": print}})) == {"a", "b"}


def test_a_step_of_the_history_ends_in_the_browser_even_if_a_page_fails(dashboard: Dashboard,
                                                                        monkeypatch: pytest.MonkeyPatch) -> None:
    """Until `address-applied` arrives, no change by the visitor becomes a step of the history."""

    def fail() -> None:
        raise RuntimeError("a page's own fault")

    monkeypatch.setattr(dashboard.pages[-1], "address_applied", fail)
    dashboard.received({"do": "go", "query": "scene=sec2&f=2000"})
    dashboard.run_callbacks_until(lambda: not dashboard.callbacks)
    assert [message["query"] for message in dashboard.sent if message["type"] == "address-applied"] == [dashboard.session.link]
