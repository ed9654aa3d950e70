"""The times at which a motion is examined for a period depend only on the motion, not on the speed of the machine."""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core import scene
from granchain_core.steady.settling.advance import SettlingRun, run_until_settled


@pytest.mark.parametrize("f", [340.0, 620.0, 1130.0])
def test_a_motion_that_is_run_in_small_pieces_settles_when_one_run_at_once_does(f: float) -> None:
    """The motions settle at once, are followed to their orbit by a decision, or have period 3; a piece has at most two
    periods.
    """
    chain = scene("sec2").evolve(f=f)
    at_once = run_until_settled(chain, None, None)
    pieces = SettlingRun(chain, None, None)
    count = 0
    while not pieces.decided:
        pieces.go_on(0.0)
        count += 1
    assert count >= at_once.regime.periods_run // 2
    assert pieces.regime == at_once.regime
    assert np.array_equal(pieces.engine.state.displacement, at_once.engine.state.displacement)
