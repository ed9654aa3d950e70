"""What a browser may send and what is said to it, without a browser."""

from __future__ import annotations

import base64
import json
import threading
import time
from concurrent.futures import Future
from dataclasses import replace
from functools import partial
from types import SimpleNamespace
from typing import Any

import pytest
from bokeh.events import Tap
from headless_dashboard import Dashboard

from app import server
from app.dashboard import exports, main_picture
from app.dashboard.table import PAGES, watched_pages
from app.frames import settled_frames
from app.pages.data import page as data_page
from app.plots.theme import THEMES, Theme
from app.serve.compiling.compiler import COMPILER, Compiler
from app.serve.http.limits import LARGEST_UPLOAD
from app.serve.monitoring.metrics import METRICS
from app.session.budget import RefusedPicture
from app.session.page import all_actions
from app.session.starts import MOST_BEADS
from granchain_core import BadInput, run, scene, settle
from granchain_core.results.run import GIVEN_STATE


@pytest.mark.parametrize(("message", "sentence"), [
    ({"do": "branches-start", "period": True}, "period of a branch 'True' is not a whole number"),
    ({"do": "branches-start", "period": 9}, "period of a branch '9' is not a whole number"),
    ({"do": "branches-orbit", "arm": False, "place": 0}, "That branch is no longer on the page"),
    ({"do": "branches-double", "place": True}, "That special point is no longer on the page"),
    ({"do": "map-load", "number": True}, "That attractor is no longer on the page"),
    ({"do": "stability-section", "bead": True, "phase": 0}, "bead 'True' is not a whole number")])
def test_what_is_no_number_gets_its_sentence(dashboard: Dashboard, message: dict[str, Any], sentence: str) -> None:
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
    """Reading 2 MB with the document locked would hold up every visitor."""
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


def test_a_picture_is_saved_in_the_background(dashboard: Dashboard, monkeypatch: pytest.MonkeyPatch) -> None:
    dashboard.received({"do": "export"})
    assert "no picture to save yet" in dashboard.session.sentence
    threads = []
    save = exports.save
    monkeypatch.setattr(exports, "save",
                        lambda run, path, measured: (threads.append(threading.current_thread().name), save(run, path, measured)))
    shown = run(scene("sec2"), periods=0, record=1, samples=24)
    monkeypatch.setattr(dashboard.pictures, "shown_run", lambda: shown)
    dashboard.received({"do": "export"})
    dashboard.run_callbacks_until(lambda: any(message["type"] == "file" for message in dashboard.told))
    (file,) = [message for message in dashboard.told if message["type"] == "file"]
    assert file["name"] == "sec2-340Hz.h5" and file["content"][1:4] == b"HDF"
    assert threads[0].startswith("files")


def test_a_refusal_belongs_to_the_scene_that_was_refused(dashboard: Dashboard) -> None:
    """A knob may have moved before the refusal arrives: what is computed anyway is then not what the sentence is about.
    """
    refused = dashboard.session.scene.evolve(N=10_000)
    dashboard.report_failure(RefusedPicture(refused, "It would take long."))
    assert dashboard.session.sentence == "" and not dashboard.views.status_line.state.get("insist")
    dashboard.session.scene = refused
    dashboard.report_failure(RefusedPicture(refused, "It would take long."))
    assert dashboard.views.status_line.state["insist"]
    dashboard.report_failure(BadInput("Something else."))
    assert not dashboard.views.status_line.state["insist"]


def test_another_scale_leaves_a_paused_chain_where_it_is(dashboard: Dashboard, monkeypatch: pytest.MonkeyPatch) -> None:
    sent: list[dict[str, Any]] = []
    monkeypatch.setattr(dashboard.views.chain, "send", lambda **message: sent.append(message))
    session, pictures = dashboard.session, dashboard.pictures
    session.set_mode("live")
    session.playing = False
    pictures.begin_live()
    pictures.advance(7)
    dashboard.run_callbacks_until(lambda: len(sent) == 1)
    dashboard.received({"do": "scale", "value": "fit"})
    dashboard.run_callbacks_until(lambda: not (pictures.busy or dashboard.callbacks))
    shown = pictures.shown_run()
    assert len(sent) == 2 and [message["fit"] for message in sent] == [False, True]
    assert shown is not None and len(shown.time) == 8, "no sample follows the seven of the first picture"


def test_choosing_the_scale_takes_the_scenes_own_again(dashboard: Dashboard) -> None:
    """Whatever has widened it, and although it was chosen before."""
    scales, chain = dashboard.views.scales, dashboard.session.scene
    frames = settled_frames(settle(chain, samples=8).run)
    first = scales.of(frames, chain)
    louder = settled_frames(settle(chain.evolve(A0=4.0 * chain.A0), samples=8).run)
    assert scales.of(louder, chain) != first
    dashboard.received({"do": "scale", "value": "same"})
    assert scales.of(frames, chain) == first


def test_the_header_says_where_the_motion_on_the_screen_began(dashboard: Dashboard) -> None:
    chain = scene("sec2").evolve(N=2, f=2000.0)
    dashboard.session.scene = chain
    found = settle(chain, samples=8)
    for picture in (replace(found, run=replace(found.run, start=GIVEN_STATE)), found):
        dashboard.picture_ready(picture)
        state = dashboard.views.header.state
        assert (state["picture_start"], state["start"]) == (picture.start, "rest")


def test_the_pages_hear_of_a_picture_when_it_was_sent(dashboard: Dashboard, monkeypatch: pytest.MonkeyPatch) -> None:
    """What a page draws of it takes milliseconds, which would come before every picture."""
    told: list[str] = []
    monkeypatch.setattr(dashboard.views.chain, "send", lambda **message: told.append(message["type"]))
    monkeypatch.setattr(dashboard.pages[0], "picture_ready", lambda picture: told.append("page"))
    dashboard.session.scene = chain = scene("sec2").evolve(N=2, f=2000.0)
    found = settle(chain, samples=8)
    dashboard.pictures._accept(found)
    assert told == ["frames"]
    dashboard.run_callbacks_until(lambda: not dashboard.callbacks)
    assert told == ["frames", "page"]


def test_the_pages_do_not_hear_of_a_picture_of_knobs_that_have_moved_on(dashboard: Dashboard,
                                                                        monkeypatch: pytest.MonkeyPatch) -> None:
    """They know already that it is out of date, and would take it for the new one."""
    told: list[Any] = []
    page = dashboard.pages[0]
    monkeypatch.setattr(dashboard.pictures, "compute", lambda start=None: None)
    monkeypatch.setattr(page, "picture_requested", lambda: told.append("requested"))
    monkeypatch.setattr(page, "picture_ready", told.append)
    dashboard.session.scene = chain = scene("sec2").evolve(N=2, f=2000.0)
    preview, final = (replace(settle(chain, samples=8), final=final) for final in (False, True))
    dashboard.pictures._accept(preview)
    dashboard.received({"do": "set", "name": "f", "value": 2001.0})
    dashboard.run_callbacks_until(lambda: not dashboard.callbacks)
    assert told == ["requested"]
    for found in (preview, final):
        dashboard.pictures._accept(found)
    dashboard.run_callbacks_until(lambda: not dashboard.callbacks)
    assert told == ["requested", final], "a preview that is overtaken is left out"


def test_a_picture_is_computed_as_it_was_asked_for(dashboard: Dashboard, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever changes on the page between the request and the thread that takes it."""
    asked, changed = threading.Event(), threading.Event()
    monkeypatch.setattr(main_picture, "check_first_picture", lambda _: (asked.set(), changed.wait(60)))
    session = dashboard.session
    session.scene = chain = scene("sec2").evolve(N=2, f=2000.0)
    session.set_start("previous")
    session.settled = before = settle(chain, samples=8)
    session.energy_account = True
    dashboard.pictures.compute()
    assert asked.wait(60)
    session.settled, session.energy_account, session.insisted = None, False, chain
    changed.set()
    dashboard.run_callbacks_until(lambda: not (dashboard.pictures.busy or dashboard.callbacks))
    assert session.settled is not None and session.settled.run.start == GIVEN_STATE
    assert session.initial_state is before.state and session.settled.run.energy_residual is not None


def test_nothing_is_settled_for_a_visitor_who_left_while_kernels_were_compiled(dashboard: Dashboard,
                                                                              monkeypatch: pytest.MonkeyPatch) -> None:
    """Settling would compile what the other process has not finished, inside the server."""
    waiting, settled = threading.Event(), []

    class Compiling(Compiler):
        """A compiler that never ends."""

        def has(self, *_: object) -> bool:
            """Nothing is compiled."""
            return False

        def ask(self, *_: object) -> Future[None]:
            """Never done."""
            waiting.set()
            return Future()

    monkeypatch.setattr(main_picture, "COMPILER", Compiling())
    monkeypatch.setattr(main_picture, "settling", lambda *_, **__: settled.append("began") or iter(()))
    dashboard.pictures.compute()
    assert waiting.wait(60)
    dashboard.close(None)
    dashboard.run_callbacks_until(lambda: not dashboard.pictures.busy)
    assert settled == []


def test_the_effects_panel_is_told_the_slot_of_each_effect_and_the_slots_of_none(dashboard: Dashboard,
                                                                                monkeypatch: pytest.MonkeyPatch) -> None:
    """Its table shows beside each switch the type in the slot; a list of its own would miss a new effect."""
    monkeypatch.setattr(COMPILER, "has", lambda *_: False)
    dashboard.received({"do": "visible", "name": "effects", "value": True})
    panel = dashboard.views.tabs.state["panel"]
    assert sorted([*(one["slot"] for one in panel["effects"]), *panel["always"]]) == sorted(
        one["slot"] for one in panel["slots"])
    assert {one["name"]: one["slot"] for one in panel["effects"]}["dashpot"] == "dissipation"


def test_a_step_to_another_scene_has_the_curves_of_its_address(dashboard: Dashboard) -> None:
    """Without `curves` an address means those of its scene. A scene from the menu keeps the chosen starts."""
    dashboard.received({"do": "go", "query": "v=1&scene=sec2&curves=rest.up"})
    assert dashboard.session.curves == "rest.up"
    dashboard.received({"do": "scene", "name": "rig"})
    assert dashboard.session.curves == "rest.up.features"
    dashboard.received({"do": "go", "query": "v=1&scene=sec2"})  # two steps back
    bar = dashboard.views.curve_bar.state
    assert dashboard.session.curves == "auto" and (bar["rest"], bar["up"], bar["features"]) == (True, False, False)


def test_each_page_and_the_curve_hear_whether_somebody_looks(dashboard: Dashboard) -> None:
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
def test_what_is_no_page_or_no_answer_is_refused(dashboard: Dashboard, name: object, value: object) -> None:
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
    ("", ""), (f"&N={MOST_BEADS}&start=previous", ""),
    (f"&N={MOST_BEADS + 1}&start=previous", ", but the motion begins at rest"),
    (f"&N={MOST_BEADS + 1}&drive=rest&strike=1", ""), ("&mode=live", ", but the live run has begun anew")])
def test_a_reconnected_page_says_what_its_link_does_not_bring_back(dashboard: Dashboard, query: str,
                                                                   different: str) -> None:
    """A settled motion begins where it began before, unless its chain is too long for a link."""
    dashboard.received({"do": "go", "query": f"v=1&scene=sec2{query}"})
    dashboard.received({"do": "reconnected", "playing": False})
    assert dashboard.session.sentence == f"The connection was lost. Your settings are restored{different}."


def test_another_theme_reaches_the_pages_and_their_figures(dashboard: Dashboard) -> None:
    told: list[Theme] = []
    for page in dashboard.pages:
        page.theme_changed = told.append  # type: ignore[method-assign]
    dashboard.received({"do": "theme", "value": "dark"})
    dashboard.received({"do": "theme", "value": "none of them"})
    assert told == [THEMES["dark"]] * len(dashboard.pages)
    assert dashboard.views.overlays["branches"].theme == THEMES["dark"]  # type: ignore[attr-defined]


def test_an_action_of_two_pages_is_refused_with_both_names() -> None:
    """One of them would never be called."""
    with pytest.raises(TypeError, match="page `map` and page `branches` both have an action 'stop'"):
        all_actions({"page `map`": {"stop": print, "go": print}, "page `branches`": {"stop": print}})
    assert set(all_actions({"one": {"a": print}, "other": {"b": print}})) == {"a", "b"}


def test_the_servers_websocket_takes_the_largest_upload(monkeypatch: pytest.MonkeyPatch) -> None:
    given: dict[str, Any] = {}

    class Served:
        """A server that ends at once."""

        io_loop = SimpleNamespace(start=lambda: None, spawn_callback=lambda _: None)
        _tornado = SimpleNamespace(wildcard_router=SimpleNamespace(rules=[]), websocket_origins=set())

        def start(self) -> None:
            """Nothing to serve."""

    monkeypatch.setattr(server.pn, "serve", lambda pages, **options: given.update(options) or Served())
    monkeypatch.setattr(server.COMPILER, "prepare", lambda scene: None)
    monkeypatch.setattr(server.logs, "configure", lambda level: None)
    monkeypatch.setattr(server.gc, "freeze", lambda: None)
    monkeypatch.setattr(server.settings.perform_document_validation, "set_value", lambda value: None)
    server.serve()
    message = json.dumps({"do": "measurement", "name": "x" * 1000, "content": base64.b64encode(bytes(LARGEST_UPLOAD)).decode()})
    assert len(message) < given["websocket_max_message_size"] < 3_000_000
    assert given["websocket_ping_interval"] == given["websocket_ping_timeout"] == 20
    assert given["http_server_kwargs"]["idle_connection_timeout"] == 60 and given["http_server_kwargs"]["body_timeout"] == 30


def test_a_busy_server_says_so_with_the_next_picture(dashboard: Dashboard, monkeypatch: pytest.MonkeyPatch) -> None:
    """The message disappears with the first picture that comes in time."""
    clock = [5.0]
    monkeypatch.setattr(main_picture, "time", SimpleNamespace(monotonic=lambda: clock[0], thread_time=time.thread_time))
    try:
        for late, wait, said in ((0.4, 0.0, True), (0.0, 0.1, False), (0.0, 0.4, True)):
            for _ in range(40):
                METRICS.lagged(late)
            monkeypatch.setattr(METRICS, "turn_wait", lambda wait=wait: wait)
            dashboard.pictures.compute()
            clock[0] += 1.2
            dashboard.run_callbacks_until(lambda: not (dashboard.pictures.busy or dashboard.callbacks))
            words = dashboard.views.status_line.state["busy"]
            assert words == ("The server is busy: pictures follow every 1.2 s." if said else "")
    finally:
        for _ in range(40):
            METRICS.lagged(0.0)


def test_a_step_of_the_history_ends_in_the_browser_even_if_a_page_fails(dashboard: Dashboard,
                                                                        monkeypatch: pytest.MonkeyPatch) -> None:
    """Until `address-applied` comes no change of the visitor becomes a step of the history."""

    def fail() -> None:
        raise RuntimeError("a page's own fault")

    monkeypatch.setattr(dashboard.pages[-1], "address_applied", fail)
    dashboard.received({"do": "go", "query": "scene=sec2&f=2000"})
    dashboard.run_callbacks_until(lambda: not dashboard.callbacks)
    assert [message["query"] for message in dashboard.told if message["type"] == "address-applied"] == [dashboard.session.link]


def test_a_picture_that_is_overtaken_before_it_is_sent_is_not_counted(dashboard: Dashboard) -> None:
    dashboard.session.scene = chain = scene("sec2").evolve(N=2, f=2000.0)
    found, counted = settle(chain, samples=8), METRICS.counted["pictures"]
    for _ in range(5):
        dashboard.pictures._accept(found)
    assert METRICS.counted["pictures"] - counted == 2
    dashboard.pictures.painted(1)
    assert METRICS.counted["pictures"] - counted == 3


def test_the_figures_of_the_page_and_of_its_pages_follow_a_theme(dashboard: Dashboard) -> None:
    views, theme = dashboard.views, THEMES["projector"]
    widths = [line.glyph.line_width for line in views.trains._lines]
    views.apply_theme(theme)
    ring = views.curve._dot.glyph
    assert (ring.line_color, ring.size) == (theme.ink, 15 * theme.line_scale)
    assert [line.glyph.line_width for line in views.trains._lines] == [pytest.approx(theme.line_scale * width) for width in widths]
    assert views.overlays["branches"].theme == theme


def test_what_is_added_to_a_figure_of_the_page_has_its_theme_and_follows_the_next(dashboard: Dashboard) -> None:
    """Names of pins and measured data are made when they are first needed."""
    views = dashboard.views
    views.apply_theme(THEMES["dark"])
    views.curve._pinned.places = [("A", 400.0, 1.0)]
    views.curve._pinned.draw(1.0)
    rings, names = views.curve._pinned._marks
    for theme in (THEMES["dark"], THEMES["projector"]):
        views.apply_theme(theme)
        assert rings.glyph.line_color == names.glyph.text_color == theme.ink
