"""The small pictures: every case has one with granchain's result and that of a naive solver, and they differ visibly.
"""

from __future__ import annotations

import functools
from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from granchain_core.hard_cases import CASES, Picture
from granchain_core.hard_cases.case import Trace
from granchain_core.hard_cases.contacts import at_once_picture, collisions_picture
from granchain_core.hard_cases.energy import switched_picture
from granchain_core.hard_cases.extremes import preloads_picture, sizes_picture
from granchain_core.hard_cases.oracle import PlainChain
from granchain_core.hard_cases.regimes import drifting_picture
from granchain_core.scene import scene

#: Differences visible from the back row: a fraction of the picture's height, powers of ten, a fraction of its width
#: that only one line covers.
HEIGHT, POWERS, WIDTH = 0.05, 1.0, 0.1


@functools.cache
def computed(picture: Callable[[], Picture]) -> Picture:
    """Return a picture, computed once for all tests."""
    return picture()


def ours_and_others(shown: Picture) -> list[tuple[Trace, Trace]]:
    """Return pairs of granchain's line and each other line, for the same bead if several are shown.

    If granchain is not named, the first line is paired with the others.
    """
    ours = [trace for trace in shown.traces if trace.label.startswith("granchain")] or [shown.traces[0]]
    others = [trace for trace in shown.traces if trace not in ours and trace.label != "true"]
    same = {trace.label.rpartition(": ")[2]: trace for trace in ours}
    return [(same.get(trace.label.rpartition(": ")[2], ours[0]), trace) for trace in others]


def seen(shown: Picture, one: np.ndarray, other: np.ndarray) -> bool:
    """Return whether two lines in a picture are visibly apart, or one continues after the other has ended."""
    alone = np.isfinite(one) != np.isfinite(other)
    if alone.mean() >= WIDTH:
        return True
    every = np.concatenate([trace.values for trace in shown.traces])
    height = POWERS if shown.y_label.endswith(", log10") else HEIGHT * (np.nanmax(every) - np.nanmin(every))
    return bool(np.nanmax(np.abs(one - other)) >= height > 0.0)


@pytest.mark.parametrize("case", CASES, ids=[case.name for case in CASES])
def test_a_picture_shows_ours_beside_something_else(case) -> None:  # type: ignore[no-untyped-def]
    assert case.picture is not None
    shown = computed(case.picture)
    assert shown.x_label and shown.y_label and len(shown.traces) >= 2
    for trace in shown.traces:
        assert trace.label and trace.values.shape == shown.x.shape
        assert np.isfinite(trace.values).any() and not np.isinf(trace.values).any()
    pairs = ours_and_others(shown)
    assert pairs and any(seen(shown, ours.values, other.values) for ours, other in pairs)


def test_traces_that_hardly_differ_do_not_count_as_different() -> None:
    x = np.linspace(0.0, 1.0, 50)
    near = Picture(x, "x", "y", (Trace("granchain", x), Trace("naive", 1.02 * x)))
    assert not seen(near, *(trace.values for trace in near.traces))
    powers = Picture(x, "x", "y, log10", (Trace("granchain", -3.0 + 0.0 * x), Trace("naive", -2.5 + 0.0 * x)))
    assert not seen(powers, *(trace.values for trace in powers.traces))


# --- single pictures --------------------------------------------------------------------------------------


def test_symmetry_holds_the_middle_bead_and_the_loop_does_not() -> None:
    ours, naive = computed(at_once_picture).traces
    assert np.abs(ours.values).max() == 0.0
    assert np.abs(naive.values).max() > 0.3


def test_eulers_last_bead_is_faster_than_the_first_was() -> None:
    last, _, naive, _ = computed(collisions_picture).traces
    assert last.values[-1] < 1.0 < 1.2 < naive.values[-1]


def test_least_squares_leaves_contacts_open_and_calls_it_success() -> None:
    shown = computed(preloads_picture)
    ours, naive = shown.traces
    assert np.allclose(ours.values, 1.0, rtol=1e-12, atol=0.0)
    assert naive.label.endswith("success = True") and (naive.values == 0.0).sum() >= 5 and naive.values.max() > 3.0


def test_scipys_defaults_round_a_pulse_and_slow_it() -> None:
    """This repeats the line in the table in metres: bead 1 of 60 is thrown at 1 mm/s, section 2's driver speed, and the
    51st bead is examined.
    """
    chosen, beads, speed, place = scene("sec2"), 60, 1e-3, 50
    length = (chosen.bead(1).mass * speed**2 / chosen.K) ** 0.4
    times = length / speed * np.linspace(0.0, 70.0, 281)

    def slope(t: float, state: np.ndarray) -> np.ndarray:
        pressed = chosen.K * np.maximum(-np.diff(state[:beads]), 0.0) ** 1.5
        return np.concatenate([state[beads:], np.diff(-pressed, prepend=0.0, append=0.0) / chosen.bead(1).mass])

    start = np.concatenate([np.zeros(beads), speed * np.eye(beads)[0]])
    naive, true = (solve_ivp(slope, (0.0, times[-1]), start, t_eval=times, **asked).y[beads + place] / speed
                   for asked in ({}, {"method": "DOP853", "rtol": 1e-10, "atol": 1e-18}))
    assert naive.max() < 0.9 * true.max()
    assert np.argmax(naive) >= np.argmax(true) + 4  # samples are a quarter of the scaled time unit apart


def test_one_step_for_all_throws_the_light_bead_out() -> None:
    ours, naive = computed(sizes_picture).traces
    ended = np.isnan(naive.values)
    assert np.abs(ours.values).max() < 1.5 and ended[-1] and ended.mean() > 0.5


def test_the_free_observer_grows_by_its_multiplier_in_every_solver() -> None:
    free, founded, *naive = computed(drifting_picture).traces
    rate = np.log10(float(free.label.rpartition(" ")[2]))
    assert np.allclose(np.diff(free.values)[1:], rate, atol=0.01)  # the label has three digits
    assert founded.values.max() < -5.5
    for trace in naive:  # as long as they are small, until their own errors bend the line
        small = trace.values[np.isfinite(trace.values)]
        small = small[: int(np.argmax(small > -0.5))]
        assert abs(np.diff(small)[-1] - rate) < 0.25
        assert trace.values[-1] > -0.5


def test_a_jump_is_the_limit_of_a_fast_push() -> None:
    """At and after the jump, the result agrees with SciPy's implicit method and a driver that jumps within 1e-4."""
    chosen, width = scene("sec2").evolve(N=4), 1e-4
    chain = PlainChain.of(chosen)
    start = 0.25 * chain.period

    def slope(t: float, state: np.ndarray) -> np.ndarray:
        pushed = t < start
        place = 1.0 + (t - start) / width if pushed else np.sin(chain.beta * t)
        speed = 1.0 / width if pushed else chain.beta * np.cos(chain.beta * t)
        u, v = np.concatenate([[place], state[:4], [0.0]]), np.concatenate([[speed], state[4:], [0.0]])
        gap = u[:-1] - u[1:]
        force = np.where(gap > 0.0, chain.springs * np.abs(gap) ** 1.5 + chain.damping * (v[:-1] - v[1:]), 0.0)
        return np.concatenate([state[4:], force[:-1] - force[1:]])

    shown = computed(switched_picture)
    ours, naive = (trace.values[2:] for trace in shown.traces)
    times = start + chain.period * shown.x[2:]
    before = solve_ivp(slope, (start - width, start), np.zeros(8), "Radau", rtol=1e-9, atol=1e-12).y[:, -1]
    found = solve_ivp(slope, (start, times[-1]), before, "Radau", t_eval=times, rtol=1e-9, atol=1e-12).y[4:].sum(axis=0)
    true = found / found.max()
    assert np.abs(ours - true).max() < 1e-3  # from the duration of the push, 1e-4, and the elastic compression during it
    assert naive[0] == 0.0 and true[0] > 0.2
