"""What a batch reports of a motion whose Lyapunov exponent was measured twice."""

from __future__ import annotations

from dataclasses import replace

import pytest

from granchain_core.regime import Regime
from granchain_core.steady.batch.results import decided


def measured(name: str, exponent: float) -> Regime:
    """A regime with its exponent, known to 1e-4."""
    return replace(Regime.unsettled(800), name=name, lyapunov=(exponent, 1e-4))


NEUTRAL, CHAOS = measured("quasi-periodic", 0.0), measured("chaotic", 0.04)


@pytest.mark.parametrize(("last", "before", "sure", "name", "clear"), [
    (NEUTRAL, NEUTRAL, False, "quasi-periodic", True),
    (NEUTRAL, CHAOS, False, "unsettled", False),
    (CHAOS, measured("chaotic", 0.02), False, "unsettled", False),
    (CHAOS, NEUTRAL, True, "chaotic", False),
    (CHAOS, None, True, "chaotic", True),
])
def test_two_measurements_must_agree(last: Regime, before: Regime | None, sure: bool, name: str, clear: bool) -> None:
    """Where the budget allows no further look, the label that is reported is the last word."""
    regime, known = decided(last, before, sure)
    assert (regime.name, known) == (name, clear)
