"""dop853 misses no touch, however brief, and finds its exact time; a symmetric motion stays symmetric."""

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
    """Return random touches and near misses, and the results of dop853."""
    cases = touches.draw(COUNT, 7, driven)
    return cases, touches.run(cases, driven)


@pytest.mark.parametrize("driven", [True, False])
def test_no_touch_is_missed_and_none_is_invented(driven: bool) -> None:
    """The amplitude is larger or smaller than the gap by 1e-7 to 1e-2, and the bead touches exactly if it is larger.

    A thrown bead's own motion is computed to 1e-11 or better, a ten-thousandth of the smallest depth.
    """
    cases, seen = found(driven)
    assert len(touches.missed(cases, seen)) == 0


def test_the_moment_of_a_touch_is_exact() -> None:
    """At every tolerance, the driver reaches a resting bead at asin(gap)/β, to 1e-12 of a period, however slowly it
    approaches: at a depth of 1e-7, rounding of its displacement is 1e-13 of a period.
    """
    cases, seen = found(True)
    assert (seen[cases[:, touches.DEPTH] > 0.0, touches.CLOSING_ERROR] < 1.2e-12).all()


def test_the_moment_of_a_release_is_exact() -> None:
    """If a touch moves the bead by less than that, the driver releases it at π − asin(gap), to the same 1e-12."""
    cases, seen = found(True)
    exact = (cases[:, touches.DEPTH] > 0.0) & (touches.moved(cases) < 1e-13)
    assert exact.sum() > 50
    assert (seen[exact, touches.OPENING_ERROR] < 1.2e-12).all()


def test_a_thrown_bead_touches_when_its_own_motion_lets_it() -> None:
    """The time is asin(gap)/ω, to ten tolerances of displacement over the speed √(2·depth) at which the bead arrives.
    """
    cases, seen = found(False)
    hit = cases[:, touches.DEPTH] > 0.0
    allowed = 1e-12 + 10.0 * cases[hit, touches.TOLERANCE] / np.sqrt(2.0 * cases[hit, touches.DEPTH])
    assert (seen[hit, touches.CLOSING_ERROR] < allowed).all()


@pytest.mark.parametrize("tolerance", [1e-13, 1e-12])
def test_two_touches_in_one_step_are_both_found(tolerance: float) -> None:
    """They are 1e-13 to 0.03 of a period apart, in either order, and each is found at its own time to ten tolerances.
    """
    seen = touches.run_pairs(300, 3, tolerance)
    assert (seen[:, 1:] < 10.0 * tolerance).all()


@pytest.mark.parametrize("beads", [2, 5, 8])
@pytest.mark.parametrize("tolerance", [1e-5, 1e-9, 1e-13])
def test_simultaneous_contacts_stay_symmetric(beads: int, tolerance: float) -> None:
    """Beads thrown as mirror images between two walls stay mirror images through about a hundred pairs of events.

    The tolerance of 1e-13 of an amplitude allows for the rounding of a hundred events.
    """
    chain = Bench(beads, 200.0, 64, LinearDashpot(0.1), tolerance=tolerance)
    velocity = np.random.default_rng(beads).uniform(-1.0, 1.0, beads)
    chain.throw(velocity - velocity[::-1])
    kept = chain.record()
    assert chain.engine.counts.events > 5
    assert np.abs(kept.displacement + kept.displacement[:, ::-1]).max() < 1e-13
