"""The predicates for a contact event within a step, in every form that a kernel uses, agree with the cubic."""

from __future__ import annotations

import itertools
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from granchain_core.kernels.contact_cubic import contact_root, hermite_value, turns
from granchain_core.kernels.dop853_root.changes import may_touch
from granchain_core.kernels.error_control.bracket import may_turn
from granchain_core.kernels.rk4.long_chain import comes_nearer
from granchain_core.kernels.rk4.step import may_change

#: Magnitudes of the overlaps and rates that a step may have.
_SIZE = st.floats(-15.0, 0.7).map(lambda exponent: 10.0**exponent)
#: Rounding error of a cubic's value, relative to the largest of its end values and slopes.
_ROUNDING = 1e-14
_NUMBER = st.tuples(_SIZE, st.sampled_from([-1.0, 1.0])).map(lambda pair: pair[0] * pair[1])
_STEP = st.tuples(_NUMBER, _NUMBER, _NUMBER, _NUMBER)
_ALL_SIGNS = [tuple(float(sign) for sign in signs) for signs in itertools.product((-1, 1), repeat=4)]


def may_change_of(d0: float, s0: float, d1: float, s1: float) -> bool:
    """Call `may_change` for a single contact with these overlaps and rates at the ends of a step."""
    slots = SimpleNamespace(preload=None, chain=SimpleNamespace(stiffness=np.ones(1)))
    y, slope, end, end_slope = (np.array([value, 0.0]) for value in (d0, s0, d1, s1))
    return bool(may_change.py_func(slots, y, slope, end, end_slope))


def nearer_in_long_chain(overlap: float, rate: float) -> bool:
    """Call `comes_nearer` for a chain with one contact."""
    slots = SimpleNamespace(chain=SimpleNamespace(stiffness=np.ones(1)))
    simd = SimpleNamespace(overlap=np.full((1, 8), overlap), velocity=np.full((1, 8), -rate))
    first, _ = comes_nearer.py_func(simd, slots, 0.0)
    return bool(first)


def test_all_signs_at_the_ends_of_a_step() -> None:
    """An event is possible if the sign changes, or if the overlap first approaches zero and finally leaves it;
    otherwise it is not.
    """
    seen = {signs for signs in _ALL_SIGNS if may_change_of(*signs)}
    other_sign = {signs for signs in _ALL_SIGNS if signs[0] != signs[2]}
    assert seen == other_sign | {(-1.0, 1.0, -1.0, -1.0), (1.0, -1.0, 1.0, 1.0)}


def test_the_form_for_all_contacts_at_once_is_that_for_one() -> None:
    """Contact c is bit c; bits beyond the last contact are masked by the callers."""
    closed, rising, rising_after = (
        sum(int(signs[place] > 0.0) << c for c, signs in enumerate(_ALL_SIGNS)) for place in (0, 1, 3))
    together = turns(closed, rising, rising_after)
    for c, (d0, s0, _, s1) in enumerate(_ALL_SIGNS):
        assert together >> c & 1 == turns(int(d0 > 0.0), int(s0 > 0.0), int(s1 > 0.0))
        assert bool(together >> c & 1) == may_change_of(d0, s0, d0, s1)


def test_the_form_of_a_long_chain_looks_at_one_state_at_a_time() -> None:
    """An overlap that approaches zero at one step and leaves it at the next has turned in between."""
    for d0, s0, d1, s1 in _ALL_SIGNS:
        if d0 == d1:
            turned = nearer_in_long_chain(d0, s0) and not nearer_in_long_chain(d1, s1)
            assert turned == may_change_of(d0, s0, d1, s1)


def least_beyond_start(d0: float, s0: float, d1: float, s1: float) -> float:
    """Return the least value of the cubic on [0, 1], times the sign of its first one; it is at an end or a turn."""
    a, b = 2.0 * (d0 - d1) + s0 + s1, 3.0 * (d1 - d0) - 2.0 * s0 - s1
    places = np.array([0.0, 1.0, *(turn.real for turn in np.roots([3.0 * a, 2.0 * b, s0]) if 0.0 < turn.real < 1.0)])
    return float((np.sign(d0) * hermite_value(d0, s0, d1, s1, places)).min())


@given(_STEP)
def test_every_cubic_that_crosses_zero_is_searched(step: tuple[float, float, float, float]) -> None:
    """No form misses a cubic that crosses zero and turns at most once, and a root is reported only if it crosses; its
    values where it turns decide whether it does.

    A cubic that turns twice within a step would need a step half as long.
    """
    d0, s0, d1, s1 = step
    rounding = _ROUNDING * max(map(abs, step))
    least = least_beyond_start(d0, s0, d1, s1)
    assume(d0 * d1 < 0.0 or abs(least) > rounding)
    crosses, turns_twice = d0 * d1 < 0.0 or least < 0.0, s0 * s1 > 0.0 < d0 * d1
    assume(not (crosses and turns_twice))
    root = contact_root(d0, s0, d1, s1)
    assert (root < 2.0) == crosses
    assert root == 2.0 or 0.0 <= root <= 1.0
    assert may_change_of(*step) or not crosses
    if np.sign(d0) == np.sign(d1):
        sign = -np.sign(d0)
        assert may_touch(sign * d0, sign * s0, sign * d1, sign * s1) or not crosses


@given(_STEP)
def test_the_finer_predicates_search_no_further_steps(step: tuple[float, float, float, float]) -> None:
    """`may_turn` and `may_touch` refine `turns`, which refines `may_change`."""
    d0, s0, d1, s1 = step
    assume(d0 * d1 > 0.0)
    sign = -float(np.sign(d0))
    refined = may_turn.py_func(d0, s0, d1, s1, sign) or may_touch(sign * d0, sign * s0, sign * d1, sign * s1)
    assert turns(int(d0 > 0.0), int(s0 > 0.0), int(s1 > 0.0)) or not refined
    assert may_change_of(*step) or not refined


@given(st.floats(0.05, 5.0), _SIZE, st.floats(0.05, 0.95))
def test_a_parabola_that_touches_is_never_ruled_out(curvature: float, height: float, place: float) -> None:
    """The tangents that `may_turn` uses at both ends of a parabola lie above its top."""
    for sign in (-1.0, 1.0):
        d0, s0 = height - curvature * place**2, 2.0 * curvature * place
        d1, s1 = height - curvature * (1.0 - place) ** 2, -2.0 * curvature * (1.0 - place)
        if d0 < 0.0 and d1 < 0.0:
            assert may_turn.py_func(sign * d0, sign * s0, sign * d1, sign * s1, sign)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_where_the_cubic_through_a_steps_ends_crosses_a_touch_is_looked_for(sign: float) -> None:
    """The overlap has the same sign at both ends: open contacts that may close, and closed ones that may open."""
    rng, crossed = np.random.default_rng(1), 0
    x = np.linspace(0.0, 1.0, 401)
    for _ in range(400):
        d0, d1 = -(10.0 ** rng.uniform(-4.0, 0.0, 2))
        s0, s1 = 10.0 ** rng.uniform(-3.0, 0.7), -(10.0 ** rng.uniform(-3.0, 0.7))
        cubic = d0 + x * (s0 + x * (3.0 * (d1 - d0) - 2.0 * s0 - s1 + x * (2.0 * (d0 - d1) + s0 + s1)))
        if cubic.max() > 0.0:
            crossed += 1
            assert may_turn.py_func(sign * d0, sign * s0, sign * d1, sign * s1, sign)
        assert not may_turn.py_func(sign * d0, -sign * s0, sign * d1, sign * s1, sign)  # it moves away at first
    assert 100 < crossed < 300
