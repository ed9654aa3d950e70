"""Messages that a browser may send and the answers to them, without a browser."""

from __future__ import annotations

import base64
import threading
from functools import partial
from typing import Any

import pytest
from bokeh.events import Tap
from headless_dashboard import Dashboard

from app.dashboard.sentences import SENT_UNASKED
from app.dashboard.table import PAGES, watched_pages
from app.pages.data import page as data_page
from app.serve.compiling.compiler import COMPILER
from app.serve.http.limits import LARGEST_UPLOAD
from app.session.initial_state import MOST_BEADS_IN_LINK
from app.session.page import all_actions
from tools.dashboard_tables import messages_of_the_browser


@pytest.mark.parametrize(("message", "sentence"), [
    ({"do": "branches-start", "period": True}, "period of a branch 'True' is not a whole number"),
    ({"do": "branches-start", "period": 9}, "period of a branch '9' is not a whole number"),
    ({"do": "branches-orbit", "arm": False, "place": 0}, "That branch is no longer on the page"),
    ({"do": "branches-double", "place": True}, "That special point is no longer on the page"),
    ({"do": "map-load", "number": True}, "That attractor is no longer on the page"),
    ({"do": "stability-section", "bead": True, "phase": 0}, "bead 'True' is not a whole number")])
def test_a_value_that_is_no_number_gets_a_sentence(dashboard: Dashboard, message: dict[str, Any], sentence: str) -> None:
    dashboard.receive(message)
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
    dashboard.receive({"do": "measurement", "name": "mine.csv", "content": base64.b64encode(text.encode()).decode()})
    assert not dashboard.views.tabs.state.get("understood")
    dashboard.run_callbacks_until(lambda: bool(dashboard.session.sentence or dashboard.views.tabs.state.get("understood")))
    assert sentence in dashboard.session.sentence
    assert dashboard.views.tabs.state.get("understood", "").startswith(understood)
    assert all(name.startswith("files") for name in threads) and bool(threads) == (len(text) <= LARGEST_UPLOAD)


def test_the_effects_panel_receives_the_slot_of_each_effect(dashboard: Dashboard,
                                                                                monkeypatch: pytest.MonkeyPatch) -> None:
    """Its table shows the slot's type next to each switch; with a separate list, it would miss a new effect."""
    monkeypatch.setattr(COMPILER, "has", lambda *_: False)
    dashboard.receive({"do": "visible", "name": "effects", "value": True})
    panel = dashboard.views.tabs.state["panel"]
    assert sorted([*(one["slot"] for one in panel["effects"]), *panel["always"]]) == sorted(
        one["slot"] for one in panel["slots"])
    assert {one["name"]: one["slot"] for one in panel["effects"]}["dashpot"] == "dissipation"


def test_a_step_to_another_scene_has_the_curves_of_its_address(dashboard: Dashboard) -> None:
    """Without `curves`, an address means its scene's own. A scene from the menu keeps the chosen starts."""
    dashboard.receive({"do": "go", "query": "v=1&scene=sec2&curves=rest.up"})
    assert dashboard.session.curves == "rest.up"
    dashboard.receive({"do": "scene", "name": "rig"})
    assert dashboard.session.curves == "rest.up.features"
    dashboard.receive({"do": "go", "query": "v=1&scene=sec2"})  # two steps back
    bar = dashboard.views.curve_bar.state
    assert dashboard.session.curves == "auto" and (bar["rest"], bar["up"], bar["features"]) == (True, False, False)


def test_visibility_is_reported_to_each_page_and_the_curve(dashboard: Dashboard) -> None:
    told: list[tuple[str, bool]] = []
    for row, page in zip(PAGES, dashboard.pages, strict=True):
        page.visibility_changed = partial(lambda *one: told.append(one), row.name)  # type: ignore[method-assign]
    for name in watched_pages():
        dashboard.receive({"do": "visible", "name": name, "value": True})
    assert told == [(row.name, True) for row in PAGES]
    dashboard.receive({"do": "visible", "name": "curve", "value": False})
    assert ("resonance curve, from rest", "off", "not on the screen") in dashboard.curves.activities()
    assert not dashboard.session.sentence


@pytest.mark.parametrize(("message", "sentence"), [
    ({"do": "visible", "name": "stability-page", "value": True}, "Unknown page 'stability-page'; the nearest is 'stability'"),
    ({"do": "visible", "name": None, "value": True}, "Unknown page 'None'; the nearest is"),
    ({"do": "visible", "name": ["map"], "value": True}, "Unknown page \"['map']\"; the nearest is 'map'"),
    ({"do": "curve", "name": "ups", "value": True}, "Unknown curve 'ups'; the nearest is 'up'"),
    ({"do": "theme", "value": "darkest"}, "Unknown theme 'darkest'; the nearest is 'dark'"),
    ({"do": "ready", "compact": False, "theme": "darkest"}, "Unknown theme 'darkest'; the nearest is 'dark'"),
    ({"do": "mode", "value": "alive"}, "Unknown mode 'alive'; the nearest is 'live'"),
    ({"do": "start", "value": "resting"}, "Unknown start 'resting'; the nearest is 'rest'"),
    ({"do": "scale", "value": True}, "Unknown scale 'True'; the nearest is"),
    ({"do": "restore", "name": "kapa"}, "Unknown knob 'kapa'; the nearest is 'kappa'"),
    ({"do": "export", "what": "hdf"}, "Unknown file to save 'hdf'; the nearest is 'hdf5'"),
    ({"do": "story-open", "name": "solitary", "step": 1}, "Unknown story 'solitary'; the nearest is 'solitary-wave'")])
def test_an_unknown_name_is_refused_with_the_nearest(dashboard: Dashboard, message: dict[str, Any], sentence: str) -> None:
    dashboard.receive(message)
    assert dashboard.session.sentence.startswith(sentence)


@pytest.mark.parametrize("wrong", ["no", "false", 0, 1, None, [True]])
@pytest.mark.parametrize("message", [
    {"do": "playing"}, {"do": "compact"}, {"do": "curve", "name": "rest"}, {"do": "visible", "name": "map"},
    {"do": "stability-observer"}, {"do": "switch", "name": "dashpot"}])
def test_a_switch_is_true_or_false(dashboard: Dashboard, message: dict[str, Any], wrong: object) -> None:
    """Otherwise "no" would play, and "false" would switch a curve on."""
    before = dashboard.session.link, dashboard.session.playing, dashboard.curves.selection(dashboard.session.scene)
    dashboard.receive({**message, "value": wrong})
    assert dashboard.session.sentence.endswith("is neither true nor false.")
    assert (dashboard.session.link, dashboard.session.playing, dashboard.curves.selection(dashboard.session.scene)) == before


@pytest.mark.parametrize("message", [
    {"do": "ready", "theme": "light", "compact": "no"}, {"do": "reconnected", "playing": "no"},
    {"do": "reconnected", "playing": True, "uploaded": "no"}])
def test_the_switches_of_a_page_that_begins_are_true_or_false(dashboard: Dashboard, message: dict[str, Any]) -> None:
    dashboard.receive(message)
    assert dashboard.session.sentence.endswith("is neither true nor false.") and dashboard.session.playing


@pytest.mark.parametrize("message", [
    {"do": "speed", "value": 2}, {"do": "scale", "value": "fit"}, {"do": "start", "value": "previous"},
    {"do": "mode", "value": "settled"}, {"do": "reset"}, {"do": "curve", "name": "up", "value": True}, {"do": "curve-stop"},
    {"do": "share"}, {"do": "gallery"}, {"do": "set", "name": "f", "value": 400.0}, {"do": "restore", "name": "f"},
    {"do": "dismiss-sentence"}, {"do": "story-close"}, {"do": "measurement-sample"}])
def test_a_refusal_stays_until_the_next_valid_action_of_the_visitor(dashboard: Dashboard, message: dict[str, Any]) -> None:
    dashboard.receive({"do": "set", "name": "f", "value": -1})
    refusal = dashboard.session.sentence
    for unasked in ({"do": "ping"}, {"do": "compact", "value": False}, {"do": "visible", "name": "map", "value": True},
                    {"do": "painted", "number": 1}, {"do": "theme", "value": "dark"}, {"do": "playing", "value": True}):
        dashboard.receive(unasked)
        assert dashboard.session.sentence == refusal, "the browser also sends this when the visitor does nothing"
    dashboard.receive(message)
    assert dashboard.session.sentence == "" and dashboard.views.status_line.state["sentence"] == ""


def test_an_action_that_is_refused_replaces_the_refusal_before(dashboard: Dashboard) -> None:
    dashboard.receive({"do": "set", "name": "f", "value": -1})
    dashboard.receive({"do": "speed", "value": 3})
    assert dashboard.session.sentence.startswith("speed '3' is not one of")


def test_every_message_that_leaves_the_sentence_is_a_message() -> None:
    assert {name for names in messages_of_the_browser().values() for name in names} >= SENT_UNASKED


def test_a_reconnected_page_has_its_pause_back_and_the_rest_from_its_link(dashboard: Dashboard) -> None:
    dashboard.receive({"do": "go", "query": "v=1&scene=sec2&speed=5&account=on"})
    dashboard.receive({"do": "reconnected", "playing": False, "uploaded": True})
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
    dashboard.receive({"do": "go", "query": f"v=1&scene=sec2{query}"})
    dashboard.receive({"do": "reconnected", "playing": False})
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
    dashboard.receive({"do": "go", "query": "scene=sec2&f=2000"})
    dashboard.run_callbacks_until(lambda: not dashboard.callbacks)
    assert [message["query"] for message in dashboard.sent if message["type"] == "address-applied"] == [dashboard.session.link]
