"""A claimed period is confirmed by the orbit itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from granchain_core import scene
from granchain_core.integrate import Engine, MethodSetting
from granchain_core.steady import regime_criteria
from granchain_core.steady.settling.regime_decisions import Decisions, regime_without_continuing

pytestmark = pytest.mark.quick


def test_a_motion_that_settles_alternating_has_the_period_of_its_orbit() -> None:
    """The rig at 60 Hz and 11 µm approaches its orbit with μ = −0.92: after 125 periods, the bound is met for two
    periods, but not yet for one. A claim of period 2 is traced back to the orbit, which has period 1.
    """
    chain = scene("fig12-60")
    engine = Engine(chain, MethodSetting("rk4-split"), 1)
    engine.start_scaled(np.zeros(2 * chain.N))
    strobes = engine.periods(150)[0]
    claimed = replace(regime_criteria.find_period(strobes), name="periodic", period=2, observed_contraction=0.92**2)
    for decided in (Decisions(chain, False).decide(engine, strobes, claimed).regime,
                    regime_without_continuing(engine, strobes, claimed)):
        assert decided is not None and (decided.name, decided.period) == ("periodic", 1)
        assert decided.multiplier == pytest.approx(0.92, abs=0.01)
        assert decided.observed_contraction is None, "0.92² is the decay over two periods"
