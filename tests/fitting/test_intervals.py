"""Ends of a profile's interval."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from granchain_core.fitting.intervals import profile

pytestmark = pytest.mark.quick


def profile_of(misfit: Any, slope: float) -> Any:
    """Return the profile of one parameter from 0 to 1 with its least misfit at 0.5, where residuals have this slope."""
    free = SimpleNamespace(value=float)
    stub = SimpleNamespace(misfit=lambda x: misfit(float(x[0])), free=[free],
                           curvature=lambda x: np.array([[slope**2]]))
    return profile(stub, np.array([0.5]), 0, 1.0, None, last=True)  # type: ignore[arg-type]


def test_an_end_where_the_misfit_never_rose_to_its_limit_is_open() -> None:
    """A steep difference quotient, as across a jump between regimes, lets the search begin 1e-4 from the best point."""
    flat = profile_of(lambda x: 0.0, 2e4)
    assert flat.low > 0.0 and flat.high < 1.0 and flat.open_low and flat.open_high


def test_an_end_where_it_crosses_is_closed() -> None:
    found = profile_of(lambda x: (20.0 * (x - 0.5)) ** 2, 20.0)
    assert (found.open_low, found.open_high) == (False, False)
    assert found.high - 0.5 == pytest.approx(1.96 / 20.0, rel=0.05)
