"""Regimes in pictures: what a batch assumed of a motion is not said of it."""

from __future__ import annotations

from app.pictures.regimes import batch_sentence
from granchain_core.regime import Regime


def test_the_decay_that_extrapolation_assumed_is_not_told() -> None:
    followed = Regime("periodic", 3, 0.94, 1e-9, 111, followed=True)
    assert batch_sentence(followed) == "period 3, followed to its orbit after 111 periods"
    settled = Regime("periodic", 3, 0.45, 1e-9, 40)
    assert batch_sentence(settled) == "period 3, settled within 40 periods (decay 0.45 per 3 periods)"
