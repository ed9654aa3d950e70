"""An orbit found by Newton's method confirms a claimed period only if it is stable and near the motion."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from granchain_core import orbit, scene, settle
from granchain_core.integrate import Engine, MethodSetting
from granchain_core.results.regime import Regime
from granchain_core.steady.settling import regime_decisions
from granchain_core.steady.settling.regime_decisions import Decisions, regime_without_continuing

pytestmark = pytest.mark.quick

#: A claim with a slow decay, which multipliers have to confirm.
CLAIM = Regime("periodic", 3, 0.97, 1e-7, 400)


def decided(monkeypatch: pytest.MonkeyPatch, **found: Any) -> tuple[Regime, Regime, np.ndarray | None]:
    """Return the regimes of a settled and of a recorded motion, and the new state of the settled one."""
    orbit = SimpleNamespace(**{"period": 3, "modulus": 0.4, "stable": True, "unstable": False, "approached": lambda: False,
                               "distance_of_motion": 1e-6, "point": SimpleNamespace(x=np.ones(22))} | found)
    monkeypatch.setattr(regime_decisions, "orbit_of", lambda *words: orbit)
    monkeypatch.setattr(regime_decisions, "seen_modulus", lambda *words, **more: 0.99)
    chain = scene("sec2")
    engine = Engine(chain, MethodSetting("rk4-split"), 1)
    engine.start_scaled(np.zeros(2 * chain.N))
    strobes = np.zeros((10, 2, chain.N))
    settled = Decisions(chain, True).decide(engine, strobes, CLAIM)
    assert settled.regime is not None
    return settled.regime, regime_without_continuing(engine, strobes, CLAIM), settled.state


def test_a_stable_orbit_where_the_motion_is_confirms_its_period(monkeypatch: pytest.MonkeyPatch) -> None:
    settled, recorded, state = decided(monkeypatch)
    assert settled == recorded == replace(CLAIM, multiplier=0.4)
    assert state is not None


def test_an_orbit_far_from_the_motion_is_not_its_own(monkeypatch: pytest.MonkeyPatch) -> None:
    settled, recorded, state = decided(monkeypatch, distance_of_motion=5.0)
    assert settled.name == recorded.name == "unsettled"
    assert settled.multiplier is None and state is None


def test_a_motion_does_not_approach_an_unstable_orbit(monkeypatch: pytest.MonkeyPatch) -> None:
    settled, recorded, _ = decided(monkeypatch, modulus=1.02, stable=False)
    assert settled.name == recorded.name == "unsettled"
    assert settled.approaches is None and settled.multiplier is None
    assert settled.sentence == "not settled after 400 periods"


def test_a_clear_multiplier_shown_is_that_of_the_flow_to_the_stated_error() -> None:
    """One-sided differences at the motion's own state are good to about 1e-4."""
    settled = settle(scene("sec2").evolve(f=250.0))
    multiplier, exact = settled.regime.multiplier, orbit(settled.run.scene, 2, settled.state)
    assert settled.regime.period == 2 and multiplier is not None and multiplier <= regime_decisions._CLEAR_MULTIPLIER
    assert multiplier == pytest.approx(np.abs(exact.multipliers).max(), abs=1e-4)
