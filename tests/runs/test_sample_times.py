"""Times of a run's samples."""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core import run, scene

pytestmark = pytest.mark.quick


def test_the_times_of_samples_are_counted_and_not_summed() -> None:
    """Every seventh of 7,000 samples is at a whole number of drive periods, exact to the last bit."""
    chain = scene("sec2").evolve(N=1, f=3000.0, D=300.0, accuracy=1e-2)
    found = run(chain, periods=3, record=1000, samples=7)
    assert (found.time[::7] == (3 + np.arange(1001)) * chain.period).all()
