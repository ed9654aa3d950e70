"""Errors of an orbit are those of the stroboscopic map, times a factor from the orbit's contraction."""

from __future__ import annotations

from dataclasses import replace
from typing import Any
from unittest.mock import create_autospec

import numpy as np
import pytest

from granchain_core import scene
from granchain_core.integrate import Engine, MethodSetting, dop853_setting
from granchain_core.results.regime import Regime
from granchain_core.steady.orbit_errors import errors_of_map, errors_of_two_orbits
from granchain_core.steady.settling import recording, single_chain
from granchain_core.steady.settling.advance import run_until_settled

pytestmark = pytest.mark.quick


def called_as(function: Any, answer: object) -> Any:
    """Return a replacement for a function that returns `answer` and has the same signature."""
    return create_autospec(function, return_value=answer)


def test_a_chance_agreement_counts_as_the_typical_error_of_the_map() -> None:
    """From one state, the contraction also amplifies the change; for two orbits, their distance is the difference."""
    change = np.array([0.0, 1e-6, 1e-3])
    assert errors_of_map(change, 1e-5, 0.9) == pytest.approx([1e-4, 1e-4, 2e-2], rel=1e-12)
    assert errors_of_two_orbits(change, 1e-5, 0.9) == pytest.approx([1e-4, 1e-4, 2e-3], rel=1e-12)


def test_an_error_of_the_map_moves_its_fixed_point_by_more(monkeypatch: pytest.MonkeyPatch) -> None:
    """If a tenth of a distance remains after an orbit, the settled error is e/(1 − 1/10); with nine tenths, it is 10 e.
    """
    settling = run_until_settled(scene("sec2"), None, None)
    engine = Engine(settling.scene, MethodSetting("rk4-split"), 16)
    engine.start(settling.engine.state)
    monkeypatch.setattr(recording, "refined_orbit", called_as(recording.refined_orbit, (engine, 0.0)))
    stated = []
    for decay in (0.1, 0.9):
        settling.regime = replace(settling.regime, observed_contraction=decay, multiplier=None)
        stated.append(recording.recorded_orbit(settling, 16, 0.0, "rest").run.displacement_error)
    assert stated[1] == pytest.approx(9.0 * stated[0], rel=1e-12)


def test_the_forces_of_a_curve_have_the_same_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """The factor 1/(1 − |μ|) is the same for a point of a curve that was settled alone."""
    settling = run_until_settled(scene("sec2"), None, None)
    monkeypatch.setattr(single_chain, "run_until_settled", called_as(single_chain.run_until_settled, settling))
    refined_orbit = single_chain.refined_orbit
    stated = []
    for modulus in (0.1, 0.9):
        engine = Engine(settling.scene, dop853_setting(1e-6), 1)
        engine.start(settling.engine.state)
        monkeypatch.setattr(single_chain, "refined_orbit", called_as(refined_orbit, (engine, 0.0)))
        settling.regime = replace(settling.regime, multiplier=modulus)
        stated.append(single_chain.settle_to_forces(settling.scene, None, settling.stop).errors)
    assert stated[1] == pytest.approx(9.0 * stated[0], rel=1e-12)


def test_the_contraction_of_a_bound_is_capped() -> None:
    """It is the multiplier, at most 1 − 1e-6; without one, the decay, at most 0.9999; without either, 0.5."""
    def contraction(decay: float | None, multiplier: float | None) -> float:
        return Regime("periodic", 1, decay, None, 1, multiplier=multiplier).assumed_contraction

    assert contraction(0.2, 0.9) == 0.9 and contraction(None, 1.0) == 1.0 - 1e-6
    assert contraction(0.2, None) == 0.2 and contraction(1.0, None) == 0.9999
    assert contraction(None, None) == 0.5
