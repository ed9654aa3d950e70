"""Computations of the Observer page, without a browser: consecutive periods, nudges, and correct predictions."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from app.pages.observer.view import step_message
from app.pages.observer.work import NUDGE, ObserverRun
from granchain_core import scene, settle
from granchain_core.execution.stop import Stop
from granchain_core.scene.state import rest

FOUNDED = scene("fig11-founded")


def test_a_run_measures_what_its_multiplier_predicts() -> None:
    picture = settle(FOUNDED)
    run = ObserverRun(FOUNDED, picture, Stop(), None)
    assert run.predicted is None and "appears once the picture has settled" in run.sentence
    run.predict(picture)
    steps = [run.step() for _ in range(40)]
    assert steps[0].distance[0] == pytest.approx(NUDGE * np.sqrt(FOUNDED.N))
    ends, starts = ([step.distance[i] for step in steps] for i in (-1, 0))
    assert ends[:-1] == pytest.approx(starts[1:], abs=1e-12)  # one is taken from the dense output
    # the remainder of the other multipliers in the two-term recurrence (tests/observers/test_twin.py)
    assert run.measured == pytest.approx(run.predicted, rel=5e-3)
    assert "synchronises" in run.sentence


def test_an_orbit_of_two_periods_is_measured_over_two() -> None:
    # sec2 from rest has period 2 at 615 Hz (docs/lecture.md: on this peak, one push in two periods)
    shown = scene("sec2").evolve(f=615.0, kappa=0.001)
    picture = settle(shown)
    run = ObserverRun(shown, picture, Stop(), None)
    run.predict(picture)
    assert run.orbit is not None and run.orbit.period == 2
    for _ in range(60):
        run.step()
    assert run.measured == pytest.approx(run.predicted, rel=0.02)


def test_a_rate_is_shown_once_fast_modes_have_decayed() -> None:
    shown = scene("sec2").evolve(f=2500.0)  # a slow pair of multipliers, and an input force that jumps at closing
    picture = settle(shown)
    run = ObserverRun(shown, picture, Stop(), None)
    run.predict(picture)
    steps = [run.step() for _ in range(18)]
    assert run.predicted is not None and run.predicted > 0.98 and run.measured is None
    assert steps[0].largest_input == pytest.approx(picture.run.max_input_force, rel=picture.run.force_errors.input)
    for _ in range(82):
        run.step()
    assert run.measured == pytest.approx(run.predicted, rel=0.02)  # as for the orbit of two periods


def test_the_largest_force_is_that_of_all_periods_so_far() -> None:
    """At 1130 Hz, the driver pushes strongly in one of three periods."""
    shown = scene("sec2").evolve(f=1130.0)
    picture = settle(shown)
    run = ObserverRun(shown, picture, Stop(), None)
    told = [run.step().largest_input for _ in range(6)]
    assert told == sorted(told)
    assert told[2:] == pytest.approx([picture.run.max_input_force] * 4, rel=picture.run.force_errors.input)


def test_without_multipliers_the_run_says_why_and_continues() -> None:
    cut = FOUNDED.evolve(f=340.0, dissipation="tsuji", tension="cut")
    run = ObserverRun(cut, None, Stop(), None)
    run.predict(SimpleNamespace(regime=SimpleNamespace(period=1), state=rest(cut)))  # type: ignore[arg-type]
    assert run.predicted is None and "tension = cut" in run.sentence
    assert run.step().distance[0] > 0.0


def test_a_knob_that_is_turned_goes_on_from_where_both_are() -> None:
    free = scene("fig11-free")
    picture = settle(free)
    first = ObserverRun(free, picture, Stop(), None)
    first.predict(picture)
    last = [first.step() for _ in range(12)][-1]
    assert "drifts" in first.sentence
    second = ObserverRun(FOUNDED, None, Stop(), first)
    step = second.step()
    assert step.number == 12 and step.distance[0] == pytest.approx(last.distance[-1])
    fewer = ObserverRun(FOUNDED.evolve(N=5), None, Stop(), second)
    assert fewer.step().chain.shape[1] == 5


def test_wishes_move_the_observer_alone_and_the_message_is_whole() -> None:
    run = ObserverRun(FOUNDED, settle(FOUNDED), Stop(), None)
    run.step()
    chain = run.pair.states[0].displacement
    run.from_rest()
    assert np.array_equal(run.pair.states[0].displacement, chain) and not run.pair.states[1].displacement.any()
    run.nudge()
    assert np.sqrt(np.mean(run.pair.states[1].displacement ** 2)) == pytest.approx(NUDGE * FOUNDED.A0)
    step = run.step()
    message = step_message(step, FOUNDED, True)
    n, rows = FOUNDED.N, len(step.distance)
    assert message["values"].shape == (rows * (2 * (3 * n + 2) + 1),) and message["values"].dtype == np.float32
    assert message["values"][-rows:] == pytest.approx(step.distance, rel=1e-6)
