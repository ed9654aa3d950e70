"""Events within a fixed step: the first of several, and the error of Simpson's rule."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from granchain_core.kernels.effects.dissipation import KuwabaraKono, LinearDashpot, Tsuji
from granchain_core.kernels.effects.energy_account import EnergyAccount
from granchain_core.kernels.rk4 import contact_events as events
from granchain_core.kernels.rk4 import step as fixed_step
from granchain_core.kernels.step_ends import (
    DISPLACEMENT_ERROR,
    END_ROWS,
    MOMENTUM_ERROR,
    OVERLAP,
    OVERLAP_END,
    RATE,
    RATE_END,
)


def test_the_first_of_several_contacts_is_taken() -> None:
    ends = np.zeros((END_ROWS, 3))
    for c, root in enumerate((0.6, 0.25, 0.8)):
        ends[OVERLAP, c], ends[RATE, c], ends[OVERLAP_END, c], ends[RATE_END, c] = -root, 1.0, 1.0 - root, 1.0
    ends[[RATE, RATE_END]] /= 0.5  # rates are per unit time, for a step of 0.5
    contact, found = events.first_event.py_func(ends, 3, 0.5)
    assert (found, contact) == (pytest.approx(0.25, rel=1e-11), 1)


def excess(power: float, r: float) -> float:
    """Return Simpson's rule for s^p on [0, r], [r, r + 1] and [r + 1, r + 2] minus the integral, by definition."""
    pieces = [(0.0, r), (r, r + 1.0), (r + 1.0, r + 2.0)]
    simpson = sum((b - a) / 6.0 * (a**power + 4.0 * (0.5 * (a + b)) ** power + b**power) for a, b in pieces)
    return simpson - (r + 2.0) ** (power + 1.0) / (power + 1.0)


@pytest.mark.parametrize("r", [0.0, 0.1, 0.5, 0.99, 1.0])
def test_the_excess_of_simpsons_rule_over_a_kink(r: float) -> None:
    assert events.three_halves_excess.py_func(r) == pytest.approx(excess(1.5, r), abs=1e-14)
    assert events.primitive_excess.py_func(Tsuji(1.0), r) == pytest.approx(excess(1.25, r), abs=1e-14)
    assert events.primitive_excess.py_func(KuwabaraKono(1.0), r) == pytest.approx(excess(1.5, r), abs=1e-14)


@pytest.mark.parametrize(("rate", "part"), [(0.7, 0.75), (-0.7, 0.25)])
@pytest.mark.parametrize(("law", "scale", "power"), [
    (LinearDashpot(0.3), 0.0, 1.25), (Tsuji(0.3), 0.8 * 0.3, 1.25), (KuwabaraKono(0.3), 2.0 / 3.0 * 0.3, 1.5)])
def test_impulse_and_path_beside_an_event(rate, part, law, scale, power) -> None:  # type: ignore[no-untyped-def]
    """They are K v^{3/2} h^{5/2} and c v^p h^{p+1} times the excess on the closed side, after a closing or before an
    opening.
    """
    ends, h = np.zeros((END_ROWS, 2)), 0.2
    ends[RATE, 1] = rate
    events.add_quadrature_errors.py_func(law, 1.4, ends, 1, h, 0.25)
    assert ends[MOMENTUM_ERROR, 1] == pytest.approx(1.4 * 0.7**1.5 * h**2.5 * excess(1.5, part), rel=1e-9)
    assert ends[DISPLACEMENT_ERROR, 1] == pytest.approx(scale * 0.7**power * h ** (power + 1.0) * excess(power, part), rel=1e-9)
    assert ends[OVERLAP, 1] * rate > 0.0 and not ends[[MOMENTUM_ERROR, DISPLACEMENT_ERROR], 0].any()


def test_the_excess_is_taken_back_from_beads_and_from_the_drivers_work() -> None:
    """Contact c gave its beads too much momentum, by ends[MOMENTUM_ERROR, c]; for contact 0, the driver did the
    corresponding work at its own speed.
    """
    inverse, ends = np.array([0.0, 1.0, 0.5, 0.0]), np.zeros((END_ROWS, 3))
    ends[MOMENTUM_ERROR], ends[DISPLACEMENT_ERROR] = (3.0, 5.0, 8.0), (0.1, 0.4, 0.9)
    slots = SimpleNamespace(chain=SimpleNamespace(inverse_mass=inverse), account=EnergyAccount(1))
    y = np.zeros(10)
    fixed_step.correct_state.py_func(slots, ends, 0.25, y)
    # bead i is pushed forward by contact i − 1 and back by contact i
    assert y == pytest.approx([0.0, 0.3, 0.25, 0.0, 0.0, 2.0, 1.5, 0.0, -3.0 * 0.25, 0.0], abs=1e-15)
