"""The criterion for almost periodic motions, which are compared with a nearby orbit."""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core.steady.regime_criteria import changes
from granchain_core.steady.settling.nearby_orbit import is_almost_periodic

pytestmark = pytest.mark.quick


def nearly_repeating(change: float) -> np.ndarray:
    """Return a rotation that repeats after 3 periods up to this relative change."""
    turns = np.exp(1j * (2.0 * np.pi / 3.0 + change / 3.0) * np.arange(421))
    return np.stack([np.stack([turns.real, turns.imag], 1), np.stack([turns.imag, -turns.real], 1)], 1)


@pytest.mark.parametrize(("change", "almost"), [(0.0, True), (5e-4, True), (9e-4, True), (1.2e-3, False), (0.1, False)])
def test_changes_below_a_thousandth_are_almost_periodic(change: float, almost: bool) -> None:
    assert is_almost_periodic(nearly_repeating(change)) is almost


def test_a_slow_passage_on_a_closed_curve_is_not_almost_periodic() -> None:
    """Section 2's chain at 780 Hz hardly moves along its curve for about twenty periods, and then moves on."""
    steps = np.where(np.arange(421) < 400, 0.05, 1e-5)
    angle = np.cumsum(steps)
    slow = np.stack([np.stack([np.cos(angle), np.sin(angle)], 1), np.stack([np.sin(angle), -np.cos(angle)], 1)], 1)
    assert changes(slow, 1, 16).max() < 1e-3 and not is_almost_periodic(slow)


def test_a_rotation_or_a_short_record_is_not_almost_periodic() -> None:
    """The golden angle returns to within 2π/(√5·13) after 13 periods; 32 changes over 16 periods need 48 states."""
    turns = np.exp(2j * np.pi * 0.6180339887498949 * np.arange(421))
    rotation = np.stack([np.stack([turns.real, turns.imag], 1), np.stack([turns.imag, -turns.real], 1)], 1)
    assert not is_almost_periodic(rotation) and not is_almost_periodic(nearly_repeating(0.0)[:47])
    assert is_almost_periodic(nearly_repeating(0.0)[:48])
