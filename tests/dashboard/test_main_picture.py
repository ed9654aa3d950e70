"""The picture of the main page, without a browser: what is computed, what is shown, and which pages are notified."""

from __future__ import annotations

import threading
from concurrent.futures import Future
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest
from headless_dashboard import Dashboard

from app.dashboard import exports, picture_work
from app.frames import settled_frames
from app.serve.compiling.compiler import Compiler
from app.serve.monitoring import picture_stages
from app.serve.monitoring.metrics import METRICS
from app.session.budget import RefusedPicture
from granchain_core import BadInput, run, scene, settle
from granchain_core.results.run import GIVEN_STATE


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
    dashboard.run_callbacks_until(lambda: any(message["type"] == "file" for message in dashboard.sent))
    (file,) = [message for message in dashboard.sent if message["type"] == "file"]
    assert file["name"] == "sec2-340Hz.h5" and file["content"][1:4] == b"HDF"
    assert threads[0].startswith("files")


def test_a_refusal_belongs_to_the_scene_that_was_refused(dashboard: Dashboard) -> None:
    """The refusal may arrive after the knob has moved; “Compute it anyway” must not be offered for the new value."""
    refused = dashboard.session.scene.evolve(N=10_000)
    dashboard.show_failure(RefusedPicture(refused, "It would take long."))
    assert dashboard.session.sentence == "" and not dashboard.views.status_line.state.get("insist")
    dashboard.session.scene = refused
    dashboard.show_failure(RefusedPicture(refused, "It would take long."))
    assert dashboard.views.status_line.state["insist"]
    dashboard.show_failure(BadInput("Something else."))
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
    """This is true whatever has widened the scale, and even if it was chosen before."""
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


def test_pages_receive_a_picture_once_it_was_sent(dashboard: Dashboard, monkeypatch: pytest.MonkeyPatch) -> None:
    """A page's drawing takes milliseconds, by which every picture would otherwise be delayed."""
    told: list[str] = []
    monkeypatch.setattr(dashboard.views.chain, "send", lambda **message: told.append(message["type"]))
    monkeypatch.setattr(dashboard.pages[0], "picture_ready", lambda picture: told.append("page"))
    dashboard.session.scene = chain = scene("sec2").evolve(N=2, f=2000.0)
    found = settle(chain, samples=8)
    dashboard.pictures._accept(found)
    assert told == ["frames"]
    dashboard.run_callbacks_until(lambda: not dashboard.callbacks)
    assert told == ["frames", "page"]


def test_pages_receive_no_picture_of_former_knobs(dashboard: Dashboard,
                                                                        monkeypatch: pytest.MonkeyPatch) -> None:
    """They already know that it is out of date, and would take it for the new picture."""
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
    assert told == ["requested", final], "an overtaken preview is left out"


def test_a_picture_is_computed_as_it_was_asked_for(dashboard: Dashboard, monkeypatch: pytest.MonkeyPatch) -> None:
    """Changes on the page between the request and its execution in a thread have no effect."""
    asked, changed = threading.Event(), threading.Event()
    monkeypatch.setattr(picture_work, "check_first_picture", lambda _: (asked.set(), changed.wait(60)))
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
    """Settling would compile the other process's unfinished kernels inside the server."""
    waiting, settled = threading.Event(), []

    class Compiling(Compiler):
        """A compiler that never finishes."""

        def has(self, *_: object) -> bool:
            """Return that nothing is compiled."""
            return False

        def ask(self, *_: object) -> Future[None]:
            """Return a future that is never done."""
            waiting.set()
            return Future()

    monkeypatch.setattr(picture_work, "COMPILER", Compiling())
    monkeypatch.setattr(picture_work, "settling", lambda *_, **__: settled.append("began") or iter(()))
    dashboard.pictures.compute()
    assert waiting.wait(60)
    dashboard.close()
    dashboard.run_callbacks_until(lambda: not dashboard.pictures.busy)
    assert settled == []


def test_a_busy_server_says_so_with_the_next_picture(dashboard: Dashboard, monkeypatch: pytest.MonkeyPatch) -> None:
    """The message disappears with the first picture that arrives in time."""
    clock = [5.0]
    monkeypatch.setattr(picture_stages, "time", SimpleNamespace(monotonic=lambda: clock[0]))
    try:
        for late, wait, said in ((0.4, 0.0, True), (0.0, 0.1, False), (0.0, 0.4, True)):
            for _ in range(40):
                METRICS.lagged(late)
            monkeypatch.setattr(METRICS, "turn_wait", lambda wait=wait: wait)
            dashboard.pictures.compute()
            clock[0] += 1.2
            dashboard.run_callbacks_until(lambda: not (dashboard.pictures.busy or dashboard.callbacks))
            words = dashboard.views.status_line.state["busy"]
            assert words == ("The server is busy: this picture took 1.2 s." if said else "")
    finally:
        for _ in range(40):
            METRICS.lagged(0.0)


def test_a_picture_that_is_overtaken_before_it_is_sent_is_not_counted(dashboard: Dashboard) -> None:
    dashboard.session.scene = chain = scene("sec2").evolve(N=2, f=2000.0)
    found, counted = settle(chain, samples=8), METRICS.counted["pictures"]
    for _ in range(5):
        dashboard.pictures._accept(found)
    assert METRICS.counted["pictures"] - counted == 2
    dashboard.pictures.painted(1)
    assert METRICS.counted["pictures"] - counted == 3


def test_only_the_picture_of_a_request_answers_it(dashboard: Dashboard, monkeypatch: pytest.MonkeyPatch) -> None:
    """A picture of the previous knobs may arrive first. It is shown, but the visitor is still waiting for the other."""
    clock, counted, begun = [0.0], [], threading.Event()
    go_on = {frequency: threading.Event() for frequency in (2000.0, 2100.0)}
    monkeypatch.setattr(picture_stages, "time", SimpleNamespace(monotonic=lambda: clock[0]))
    monkeypatch.setattr(picture_work, "check_first_picture", lambda chain: (begun.set(), go_on[chain.f].wait(60)))
    monkeypatch.setattr(METRICS, "answered", counted.append)
    session, pictures = dashboard.session, dashboard.pictures
    session.scene = scene("sec2").evolve(N=2, f=2000.0)
    pictures.compute()
    assert begun.wait(60)
    clock[0] = 1.0
    session.change("f", 2100.0)
    pictures.compute()
    go_on[2000.0].set()
    dashboard.run_callbacks_until(lambda: bool(counted))
    assert counted == [1.0], "the picture of 2000 Hz, from its own request on"
    clock[0] = 4.0
    go_on[2100.0].set()
    dashboard.run_callbacks_until(lambda: not (pictures.busy or dashboard.callbacks))
    assert session.settled is not None and session.settled.run.scene.f == 2100.0
    assert counted == [1.0, 3.0], "each request is counted once, with its first picture"


def test_a_live_step_answers_only_the_knobs_that_were_moved_before_it(dashboard: Dashboard,
                                                                      monkeypatch: pytest.MonkeyPatch) -> None:
    counted: list[float] = []
    monkeypatch.setattr(METRICS, "answered", counted.append)
    session, pictures = dashboard.session, dashboard.pictures
    session.set_mode("live")
    session.playing = False
    pictures.begin_live()
    pictures.advance(3)
    dashboard.run_callbacks_until(lambda: not (pictures.busy or dashboard.callbacks))
    assert counted == [], "nothing was moved"
    session.change("f", 2100.0)
    pictures.compute()
    dashboard.run_callbacks_until(lambda: not (pictures.busy or dashboard.callbacks))
    pictures.advance(3)
    dashboard.run_callbacks_until(lambda: not (pictures.busy or dashboard.callbacks))
    assert len(counted) == 1
