"""A batch and a single chain find the same regime with the same evidence, even if the batch leaves a point undecided.
"""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core import resonance_curve, scene, settle
from granchain_core.steady.batch import jobs_in_batch

pytestmark = pytest.mark.quick


def test_a_batch_leaves_long_orbits_to_a_chain_alone() -> None:
    """At 1087 Hz, there is an orbit of 18 periods with |μ| = 0.3. Both ways find it, although a batch only searches up
    to 16 periods.
    """
    chain = scene("sec2").evolve(f=1087.0)
    alone, (together,) = settle(chain).regime, resonance_curve(chain, [1087.0]).points
    assert (alone.name, alone.period) == (together.regime.name, together.regime.period) == ("periodic", 18)


def test_an_approach_slower_than_the_bias_of_a_torus_is_measured_until_it_shows() -> None:
    """Its mean exponent is −0.008 over 220 to 420 periods, which a torus may have as well; |μ| is 0.8 to 0.9."""
    chain = scene("sec2").evolve(A0=8e-7)
    regimes = [settle(chain.evolve(f=1226.208)).regime, resonance_curve(chain, [1226.208]).points[0].regime]
    assert [(one.name, one.period) for one in regimes] == [("periodic", 18)] * 2


def test_a_slow_approach_with_a_zero_exponent_is_left_to_a_chain_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """At 1206.2 to 1206.3 Hz, the motion approaches an orbit of 6 periods so slowly that its exponent is neutral;
    without the rule, a batch would label it quasi-periodic.
    """
    frequencies = [1206.2, 1206.22, 1206.28, 1206.3]
    regimes = [point.regime for point in resonance_curve(scene("sec2"), frequencies).points]
    assert [(one.name, one.period) for one in regimes] == [("periodic", 6)] * 4
    monkeypatch.setattr(jobs_in_batch, "is_almost_periodic", lambda strobes: False)
    without = [point.regime.name for point in resonance_curve(scene("sec2"), frequencies).points]
    assert "quasi-periodic" in without


def test_one_chain_and_a_batch_have_the_same_evidence() -> None:
    """At 1700 Hz, the motion is quasi-periodic. Both ways judge records of the same length, up to the end of the
    exponent measurement.
    """
    chain = scene("sec2").evolve(f=1700.0)
    alone, (together,) = settle(chain).regime, resonance_curve(chain, [1700.0]).points
    assert alone.name == together.regime.name == "quasi-periodic"
    assert alone.return_limit == together.regime.return_limit == pytest.approx(10.0 * np.pi / 210.0)
    for one in (alone, together.regime):
        assert one.return_distance is not None and one.return_distance < one.return_limit
        assert one.window_ratios is not None and one.window_ratios[0] <= 1.02 and one.window_ratios[1] >= 0.98
