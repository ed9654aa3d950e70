"""dop853 misses no touch, however brief, and times each exactly; a symmetric motion stays symmetric."""

from __future__ import annotations

import functools

import numpy as np
import pytest
import touches

from granchain_core.hard_cases.chains import Bench
from granchain_core.kernels.effects.dissipation import LinearDashpot

COUNT = 2000


@functools.cache
def found(driven: bool) -> tuple[np.ndarray, np.ndarray]:
    """Random touches and near misses, and what dop853 made of them."""
    cases = touches.draw(COUNT, 7, driven)
    return cases, touches.run(cases, driven)


@pytest.mark.parametrize("driven", [True, False])
def test_no_touch_is_missed_and_none_is_invented(driven: bool) -> None:
    """By 1e-7 to 1e-2 of an amplitude, or short of it by as much: exactly those with amplitude above the gap touch.

    A thrown bead's own motion is computed to 1e-11 at the worst, a ten-thousandth of the least depth.
    """
    cases, seen = found(driven)
    assert len(touches.missed(cases, seen)) == 0


def test_the_moment_of_a_touch_is_exact() -> None:
    """The driver reaches a resting bead at asin(gap)/β to 1e-12 of a period at every tolerance, as slowly as it may
    come: at a depth of 1e-7 a rounding of its displacement is 1e-13 of a period.
    """
    cases, seen = found(True)
    assert (seen[cases[:, touches.DEPTH] > 0.0, touches.CLOSING_ERROR] < 1.2e-12).all()


def test_the_moment_of_a_release_is_exact() -> None:
    """Where a touch moves the bead by less than that the driver lets go at π − asin(gap), to the same 1e-12."""
    cases, seen = found(True)
    exact = (cases[:, touches.DEPTH] > 0.0) & (touches.moved(cases) < 1e-13)
    assert exact.sum() > 50
    assert (seen[exact, touches.OPENING_ERROR] < 1.2e-12).all()


def test_a_thrown_bead_touches_when_its_own_motion_lets_it() -> None:
    """asin(gap)/ω, to ten tolerances of its displacement over the speed √(2·depth) at which it arrives."""
    cases, seen = found(False)
    hit = cases[:, touches.DEPTH] > 0.0
    allowed = 1e-12 + 10.0 * cases[hit, touches.TOLERANCE] / np.sqrt(2.0 * cases[hit, touches.DEPTH])
    assert (seen[hit, touches.CLOSING_ERROR] < allowed).all()


@pytest.mark.parametrize("tolerance", [1e-13, 1e-12])
def test_two_touches_in_one_step_are_both_found(tolerance: float) -> None:
    """1e-13 to 0.03 of a period apart, the one or the other first: each at its own moment, to ten tolerances."""
    seen = touches.run_pairs(300, 3, tolerance)
    assert (seen[:, 1:] < 10.0 * tolerance).all()


@pytest.mark.parametrize("beads", [2, 5, 8])
@pytest.mark.parametrize("tolerance", [1e-5, 1e-9, 1e-13])
def test_simultaneous_contacts_stay_symmetric(beads: int, tolerance: float) -> None:
    """Thrown as mirror images between two walls, the beads stay mirror images through some hundred pairs of events.

    1e-13 of an amplitude: what a hundred events leave of roundings.
    """
    chain = Bench(beads, 200.0, 64, LinearDashpot(0.1), tolerance=tolerance)
    velocity = np.random.default_rng(beads).uniform(-1.0, 1.0, beads)
    chain.throw(velocity - velocity[::-1])
    kept = chain.record()
    assert chain.engine.counts.events > 5
    assert np.abs(kept.displacement + kept.displacement[:, ::-1]).max() < 1e-13
