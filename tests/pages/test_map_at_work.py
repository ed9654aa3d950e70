"""The Map tab, without a browser: which cells are computed when, and the handling of attractors."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from page_host import PageUnderTest, picture

from app.pages.map import page as module
from granchain_core import Cancelled
from granchain_core.parameter_maps.cells import CELL


@pytest.fixture
def tab(page_of: Callable[[str], PageUnderTest], monkeypatch: pytest.MonkeyPatch) -> PageUnderTest:
    """The tab, with cells that take no time."""
    def cell(number: int) -> np.ndarray:
        row = np.zeros((), dtype=CELL)
        row["number"], row["period"], row["max_output_force"] = number, 1, 1.0 + number
        return row

    monkeypatch.setattr(module, "iter_parameter_map", lambda grid, missing, *_, **_options: iter(missing))
    monkeypatch.setattr(module, "cell_of", cell)
    return page_of("map")


def interrupted(monkeypatch: pytest.MonkeyPatch, tab: PageUnderTest, cells: int) -> None:
    """Let the visitor leave the tab after this many cells."""
    def some(grid: Any, missing: list[int], *_: Any, **_options: Any) -> Iterator[int]:
        yield from missing[:cells]
        tab.set_visible(False)
        raise Cancelled

    with monkeypatch.context() as patched:
        patched.setattr(module, "_MESSAGE_EVERY", 0.0)
        patched.setattr(module, "iter_parameter_map", some)
        tab.set_visible()
        submitted: Any = tab.submitted[0]
        submitted.job.next_tick = lambda action, *arguments: action(*arguments)  # each cell arrives before the next
        tab.compute()


def test_the_map_is_computed_once_while_the_tab_is_open(tab: PageUnderTest) -> None:
    tab.set_visible()
    assert [submitted.pool for submitted in tab.submitted] == ["long"] and tab.last("map-status")["status"] == "waiting"
    tab.compute()
    assert tab.last("map-status")["status"] == "done" and tab.last("map-cells")["done"] == 1.0
    tab.set_visible(False)
    tab.set_visible()
    assert tab.under_way == [], "the map is complete"
    assert len(tab.last("map-cells")["rows"]["cells"]["number"]) == module.ROWS * module.COLUMNS, "the whole map is sent again"


def test_only_the_cells_that_are_missing_are_computed_later(tab: PageUnderTest, monkeypatch: pytest.MonkeyPatch) -> None:
    interrupted(monkeypatch, tab, 7)
    assert tab.last("map-status")["progress"] == "stopped; the cells computed so far are kept"
    asked: list[list[int]] = []

    def noted(_grid: Any, missing: list[int], *_: Any, **_options: Any) -> Iterator[int]:
        asked.append(missing)
        yield from missing

    monkeypatch.setattr(module, "iter_parameter_map", noted)
    tab.set_visible()
    tab.compute()
    assert len(asked[0]) == module.ROWS * module.COLUMNS - 7 and tab.last("map-status")["status"] == "done"


def test_f_and_A0_move_the_mark_and_any_other_knob_asks_for_another_map(tab: PageUnderTest) -> None:
    tab.set_visible()
    tab.compute()
    tab.move_knobs(f=2100.0)
    tab.run_callbacks()
    assert tab.last("map-mark")["mark"] and tab.under_way == [] and tab.messages("map-stale") == []
    tab.move_knobs(kappa=0.2)
    assert tab.last("map-stale") and tab.under_way == [], "it starts when the knobs rest"
    tab.move_knobs(kappa=0.3)
    tab.run_callbacks()
    (submitted,) = tab.under_way
    tab.move_knobs(kappa=0.4)
    assert submitted.job.stop
    tab.run_callbacks()
    assert len(tab.under_way) == 1
    tab.set_visible(False)
    assert tab.under_way == [] and tab.last("map-status")["status"] == "stopped"


def test_a_hidden_map_follows_moved_knobs_once_it_is_opened(tab: PageUnderTest) -> None:
    tab.set_visible()
    tab.compute()
    tab.set_visible(False)
    before = len(tab.sent)
    tab.move_knobs(kappa=0.2)
    tab.run_callbacks()
    assert len(tab.sent) == before and tab.under_way == []
    tab.set_visible()
    assert len(tab.under_way) == 1 and tab.last("map-head")


def test_the_map_gives_way_to_picture_and_curve(tab: PageUnderTest) -> None:
    page: Any = tab.page
    assert not page._in_front()
    tab.host.awaiting_picture = True
    assert page._in_front()
    tab.host.awaiting_picture, tab.host.curve_computing = False, True
    assert page._in_front()


def test_attractors_are_listed_loaded_and_forgotten_with_their_scene(tab: PageUnderTest, monkeypatch: pytest.MonkeyPatch) -> None:
    found = SimpleNamespace(scene=picture().run.scene, state=picture().state)
    monkeypatch.setattr(module, "attractors", lambda scene, starts, stop: [found])
    monkeypatch.setattr(module, "described_attractor", lambda attractor: {"words": "period 1"})
    tab.set_visible()
    tab.submitted.clear()
    tab.do("map-attractors")
    assert tab.last("map-attractors")["progress"] == "waiting for its turn …"
    tab.compute()
    assert tab.last("map-attractors")["attractors"] == [{"words": "period 1"}]
    tab.do("map-load", number=0)
    assert tab.host.shown == [(found.scene, found.state, "settled")] and tab.host.session.start == "previous"
    tab.move_knobs(f=2100.0)
    assert tab.last("map-attractors")["attractors"] == [] and tab.last("map-attractors")["status"] == "none"


def test_a_search_for_attractors_is_stopped_alone(tab: PageUnderTest) -> None:
    tab.set_visible()
    tab.do("map-attractors")
    the_map, search = tab.submitted
    tab.do("map-attractors-stop")
    assert search.job.stop and not the_map.job.stop
    last = tab.last("map-attractors")
    assert (last["progress"], last["running"], last["attractors"]) == ("stopped", False, [])


def test_a_search_for_attractors_ends_when_a_knob_moves(tab: PageUnderTest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its result would be shown as that of the new knobs. This is true of a hidden tab too."""
    monkeypatch.setattr(module, "attractors", lambda scene, starts, stop: [scene])
    monkeypatch.setattr(module, "described_attractor", lambda shown: {"words": f"at {shown.f:g} Hz"})
    for visible, f in ((True, 2100.0), (False, 2200.0)):
        tab.set_visible()
        tab.submitted.clear()
        tab.do("map-attractors")
        (search,) = tab.submitted
        tab.set_visible(visible)
        tab.move_knobs(f=f)
        assert search.job.stop and tab.last("map-attractors")["status"] == "none"
        tab.compute()
        assert all(message["attractors"] == [] for message in tab.messages("map-attractors"))


def test_reopening_the_tab_during_a_search_shows_that_it_runs(tab: PageUnderTest) -> None:
    tab.set_visible()
    tab.do("map-attractors")
    tab.set_visible(False)
    tab.set_visible()
    assert tab.last("map-attractors")["status"] == "waiting"


def test_a_click_turns_both_knobs(tab: PageUnderTest) -> None:
    tab.do("map-choose", x=1900.0, y=1e-7)
    ((scene, state, mode),) = tab.host.shown
    assert (scene.f, scene.A0, state, mode) == (1900.0, 1e-7, None, "settled")
