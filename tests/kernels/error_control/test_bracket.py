"""Roots and largest values within a step, for quantities with a closed form."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest

from granchain_core.kernels.error_control.bracket import Bracket, maximum_inside, root_inside, value_at


class Cubic(NamedTuple):
    """A cubic with these three roots, times a factor; `asked` are the fractions at which it was evaluated."""

    roots: tuple[float, float, float]
    factor: float
    asked: list[float]


def value(quantity: Cubic, step: None, x: float) -> float:
    """Evaluate the cubic at x."""
    quantity.asked.append(x)
    return quantity.factor * float(np.prod([x - root for root in quantity.roots]))


@pytest.fixture(autouse=True)
def _known(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(value_at.implementations, Cubic, value)


def bracket(quantity: Cubic, low: float, high: float) -> Bracket:
    """Return the bracket between two fractions of the step, with the quantity's values there."""
    return Bracket(low, high, value(quantity, None, low), value(quantity, None, high), 0)


@pytest.mark.parametrize("factor", [1.0, -1.0])
@pytest.mark.parametrize(("roots", "low", "high", "root"), [
    ((0.3, -2.0, 4.0), 0.0, 1.0, 0.3), ((0.2, 0.7, 5.0), 0.4, 1.0, 0.7), ((1e-9, 2.0, 3.0), 0.0, 1.0, 1e-9),
    ((0.5, 0.5, 0.5), 0.0, 1.0, 0.5),
])
def test_a_root_is_found_from_either_side(roots, low, high, root, factor) -> None:  # type: ignore[no-untyped-def]
    """A triple root is found only to 1e-4, since the cubic is negligibly small around it."""
    quantity = Cubic(roots, factor, [])
    found = root_inside.py_func(quantity, None, bracket(quantity, low, high), 1e-15)
    assert found == pytest.approx(root, abs=1e-4 if roots.count(root) == 3 else 1e-14)


def test_the_end_that_stays_is_halved() -> None:
    """Plain regula falsi moves only one end, and needs more than a hundred evaluations for this root."""
    quantity = Cubic((0.01, -0.001, -0.001), 1.0, [])
    found = root_inside.py_func(quantity, None, bracket(quantity, 0.0, 1.0), 1e-15)
    assert found == pytest.approx(0.01, abs=1e-14) and len(quantity.asked) < 40


@pytest.mark.parametrize("factor", [1.0, -1.0])
def test_the_largest_value_inside_is_found(factor: float) -> None:
    """It lies between two roots of the cubic, where the slope is zero; its place is known to √ε, as a maximum is flat.
    """
    quantity = Cubic((0.1, 0.8, 3.0) if factor > 0.0 else (-2.0, 0.1, 0.8), factor, [])
    turns = np.roots(np.poly1d(np.poly(quantity.roots)).deriv())
    turn = float(next(x for x in turns if 0.1 < x < 0.8))
    x, top = maximum_inside.py_func(quantity, None, 1.0, 40)
    assert x == pytest.approx(turn, abs=1e-7)
    assert top == pytest.approx(value(quantity, None, turn), rel=1e-13)
