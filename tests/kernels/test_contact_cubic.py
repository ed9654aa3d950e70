"""The cubic that approximates an overlap within a step: its turning point and its zeros."""

from __future__ import annotations

from decimal import Decimal, localcontext

import numpy as np
import pytest

from granchain_core.kernels import contact_cubic


def ends_of(*roots: float, sign: float = 1.0) -> tuple[float, float, float, float]:
    """Return values and slopes at 0 and 1 of sign·Π(x − root), a polynomial of degree three at most."""
    p = sign * np.poly1d(np.poly(roots))
    return p(0.0), p.deriv()(0.0), p(1.0), p.deriv()(1.0)


@pytest.mark.parametrize(("roots", "sign", "first"), [
    ((0.3, -2.0, 4.0), 1.0, 0.3), ((0.3, -2.0, 4.0), -1.0, 0.3), ((0.9,), 1.0, 0.9),
    ((0.2, 0.7), 1.0, 0.2), ((0.2, 0.7), -1.0, 0.2), ((0.5, 0.6, 3.0), -1.0, 0.5),  # two events within the step
    ((1.2, 1.7), 1.0, 2.0), ((-0.2, 1.5), -1.0, 2.0), ((0.5 + 0.2j, 0.5 - 0.2j), 1.0, 2.0), ((0.5 + 0.2j, 0.5 - 0.2j), -1.0, 2.0),
])
def test_a_contact_changes_at_the_cubics_first_root(roots, sign, first) -> None:  # type: ignore[no-untyped-def]
    """The contacts open, close, do both or do neither; 2 means that there is no event in this step."""
    found = contact_cubic.contact_root.py_func(*(float(np.real(x)) for x in ends_of(*roots, sign=sign)))
    assert found == pytest.approx(first, abs=1e-11)  # the iteration ends at 1e-12


@pytest.mark.parametrize(("s0", "d1", "root"), [(1.0, 0.5, 0.0), (-1.0, -0.5, 2.0), (1.0, -0.5, 2.0)])
def test_beads_that_touch_close_where_they_are_pushed_together(s0: float, d1: float, root: float) -> None:
    assert contact_cubic.contact_root.py_func(0.0, s0, d1, s0) == root


def test_the_turn_is_where_the_slope_is_zero() -> None:
    for roots, sign in (((0.2, 0.7), 1.0), ((0.2, 0.7), -1.0), ((0.1, 0.4, 2.0), 1.0)):
        turns = np.roots(np.poly1d(np.poly(roots)).deriv())
        inside = [x for x in turns if 0.0 < x < 1.0]
        assert contact_cubic.hermite_turn.py_func(*ends_of(*roots, sign=sign)) == pytest.approx(inside[0], rel=1e-12)


def exact_turn(s0: float, a: float, b: float) -> float:
    """Return the turning point of s0 x + b x² + a x³ between 0 and 1, computed with 50 digits."""
    with localcontext() as context:
        context.prec = 50
        disc = (Decimal(b) ** 2 - 3 * Decimal(a) * Decimal(s0)).sqrt()
        roots = [(-Decimal(b) + sign * disc) / (3 * Decimal(a)) for sign in (-1, 1)]
        return float(next(root for root in roots if 0 < root < 1))


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("exponent", range(-18, 0))
def test_the_turn_is_exact_however_slowly_an_overlap_moves_at_first(exponent: int, sign: float) -> None:
    """The turn is far from the start if slope and curvature have the same sign there, and near it otherwise."""
    b = sign * 2.0**-10
    s0 = 10.0**exponent * b
    for slope, a in ((s0, -b), (-s0, 0.5 * b)):
        found = contact_cubic.hermite_turn.py_func(0.0, slope, slope + b + a, slope + 2.0 * b + 3.0 * a)
        assert found == pytest.approx(exact_turn(slope, a, b), rel=1e-12)


@pytest.mark.parametrize("exponent", range(-18, -3))
def test_a_contact_that_comes_nearer_slowly_at_first_closes(exponent: int) -> None:
    """A contact with δ = −1e-5 + s0 x + 1e-3 (x² − x³) closes near x = 0.1, and opens again before the end."""
    d0, s0 = -1e-5, 1e-3 * 10.0**exponent
    first = min(root.real for root in np.roots([-1e-3, 1e-3, s0, d0]) if root.real > 0.0)
    for sign in (1.0, -1.0):
        found = contact_cubic.contact_root.py_func(sign * d0, sign * s0, sign * (d0 + s0), sign * (s0 - 1e-3))
        assert found == pytest.approx(first, abs=1e-11)
