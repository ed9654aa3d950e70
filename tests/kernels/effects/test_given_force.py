"""A measured force between its samples."""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core.kernels.effects.driver import driver_velocity
from granchain_core.kernels.effects.given_force import Sampled


def test_a_measured_force_is_a_cubic_between_samples() -> None:
    """The coefficients start with the constant term, in the time since the sample. This force pushes bead 1 of an
    observer. It has the slot of the driver, so `driver_velocity` gives the force.
    """
    p = np.array([0.3, -1.2, 2.5, 4.0])
    assert driver_velocity(Sampled(p), 0.7) == pytest.approx(np.polyval(p[::-1], 0.7), rel=1e-14)
