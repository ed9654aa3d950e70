"""Formulas for closings, touches and force maxima between two states, compared with closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from granchain_core.kernels.batch_size import BATCH_SIZE
from granchain_core.kernels.compiling.jit import kernel
from granchain_core.kernels.error_control.force_search import is_monotone
from granchain_core.kernels.forces.crossings import brief_touch, closing_rate
from granchain_core.kernels.forces.largest import cubic_top
from granchain_core.kernels.forces.peaks import (
    BATCH_PEAKS,
    HIGHEST,
    INPUT_UNRESOLVED,
    PEAKS,
    quartic_top,
    update_batch_peak,
    update_peak,
)
from granchain_core.kernels.simd.functions import choose_peak
from granchain_core.kernels.simd.vector import aligned, load_batch

OWN, PULL = 1.3, -0.7


def overlap_at(s: float, speed: float) -> tuple[float, float]:
    """Return overlap and rate at time s for a contact that closes at 0 with `speed`: δ̈ = PULL − OWN δ̇ while closed.
    """
    if s <= 0.0:
        return speed * s + 0.5 * PULL * s * s, speed + PULL * s
    end = PULL / OWN
    rate = end + (speed - end) * np.exp(-OWN * s)
    return end * s + (speed - end) * (1.0 - np.exp(-OWN * s)) / OWN, rate


def crossing(h: float, part: float, speed: float = 0.9) -> tuple[float, float]:
    """Return the closing's place in the step and its rate, as found from a step of size h that closes at `part`."""
    (before, rate), (after, rate_after) = (overlap_at(s, speed) for s in (-part * h, (1.0 - part) * h))
    return closing_rate.py_func(before, after, rate, rate_after + OWN * after, OWN, h)


@pytest.mark.parametrize("part", [0.03, 0.5, 0.97])
def test_the_rate_at_a_closing_is_of_third_order(part: float) -> None:
    """Compared with the exact solution for constant pull, the error falls by a factor of 8 or more when the step is
    halved. Without the contact's own damping, the rate is a parabola; the trapezium rule for the small correction then
    has an error of order h⁴.
    """
    errors = [abs(crossing(h, part)[1] / 0.9 - 1.0) for h in (0.2, 0.1)]
    assert errors[0] < 2e-4
    assert errors[1] < max(errors[0] / 6.0, 1e-12)
    assert crossing(0.1, part)[0] == pytest.approx(part, abs=1e-4)


def test_a_closing_is_within_its_step_for_any_overlaps() -> None:
    """The rates may contradict the overlaps, for example if a contact closes, opens and closes again within a step.
    Without its own damping, the rate is a parabola, which departs from the straight line by a quarter of its bend.
    """
    rng = np.random.default_rng(0)
    for _ in range(2000):
        before, after, h = -rng.uniform(0.0, 1.0), rng.uniform(1e-9, 1.0), rng.uniform(0.1, 1.0)
        rate, open_rate = rng.uniform(-1.0, 1.0, 2)
        s, there = closing_rate.py_func(before, after, rate, open_rate, 0.0, h)
        bend = 6.0 * ((after - before) / h - 0.5 * (rate + open_rate))
        assert 0.0 <= s <= 1.0
        assert abs(there) <= max(abs(rate), abs(open_rate)) + 0.25 * abs(bend) + 1e-12
        s, there = closing_rate.py_func(before, after, rate, open_rate, OWN, h)
        assert 0.0 <= s <= 1.0 and np.isfinite(there)


def test_a_touch_within_a_step_is_that_of_constant_acceleration() -> None:
    """δ = top − a s²/2 around its turn closes at the rate √(2 a top), wherever in the step the turn is."""
    a, top, h = 0.8, 1e-3, 0.3
    for turn in (0.3, 0.5, 0.7):
        (before, rate), (after, later) = ((top - 0.5 * a * s * s, -a * s) for s in (-turn * h, (1.0 - turn) * h))
        assert brief_touch.py_func(before, after, rate, later, h) == pytest.approx(np.sqrt(2.0 * a * top), rel=1e-12)
    assert brief_touch.py_func(-1.0, -1.0, 0.1, -0.1, h) == 0.0


def test_the_top_between_two_states_is_the_cubics() -> None:
    """For a sine over a step of 0.2 around its top, a cubic through values and slopes is accurate to h⁴/384."""
    for shift in (-0.15, -0.1, -0.02):
        ends = [np.pi / 2 + shift, np.pi / 2 + shift + 0.2]
        top = cubic_top.py_func(np.sin(ends[0]), np.cos(ends[0]), np.sin(ends[1]), np.cos(ends[1]), 0.2)
        assert top == pytest.approx(1.0, abs=0.2**4 / 384)
    assert cubic_top.py_func(1.0, 0.5, 2.0, 0.5, 0.1) == 2.0
    assert cubic_top.py_func(1.0, np.nan, 2.0, -0.5, 0.1) == 2.0


def test_a_cubic_called_monotone_is_largest_at_an_end() -> None:
    """Random values and slopes are compared with the cubic on a fine grid; a force that is zero throughout is monotone.
    """
    rng, x, called = np.random.default_rng(8), np.linspace(0.0, 1.0, 1001), 0
    for f0, s0, f1, s1, h in rng.uniform(-1.0, 1.0, (2000, 5)) * (1.0, 8.0, 1.0, 8.0, 0.4) + (0.0, 0.0, 0.0, 0.0, 0.5):
        if is_monotone.py_func(f0, s0, f1, s1, h):
            a, b = h * s0, h * s1
            cubic = f0 + x * (a + x * (3.0 * (f1 - f0) - 2.0 * a - b + x * (2.0 * (f0 - f1) + a + b)))
            assert cubic.max() <= max(f0, f1) + 1e-14  # a few roundings of values below 10
            called += 1
    assert 100 < called < 1900
    assert is_monotone.py_func(0.0, 0.0, 0.0, 0.0, 1.0)
    assert not is_monotone.py_func(1.0, 1.0, 1.0, -1.0, 1.0) and not is_monotone.py_func(1.0, np.nan, 2.0, 1.0, 1.0)


@pytest.mark.parametrize("offset", np.linspace(-0.5, 0.5, 11))
def test_the_top_of_a_pulse_between_its_samples(offset: float) -> None:
    """For a cosine and a lopsided pulse sampled every 0.25, the quartic finds the top to within 2e-5."""
    t = 0.25 * (np.arange(-2, 3) + offset)
    assert quartic_top.py_func(*np.cos(t)) == pytest.approx(1.0, abs=5e-6)
    assert quartic_top.py_func(*((t + 2.0) ** 2 * np.exp(-2.0 - t))) == pytest.approx(4.0 * np.exp(-2.0), abs=2e-5)


#: Five successive values of a force around a maximum of 1, smooth or not.
AROUND_ONE = st.tuples(*(st.floats(0.0, high) for high in (1.5, 1.0, 1.0, 1.5)))


@given(values=AROUND_ONE)
@example(values=(1.199, 0.99957, 0.99955, 0.7788))  # the quartic rises to 209
@example(values=(0.4004, 0.99999999994, 0.8001, 0.99863))  # near the largest factor that is known
def test_the_top_of_a_maximum_is_little_above_its_values(values: tuple[float, float, float, float]) -> None:
    a, b, d, e = values
    with np.errstate(all="ignore"):  # a flat maximum has no curvature, and its quartic no top
        top = choose_peak(a, b, 1.0, d, e, quartic_top.py_func(a, b, np.float64(1.0), d, e))
    assert not top > HIGHEST * max(1.0, a, e)


@kernel
def follow(alone, together, values):
    """Follow one force of each member, alone and in a batch; `values` are (samples, members)."""
    for k in range(values.shape[0]):
        update_batch_peak(together, 0, load_batch(values, k), INPUT_UNRESOLVED)
        for member in range(values.shape[1]):
            update_peak(alone[member], 0, values[k, member])


def test_a_batch_follows_peaks_as_one_chain_does() -> None:
    """The forces are random, many with a dip of a single value; vectors do the last operations in a different order."""
    values = aligned(4000, BATCH_SIZE)
    values[:] = np.exp(np.random.default_rng(5).normal(0.0, 0.1, values.shape))
    for first in range(0, len(values), 100):
        alone, together = np.zeros((BATCH_SIZE, PEAKS)), aligned(BATCH_PEAKS, BATCH_SIZE)
        follow(alone, together, values[first : first + 100])
        largest = values[first : first + 100].max(axis=0)
        np.testing.assert_allclose(together[0], alone[:, 0], rtol=1e-12)
        assert (together[0] <= HIGHEST * largest).all() and (together[0] >= largest).all()
