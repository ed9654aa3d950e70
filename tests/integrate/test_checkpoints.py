"""An engine that continues from a checkpoint gives the same motion, bit by bit, as without one."""

from __future__ import annotations

import pytest

from granchain_core.hard_cases.long_runs import cut_and_gone_on, uninterrupted
from granchain_core.integrate import METHODS


@pytest.mark.parametrize("method", METHODS)
def test_a_run_resumed_from_checkpoints_is_the_same_run(method: str) -> None:
    assert cut_and_gone_on(method, 8, 5) == 0.0
    assert uninterrupted(method, 8, 5) == 0.0
