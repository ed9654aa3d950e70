"""Events on the dense output of a dop853-root step, for distances with a closed form."""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core.kernels.dop853_root.inside import change_before


def parabola(start: float, root: float) -> np.ndarray:
    """Return the dense output's rows for the distance start + x (x − root), and its value at the start."""
    p = np.zeros(8)
    p[0], p[1], p[7] = 1.0 - root, -1.0, start
    return p


@pytest.mark.parametrize("start", [-1e-17, 0.0, 1e-17, -1e-9])
def test_a_distance_that_falls_from_an_event_becomes_positive_after_its_minimum(start: float) -> None:
    """Where a contact has just opened or closed, the distance is a rounding error of either sign, and not an event.

    If it counted as one, it would be found again at the same place forever, as in the scene rig at 60 Hz with a
    tolerance of 5.6e-7 after 10.75 periods.
    """
    assert change_before.py_func(parabola(start, 0.4), True, 1.0) == pytest.approx(0.4, abs=1e-8)


def test_a_distance_that_rises_becomes_positive_where_it_is_zero() -> None:
    assert change_before.py_func(-parabola(0.01, 0.4), False, 0.2) == pytest.approx(0.2 - 0.03**0.5, abs=1e-8)
