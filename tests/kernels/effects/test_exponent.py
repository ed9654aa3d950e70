"""The kernels' contact law has the exponent on which everything outside the kernels relies."""

from __future__ import annotations

import pytest

from granchain_core.kernels.effects.contact import elastic_energy, elastic_force, elastic_slope
from granchain_core.scene.hertz import EXPONENT, OVERLAP_POWER, RATE_POWER


@pytest.mark.parametrize(("quantity", "power"), [
    (elastic_force, EXPONENT), (elastic_slope, EXPONENT - 1.0), (elastic_energy, EXPONENT + 1.0)])
def test_force_slope_and_energy_are_powers_of_the_overlap(quantity, power):
    assert quantity.py_func(7.0, 3.0) == pytest.approx(quantity.py_func(7.0, 1.0) * 3.0**power, rel=1e-15)


def test_powers_are_those_of_hertz():
    assert (EXPONENT, OVERLAP_POWER, RATE_POWER) == (1.5, 2.0 / 3.0, 0.25)
