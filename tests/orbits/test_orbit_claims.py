"""The evidence for an orbit: its state returns, and its multipliers have the product of Liouville's formula."""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core import scene
from granchain_core.orbits import find_orbit, orbit
from granchain_core.orbits.stroboscopic_map import Flow, StroboscopicMap
from granchain_core.steady.returns import relative_change

pytestmark = pytest.mark.quick


@pytest.mark.parametrize("place", [0, 3])
def test_the_residual_covers_displacements_and_w(place: int) -> None:
    """Each is relative to its own largest value: with a change of 1e-3 in one w, a state is not on an orbit, even if
    the displacements return.
    """
    state, change = np.array([1.0, -2.0, 0.1, 0.2]), np.zeros(4)
    change[place] = 1e-3
    assert relative_change(change, state) == pytest.approx(1e-3 / (2.0 if place < 2 else 0.2), rel=1e-14)


def test_liouvilles_formula_is_about_the_product_of_all_multipliers() -> None:
    multipliers = np.array([0.5 + 0.5j, 0.5 - 0.5j, 0.2, -0.1])
    assert orbit.liouville_if_known(multipliers, np.log(0.01)) == pytest.approx(0.0, abs=1e-14)
    assert orbit.liouville_if_known(multipliers, np.log(0.02)) == pytest.approx(np.log(2.0) / abs(np.log(0.02)), rel=1e-12)
    assert orbit.liouville_if_known(np.array([0.5, 1e-14]), np.log(0.5)) is None  # the smallest is rounding


def test_newtons_method_goes_on_to_the_maps_own_rounding() -> None:
    """For x → (x + 1)/2, a state at a distance of 1e-8 from the fixed point is not accepted yet."""

    class Half(StroboscopicMap):
        def __init__(self) -> None:
            super().__init__(scene("sec2").evolve(N=2), 1)

        def __call__(self, x: np.ndarray, observer: bool = False, directions: np.ndarray | None = None) -> Flow:
            return Flow(0.5 * (x + 1.0), 0.5 * np.eye(len(x)), 0.0, np.zeros((0, 2)))

    newton = find_orbit._iterate(Half(), np.full(4, 1.0 + 1e-8))
    assert newton.residuals[0] == pytest.approx(5e-9, rel=1e-6) and newton.residuals[-1] <= 1e-11
    assert np.abs(newton.z - 1.0).max() < 1e-14
