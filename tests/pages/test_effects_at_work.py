"""The Effects tab, without a browser: effects are measured one after the other, while nothing else is running."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future
from typing import Any

import pytest
from page_host import PageUnderTest, picture

from app.pages.effects import page as module
from app.serve.compiling.compiler import COMPILER
from app.session.switches import SWITCHES, present, variants
from granchain_core import BadInput
from granchain_core.accuracy.effect_cost import EffectCost

#: The effects of the picture's scene whose cost is measured.
MEASURED = [name for name in SWITCHES if variants(name, picture().run.scene) is not None]


@pytest.fixture
def tab(page_of: Callable[[str], PageUnderTest], monkeypatch: pytest.MonkeyPatch) -> PageUnderTest:
    """The tab, with measurements that take no time."""
    monkeypatch.setattr(module, "effect_cost", lambda with_it, without, method, stop, pause: EffectCost(30.0, 20.0, 10.0, 1.0))
    return page_of("effects")


def row(tab: PageUnderTest, name: str) -> dict[str, Any]:
    """Return the panel's entry for an effect."""
    return next(effect for effect in tab.state["panel"]["effects"] if effect["name"] == name)


def test_effects_are_measured_one_after_the_other_while_the_tab_is_open(tab: PageUnderTest) -> None:
    tab.set_visible()
    assert [submitted.pool for submitted in tab.submitted] == ["measurements"] and row(tab, MEASURED[0])["state"] == "measuring …"
    for _ in MEASURED:
        tab.compute()
    assert row(tab, MEASURED[-1])["code"]["difference"] == 10.0 and row(tab, MEASURED[0])["motion"]["percent"] == 50.0
    assert tab.page.activity == ("cost of effects", "ready", f"{len(MEASURED)} of {len(MEASURED)} effects measured")
    assert tab.state["panel"]["step"] == {"rk4": 20.0, "rk4-split": 20.0}, "the last effect measured is not present"
    assert tab.under_way == []


def test_reopening_the_tab_does_not_start_a_second_list(tab: PageUnderTest, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tab.host, "awaiting_picture", True)
    for visible in (True, False, True, False, True):
        tab.set_visible(visible)
    tab.run_callbacks()
    assert len(tab.host.callbacks) == 1, "one list, one repetition"
    tab.set_visible(False)
    tab.run_callbacks()
    assert tab.host.callbacks == []


def test_nothing_is_measured_before_the_knobs_rest_and_the_picture_is_there(tab: PageUnderTest) -> None:
    tab.host.awaiting_picture = True
    tab.set_visible()
    assert tab.under_way == []
    tab.host.awaiting_picture = False
    tab.move_knobs(f=2100.0)
    tab.host.callbacks.clear()
    tab.set_visible()
    assert tab.under_way == [], "the knob has just moved"
    tab.move_knobs(f=2150.0)
    tab.run_callbacks()
    assert len(tab.under_way) == 1
    tab.host.curve_computing = True
    tab.compute()
    assert tab.under_way == []


def test_costs_are_kept_for_other_values_and_dropped_for_another_kernel(tab: PageUnderTest) -> None:
    tab.move_knobs(f=2100.0)  # from here on, it knows its kernel
    tab.set_visible()
    tab.run_callbacks()
    tab.compute()
    assert row(tab, MEASURED[0])["code"] is not None
    tab.move_knobs(f=2200.0)
    assert row(tab, MEASURED[0])["code"] is not None
    begun = tab.under_way
    tab.move_knobs(N=3)
    assert row(tab, MEASURED[0])["code"] is None and all(submitted.job.stop for submitted in begun)


def test_a_missing_kernel_is_compiled_first_and_a_failure_is_named(
        tab: PageUnderTest, monkeypatch: pytest.MonkeyPatch) -> None:
    compilation: Future[None] = Future()
    monkeypatch.setattr(COMPILER, "has", lambda scene, *pieces: "cost" not in pieces)
    monkeypatch.setattr(module, "COST_KERNELS", "cost")
    monkeypatch.setattr(module, "COST_ACCOUNT_KERNELS", "cost")
    monkeypatch.setattr(COMPILER, "ask", lambda *_: compilation)
    tab.set_visible()
    assert tab.under_way == [] and row(tab, MEASURED[0])["state"] == "compiling its kernel …"
    assert tab.activity[2].startswith("compiling a kernel for ")
    compilation.set_exception(OSError("no room"))
    tab.run_callbacks()
    assert row(tab, MEASURED[0])["state"] == "its kernel could not be compiled"


def test_a_switch_turns_knobs_and_a_wrong_one_is_refused(tab: PageUnderTest) -> None:
    tab.set_visible()
    tab.do("switch", name="dashpot", value=False)
    ((scene, state, mode),) = tab.host.shown
    assert not present("dashpot", scene, False) and (state, mode) == (None, "settled")
    with pytest.raises(BadInput, match="There is no effect 'gravity field' to switch"):
        tab.do("switch", name="gravity field", value=True)
