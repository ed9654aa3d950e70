"""The regimes that are known: periods 1, 2, 3, 4 of section 2, and a rig that is irregular where it should be."""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core import run, scene, settled
from granchain_core.steady import regime_criteria


@pytest.mark.parametrize(("f", "period"), [(340.0, 1), (615.0, 2), (1130.0, 3), (1576.0, 4)])
def test_section_2_from_rest_has_its_periods(f, period):
    """One push in 1, 2, 3, 4 periods on the peaks (docs/lecture.md); the picture of the orbit closes on itself and says
    how exactly.
    """
    found = settled(scene("sec2").evolve(f=f))
    assert (found.regime.name, found.regime.period) == ("periodic", period)
    kept = found.run
    assert len(kept.time) == period * kept.samples + 1
    largest = np.abs(kept.displacement).max()
    # the orbit is followed to the error claimed, so its two ends differ by no more than twice that
    assert np.abs(kept.displacement[-1] - kept.displacement[0]).max() < 2 * kept.displacement_error * largest
    assert kept.displacement_error < 1e-5


@pytest.mark.parametrize("f", [340.0, 1130.0])
def test_settled_orbit_is_where_a_long_plain_run_ends(f):
    """Extrapolation and relaxation lead to the attractor the chain goes to by itself."""
    chain = scene("sec2").evolve(f=f, accuracy=1e-7)
    found = settled(chain)
    n = found.regime.period
    plain = run(chain, periods=600 * n, record=n, samples=96)
    largest = np.abs(plain.displacement).max()
    # phase of an n-periodic orbit: one of its n shifts
    distance = min(np.abs(np.roll(found.run.displacement[:-1], 96 * q, axis=0) - plain.displacement[:-1]).max()
                   for q in range(n))
    assert distance < 1e-5 * largest  # a hundred times the accuracy: both carry it, amplified by 1/(1 − |μ|)


def test_the_founded_rig_at_140_hz_is_chaotic():
    """κ = 0.001, f = 140 Hz: a positive exponent, and its evidence."""
    found = settled(scene("rig").evolve(f=140.0))
    assert found.regime.name == "chaotic"
    exponent, error = found.regime.lyapunov
    assert exponent > 3 * error
    assert found.run.displacement_error is None, "no error may be claimed for a chaotic picture"


@pytest.mark.parametrize("f", [45.0, 80.0, 120.0])
def test_the_rig_without_its_foundation_is_not_periodic(f):
    """κ = 0: irregular everywhere in 20–160 Hz."""
    assert settled(scene("rig").evolve(f=f, k=0.0)).regime.name != "periodic"


def test_windows_hold_the_largest_changes_oldest_first() -> None:
    """Found in one pass over the record, they are those of every change by itself; a short record has none.

    The compiler may divide by the scale in one kernel and multiply by its reciprocal in the other: two roundings.
    """
    strobes = np.random.default_rng(3).standard_normal((regime_criteria.SLOW_RECORD, 2, 3))
    seen = regime_criteria._windows(strobes)
    for n, found in enumerate(seen, 1):
        each = regime_criteria.changes(strobes, n, 3 * regime_criteria._SLOW_WINDOW)
        np.testing.assert_allclose(found, each.reshape(3, -1).max(axis=1), rtol=2 * np.finfo(float).eps)
    assert len(seen) == regime_criteria.LONGEST_PERIOD and len(regime_criteria._windows(strobes[1:])) == 0
