"""The largest forces that are given are within what is stated of them; the computation that judges them (forces/) is
first held against closed forms, the scaling law and SciPy."""

from __future__ import annotations

import functools
from dataclasses import replace

import numpy as np
import pytest

from granchain_core import scene
from tests.numerics.forces.draw import FEW
from tests.numerics.forces.judge import Verdict, verdicts
from tests.numerics.forces.located import located
from tools.fuzzing import oracle

CONTACTS = [("linear", "allowed"), ("linear", "cut"), ("tsuji", "cut"), ("kuwabara-kono", "allowed")]
#: Seed of the slice of random scenes, not one by which factors were chosen.
SEED = 2026
#: Runs of several periods take no longer than so many times 1/φ, a third of the program's: the truth of a slow drive's
#: second and third period costs most.
LONGEST = 3e3
#: Seconds for a run: a few do not reach their accuracy in six seconds either, and say so after this time.
BUDGET = 1.0


def test_the_force_jumps_where_the_driver_starts_against_a_bead() -> None:
    """The bead rests against a driver that starts with 2πf A0: the right limit at t = 0 is D·2πf A0, and it is the
    largest force where damping outweighs all else, λ = 45, and the wall is far.
    """
    one = scene("sec2").evolve(N=1, D=2e4, f=500.0)
    jump = one.D * 2.0 * np.pi * one.f * one.A0
    found = located(one, 0, 1, gaps=np.array([0.0, 1e-3]))
    assert found.closings[0] == pytest.approx([0.0, 0.0, jump], rel=1e-14)
    assert found.maxima[0] == pytest.approx(jump, rel=1e-12)


def test_a_touch_shorter_than_a_step_is_seen_where_and_as_hard_as_it_is() -> None:
    """The driver's crest comes a millionth of A0 farther than to the resting bead, whose wall is far: it is there at
    sin θ = 1 − 1e-6, at 2πf A0 cos θ.
    """
    one = scene("sec2").evolve(N=1, f=100.0, D=10.0)
    low = 1.0 - 1e-6
    found = located(one, 0, 1, gaps=one.A0 * np.array([low, 9.0]))
    theta, omega = np.arcsin(low), 2.0 * np.pi * one.f
    time, contact, top = found.closings[0]
    # cos θ = 1.4e-3 magnifies the rounding of sin θ, 1e-16, to 1e-13 of a radian
    assert (time * omega, contact) == pytest.approx((theta, 0), abs=1e-12)
    assert top == pytest.approx(one.D * omega * one.A0 * np.cos(theta), rel=1e-9)


def test_a_collision_with_the_wall_has_the_peak_of_hertz() -> None:
    """1.1432626 K^{2/5} m^{3/5} v^{6/5}, known to its eight digits; half a period holds the first collision only."""
    one = scene("sec2").evolve(N=1, dissipation="none", f=1000.0, A0=1e-9)
    thrown = replace(one, start_velocity=((1, 1e-3),))
    peak = 1.1432626 * one.K**0.4 * one.bead(1).mass ** 0.6 * 1e-3**1.2
    # at its end the bead meets the driver, 1e-9 m × 2π × 1000 Hz = 6e-6 m/s slow, and does not come back in this period
    assert located(thrown, 0, 1).maxima[1:] == pytest.approx([peak, peak], rel=5e-8)


def test_the_largest_output_force_of_an_overdamped_chain_stands_at_its_closing() -> None:
    """Section 2 with D = 300 at 100 Hz, settled: 0.14733 N, the right limit at the wall's closing, not the top behind
    it.
    """
    found = located(scene("sec2").evolve(D=300.0, f=100.0), 100, 1)
    at_wall = found.closings[found.closings[:, 1] == 11][:, 2]
    assert found.maxima[1] == pytest.approx(0.14733, abs=5e-6)
    assert at_wall.max() == pytest.approx(found.maxima[1], rel=1e-12)


@pytest.mark.parametrize(("law", "tension"), CONTACTS)
def test_the_computation_scales_and_agrees_with_itself_and_with_scipy(law: str, tension: str) -> None:
    """Measured: forces at 1e-10 and 1e-12 differ by less than 1e-9, displacements from SciPy's by 7e-9, which is its
    error.
    """
    s = 3.0
    one = scene("sec2").evolve(dissipation=law, tension=tension, kappa=0.01)
    found, nearly, other = located(one, 1, 2), located(one, 1, 2, tolerance=1e-10), located(one.scaled(s), 1, 2)
    assert nearly.maxima == pytest.approx(found.maxima, rel=5e-9)
    assert other.maxima == pytest.approx(s**1.5 * found.maxima, rel=1e-9)
    true = oracle.located(one, 3, 16, 1e-11, 60.0)[16:]
    assert np.abs(found.displacement - true).max() <= 5e-8 * np.abs(true).max()


@functools.cache
def slice_of(kind: str, count: int) -> list[Verdict]:
    """Verdicts on a few draws."""
    found = verdicts(kind, count, SEED, FEW if kind == "run" else FEW[:1], longest=LONGEST, budget=BUDGET)
    return [v for v in found if isinstance(v, Verdict)]


@pytest.mark.long
@pytest.mark.parametrize(("kind", "count"), [("run", 12), ("curve", 3), ("map", 3)])
def test_largest_forces_are_within_what_is_stated_of_them(kind: str, count: int) -> None:
    """All but one of these forces at most, and none is wrong by more than 1e-3 plus ten times what is stated. How many
    are in thousands of scenes is measured in docs/accuracy.md (`python -m tests.numerics.forces`).
    """
    found = slice_of(kind, count)
    judged = np.array([v.judged & ~np.isnan(v.stated) for v in found])
    bounded, silent = (np.array([getattr(v, name) for v in found]) for name in ("bounded", "silent"))
    print(f"{kind}: {judged.sum()} forces of {judged.size} judged, {(judged & bounded).sum()} bounded")
    assert judged.mean() > 0.5
    assert (judged & ~bounded).sum() <= 1
    assert not (judged & silent).any()
