"""The Stability view, without a browser: its text, its computations, and when it computes nothing."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from page_host import FakePageHost

from app.pages.stability import page as module
from app.pages.stability import work
from app.pages.stability.page import StabilityPage
from app.pages.stability.view import (
    evidence,
    multiplier_sentence,
    no_multipliers,
    section_message,
    section_points,
    verdict,
)
from app.pages.stability.work import OrbitAnalysis, OrbitTarget, analyse, search, section_of, transient
from app.session.session import Session
from granchain_core import BadInput, ComputationError, Settled, scene, settle
from granchain_core.execution.stop import Stop
from granchain_core.results.regime import Regime, exponent_words, modulus_words


@cache
def picture(name: str = "sec2", **knobs: Any) -> Settled:
    """Return a settled picture."""
    return settle(scene(name).evolve(**knobs), samples=96)


@cache
def analysis(**knobs: Any) -> OrbitAnalysis:
    """Return the analysis of a settled picture of sec2."""
    found = picture(**knobs)
    assert found.regime.period is not None
    return analyse(OrbitTarget(found.run.scene, found.regime.period, found.state, True), False, 0, Stop())


def with_leading(*leading: complex) -> Any:
    """Return the orbit of sec2 with other leading multipliers."""
    rest = np.full(22 - len(leading), 0.01 + 0j)
    return replace(analysis().orbit, multipliers=np.concatenate([np.array(leading, dtype=complex), rest]))


def test_the_words_of_a_stable_orbit_have_the_rest_of_a_disturbance() -> None:
    assert verdict(analysis().orbit) == ("Stable: a disturbance shrinks to 0.36 of itself in one period of the orbit "
                                         "(1 drive period, 2.94 ms).")
    assert "(3 drive periods, 2.65 ms)" in verdict(analysis(f=1130.0).orbit)


@pytest.mark.parametrize(("leading", "words"), [
    ((1.8,), "1.80-fold in one period of the orbit (1 drive period, 2.94 ms) and leaves to one side: a multiplier above +1, as "
             "beyond a fold."),
    ((-1.5,), "changes sides in each orbit: a multiplier below −1, as beyond a period doubling."),
    ((1.2j, -1.2j), "turns while it grows: a complex pair outside the circle, as beyond a Neimark–Sacker bifurcation."),
    ((-1.5, 1.2j, -1.2j), "3 multipliers are outside the circle."),
])
def test_the_words_of_an_unstable_orbit_have_the_way_it_is_left(leading: tuple[complex, ...], words: str) -> None:
    said = verdict(with_leading(*leading))
    assert said.startswith("Unstable") and words in said
    assert ("multipliers are outside" in said) == (len(leading) == 3)


def test_a_multiplier_within_its_error_of_one_is_undecided() -> None:
    orbit = with_leading(-1.00000001)
    orbit.__dict__["multiplier_errors"] = np.full(len(orbit.multipliers), 2e-8)
    assert verdict(orbit).startswith("Not decided: a |μ| is 1.000000 ± 2e-8, no farther from 1 than its error")


def test_the_observer_is_described_if_requested() -> None:
    orbit = replace(analysis().orbit, observer_multipliers=np.array([-4.2, 0.1], dtype=complex))
    assert verdict(orbit).endswith("Its observer is unstable, |μ| 4.20.")


@pytest.mark.parametrize(("value", "words"), [
    (0.361, "0.36"), (0.0995, "0.10"), (0.0123, "0.012"), (3.2e-5, "3e-5"), (0.9939, "0.9939"), (1.00002, "1.000020"),
    (1.57, "1.57"),
])
def test_moduli_are_printed_different_from_one_and_zero(value: float, words: str) -> None:
    assert modulus_words(value) == words


@pytest.mark.parametrize(("exponent", "error", "words"), [
    (0.2651, 0.0234, "+0.265 ± 0.023"), (-0.00071, 0.00027, "-0.00071 ± 0.00027"), (0.85, 0.104, "+0.85 ± 0.10"),
    (0.1, 0.0, "+0.100 ± 0.000"), (1e-12, 1e-12, "+0.0000000 ± 0.0000000"), (3.1, 2.0, "+3.1 ± 2.0")])
def test_an_exponent_has_the_figures_that_its_error_allows(exponent: float, error: float, words: str) -> None:
    assert exponent_words(exponent, error) == words


def test_a_chosen_multiplier_is_described_and_a_missing_one_is_the_last() -> None:
    orbit = with_leading(-1.5)
    assert multiplier_sentence(orbit, 0) == "ringed: μ = −1.5000, |μ| 1.50"
    assert multiplier_sentence(orbit, 99) == multiplier_sentence(orbit, 21)


def test_motions_that_do_not_repeat_have_no_multipliers() -> None:
    still = picture()
    chaotic = replace(still, regime=Regime("chaotic", None, None, None, 620, (0.265, 0.023)))
    assert "chaotic and never repeats. Neighbouring motions part 1.30-fold" in no_multipliers(chaotic)
    assert "+0.265 ± 0.023" in no_multipliers(chaotic)
    quasi = replace(still, regime=Regime("quasi-periodic", None, None, None, 620, (0.0001, 0.0004)))
    assert "neither part nor meet" in no_multipliers(quasi)
    assert "not settled after 620 periods" in no_multipliers(replace(still, regime=Regime.unsettled(620)))


def test_the_evidence_has_a_row_for_what_was_computed_only() -> None:
    names = [row["name"] for row in evidence(picture(), analysis(), None)]
    assert names == ["regime", "distance to the orbit", "|μ| largest", "Newton's residual", "settled state", "product of all μ",
                     "disturbance followed", "multipliers by", "settled by"]
    rows = {row["name"]: row["value"] for row in evidence(picture(), analysis(), None)}
    largest = re.fullmatch(r"(\S+) ± (\S+); (\S+) per orbit seen while it settled", rows["|μ| largest"])
    assert largest is not None
    size, error, decay = largest.groups()
    assert re.fullmatch(r"0\.36\d{4}", size) and 1e-12 < float(error) < 1e-7 and decay.startswith("0.4")
    assert " → " in rows["Newton's residual"] and float(rows["product of all μ"].removesuffix(" off")) < 1e-6
    chaotic = replace(picture(), regime=Regime("chaotic", None, None, None, 620, (0.265, 0.023)))
    assert [row["name"] for row in evidence(chaotic, None, None)] == ["regime", "Lyapunov exponent", "settled by"]
    quasi = replace(picture(), regime=Regime("quasi-periodic", None, None, None, 840, (1e-3, 5e-3), return_distance=0.02,
                                             return_limit=0.15, window_ratios=(0.985, 1.012)))
    shown = {row["name"]: row["value"] for row in evidence(quasi, None, None)}
    assert list(shown) == ["regime", "Lyapunov exponent", "return of the section", "change from window to window",
                           "settled by"]
    assert shown["change from window to window"] == "0.985 to 1.012" and "limit 0.15" in shown["return of the section"]
    json.dumps(evidence(picture(), analysis(), None), allow_nan=False)


def test_multipliers_lost_in_rounding_decide_nothing() -> None:
    lost = replace(analysis(), orbit=replace(analysis().orbit, liouville_error=None))
    rows = {row["name"]: row["value"] for row in evidence(picture(), lost, None)}
    assert rows["product of all μ"] == "the smallest multipliers are below rounding"


def test_the_sections_points_are_the_computed_ones() -> None:
    found = picture(f=1130.0)
    *_, section = section_of(found, None, Stop())
    assert section.periods == max(24, found.regime.periods_run) == transient(found, section)
    shown = section_points(section, transient(found, section), analysis(f=1130.0).points, 3, 12)
    assert shown.units == ("nm", "mm/s") and (len(shown.points), len(shown.own)) == (section.periods, 3)
    assert shown.points == pytest.approx(section.points(3, 12) * [1e9, 1e3], rel=1e-5)
    # the orbit's own points are those of the final picture a quarter of a period later
    expected = np.stack([found.run.displacement[24:-1:96, 2], found.run.velocity[24:-1:96, 2]], axis=1) * [1e9, 1e3]
    assert np.abs(shown.own - expected).max() < 1e-4 * np.abs(expected).max()


def test_multipliers_that_contradict_the_motion_are_not_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    found = replace(analysis().mode, closure=0.06)
    monkeypatch.setattr(work, "mode", lambda *_: found)
    with pytest.raises(ComputationError, match=r"a small disturbance differs from their prediction by 0\.06 of its size"):
        analyse(analysis().target, False, 0, Stop())


def test_multipliers_of_another_orbit_are_not_shown_for_the_settled_one() -> None:
    shown = picture()
    far = replace(shown.state, displacement=1.01 * shown.state.displacement)
    with pytest.raises(ComputationError, match="ended 1e-02 away"):
        analyse(OrbitTarget(shown.run.scene, 1, far, True), False, 0, Stop())


class Page(FakePageHost):
    """The host of the page, with everything that the page shows and sends."""

    def __init__(self, mode: str = "settled") -> None:
        super().__init__()
        self.session = Session(scene=scene("sec2"), mode=mode)
        self.sent: list[dict[str, Any]] = []
        view: Any = SimpleNamespace(
            state={}, update_state=lambda **changes: view.state.update(changes),
            send=lambda **message: self.sent.append(message),
            need_figures=lambda: None, section=lambda shown: self.sent.append(section_message(shown)))
        self.view = view

    def work(self, until: Any, seconds: float = 60.0) -> None:
        """Run callbacks until a condition is true; none may fail."""
        self.run_callbacks_until(until, seconds)
        assert self.failures == [] and self.faults == []

    def marks(self, name: str) -> int:
        """Return the number of multipliers in a set of the plane."""
        return len(self.view.state["plane"][name]["data"]["x"])

    @property
    def state(self) -> dict[str, Any]:
        """The state of the view."""
        return dict(self.view.state)


@pytest.fixture
def page() -> Page:
    """A page without a picture."""
    return Page()


def opened(page: Page) -> StabilityPage:
    """The view, opened on the page."""
    view = StabilityPage(page, page.view)
    view.visibility_changed(True)
    return view


def test_nothing_is_computed_while_the_page_is_closed(page: Page, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "analyse", lambda *_: pytest.fail("computed"))
    view = StabilityPage(page, page.view)
    view.picture_ready(picture())
    page.work(lambda: not page.callbacks)
    assert view.activity[1] == "off" and "plane" not in page.state


def test_a_picture_that_stays_is_analysed(page: Page) -> None:
    view = opened(page)
    view.picture_ready(picture())
    page.work(lambda: page.state.get("status") == "done" and any(m["type"] == "section" for m in page.sent))
    assert page.state["sentence"].startswith("Stable") and page.marks("within") == 22
    assert not page.state["stale"] and not page.state["searched"] and page.marks("observer within") == 0
    mode = next(m for m in page.sent if m["type"] == "mode")
    assert mode["values"].dtype == np.float32 and len(mode["values"]) == 2 * 49 * 11
    assert view.activity[1] == "ready"
    # the same picture with its energy account changes nothing
    count = len(page.sent)
    view.picture_ready(replace(picture()))
    page.work(lambda: not page.callbacks)
    assert len(page.sent) == count
    page.leave()


def test_a_moved_knob_gives_up_and_greys(page: Page) -> None:
    view = opened(page)
    view.picture_ready(picture())
    page.work(lambda: page.state.get("status") == "done")
    view.picture_ready(replace(picture(), state=replace(picture().state)))
    view.picture_requested()
    assert page.state["stale"]
    page.work(lambda: not page.callbacks)
    assert page.state["stale"], "what was asked for before the knob moved is not computed"
    page.leave()


def test_the_observer_is_computed_when_it_is_switched_on(page: Page) -> None:
    view = opened(page)
    view.picture_ready(picture())
    page.work(lambda: page.state.get("status") == "done")
    view.actions["stability-observer"]({"value": True})
    page.work(lambda: page.marks("observer within") + page.marks("observer outside") == 22)
    view.actions["stability-mode"]({"value": 2})
    page.work(lambda: page.state.get("rank") == 2)
    page.leave()


def test_a_found_orbit_is_marked_and_left_again(page: Page) -> None:
    view = opened(page)
    view.picture_ready(picture(f=1576.0))
    page.work(lambda: page.state.get("status") == "done" and any(m["type"] == "section" for m in page.sent))
    assert page.state["period"] == 4
    view.actions["stability-search"]({"value": 1})
    page.work(lambda: page.state["searched"])
    assert page.state["period"] == 1 and page.state["sentence"].startswith("Unstable")
    view.actions["stability-back"]({})
    page.work(lambda: not page.state["searched"])
    assert page.state["period"] == 4
    page.leave()


def test_a_scene_without_multipliers_says_so_and_has_its_section(page: Page) -> None:
    page.session.scene = picture(tension="cut").run.scene
    view = opened(page)
    view.picture_ready(picture(tension="cut"))
    page.work(lambda: page.state.get("status") == "failed" and any(m["type"] == "section" for m in page.sent))
    assert "multipliers are not computed" in page.state["sentence"] and page.marks("within") == 0
    page.leave()


def test_the_followed_orbit_is_not_called_another_one() -> None:
    for found, period in ((picture(), 1), (picture(f=1130.0), 3)):
        *_, section = section_of(found, None, Stop())
        with pytest.raises(ComputationError, match=f"the orbit that the chain follows, of {period} drive period"):
            search(found, section, period, Stop())


def test_a_live_run_has_no_multipliers() -> None:
    page = Page(mode="live")
    opened(page)
    assert "live run is under way" in page.state["sentence"] and page.marks("within") == 0


@pytest.mark.parametrize(("action", "message"), [
    ("stability-search", {"value": 99}), ("stability-search", {"value": 1.5}), ("stability-search", {"value": "one"}),
    ("stability-mode", {"value": True}),
    ("stability-section", {"bead": 0, "phase": 0}), ("stability-section", {"bead": 1, "phase": 48}), ("stability-section", {}),
])
def test_invalid_requests_get_a_sentence(page: Page, action: str, message: dict[str, Any]) -> None:
    with pytest.raises(BadInput, match="is not a whole number from"):
        opened(page).actions[action](message)


def test_a_search_before_there_is_a_picture_is_refused(page: Page) -> None:
    with pytest.raises(BadInput, match="no settled picture"):
        opened(page).actions["stability-search"]({"value": 1})
