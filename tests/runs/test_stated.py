"""The error stated for the finest of several computations is never less than all of them together show. Compiling does
not count as computing time.
"""

from __future__ import annotations

from dataclasses import replace

import numba
import numpy as np
import pytest
from numba.core import event

from granchain_core import run, scene
from granchain_core.execution.stopwatch import COMPILER_CLOCK, CompilerClock, Stopwatch
from granchain_core.integrate import METHODS, MethodSetting
from granchain_core.integrate.methods import typical_error
from granchain_core.integrate.safety_factors import IRREGULAR
from granchain_core.integrate.stated import StatedErrors
from granchain_core.runs import to_accuracy
from tests.numerics.forces.located import located

REFINES = (4.0, 8.0, 16.0, 32.0)
STEPS = 10_000


def shown(differences: list[float], refines: tuple[float, ...] = REFINES) -> StatedErrors:
    """Return fixed-step computations, each of which differs from the previous one by the next of these differences."""
    found = StatedErrors(False)
    found.begin(MethodSetting("rk4-split", refines[0]))
    for refine, difference in zip(refines[1:], differences, strict=False):
        setting = MethodSetting("rk4-split", refine)
        found.add(setting, STEPS, np.array([difference]), np.array([typical_error(setting)]))
    return found


def test_two_computations_that_agree_by_chance_do_not_decide() -> None:
    """With order 3.9, halving the step leaves a fifteenth of the error, so a factor of 1e-9 is chance."""
    assert shown([1e-5, 1e-14]).stated[0] >= 1.5 * 1e-5 / 16.0


def test_where_the_order_is_seen_the_last_difference_decides() -> None:
    """Differences that fall by 16 show a fourth-order method. The stated error is then little more than the last one.
    """
    last = 1e-3 / 16.0
    assert 1.5 * last <= shown([1e-3, last]).stated[0] <= 1.1 * 1.5 * last


@pytest.mark.parametrize("method", METHODS)
def test_the_difference_before_counts_with_every_method_where_tension_is_cut(method: str) -> None:
    """The previous difference is divided by the tolerance ratio with error control, and otherwise by 2 (order 1)."""
    coarse = MethodSetting(method, 1.0, 1e-6)
    fine = coarse.finer()
    found = StatedErrors(cuts_tension=True)
    found.begin(coarse)
    for setting, difference in ((fine, 1e-3), (fine.finer(), 0.0)):
        found.add(setting, STEPS, np.array([difference]), np.zeros(1))
    ratio = 64.0 if METHODS[method].error_control else 2.0
    assert found.stated[0] == pytest.approx(max(IRREGULAR * 1e-3 / ratio, found.rounding))


def test_the_stated_error_is_at_least_the_typical_one_of_the_steps() -> None:
    setting = MethodSetting("rk4-split", REFINES[1])
    assert shown([0.0]).stated[0] == typical_error(setting) > 0.0


def test_rounding_grows_as_errors_grow() -> None:
    """A motion that magnifies the errors of its steps a millionfold also magnifies their rounding errors, about 1e-16
    each. However well two computations agree, the stated error is at least 1e-10, and finer ones do not help.
    """
    growth = 1e6
    found = shown([growth * typical_error(MethodSetting("rk4-split", r)) for r in REFINES[:-1]])
    assert not found.rounded
    fine = shown([growth * typical_error(MethodSetting("rk4-split", 8.0)), 1e-15, 1e-15], (8.0, 64.0, 512.0, 4096.0))
    assert fine.stated[0] >= growth * np.finfo(float).eps
    assert fine.rounded


def test_a_gentle_motion_is_not_charged_with_rounding() -> None:
    """If errors do not grow, the rounding error of 1e4 steps is below 1e-12."""
    assert shown([typical_error(MethodSetting("rk4-split", r)) for r in REFINES[:-1]]).rounding < 1e-12


def test_an_error_of_a_tenth_is_stated_only_if_requested() -> None:
    found = shown([0.1])
    assert found.final(done=False)[0] == 2.0
    assert found.final(done=True)[0] == pytest.approx(0.15)


#: Scenes from `python -m tests.numerics.stated_errors --seed 101` whose stated error was below the true one: in two
#: computations, the same contact event happened to fall at about the same point of a step.
CHANCE = [
    ({"f": 145.0107398227187, "A0": 5.420547110388205e-06, "D": 187.64768194099608, "N": 1, "F0": 0.0718184022107687,
      "accuracy": 9.005855842342343e-08}, ()),
    ({"f": 139.46763538663726, "A0": 3.662854372970868e-08, "D": 120.48700047211636, "N": 7, "dissipation": "kuwabara-kono",
      "accuracy": 2.0256437815148858e-05}, ((1, -0.00020996051320894545),)),
]


@pytest.mark.parametrize(("knobs", "thrown"), CHANCE, ids=["pressed", "thrown"])
def test_scenes_in_which_two_computations_agreed_by_chance_are_bounded(knobs, thrown) -> None:
    chosen = replace(scene("sec2").evolve(**knobs), start_velocity=thrown)
    found, true = run(chosen, periods=0, record=3, samples=16), located(chosen, 0, 3, 16).displacement
    assert np.abs(found.displacement - true).max() <= found.displacement_error * np.abs(true).max()


class Clock:
    """A clock that is set by hand."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now


def test_the_time_of_a_computation_excludes_compiling() -> None:
    """Kernels that call other kernels start the compiler within the compiler. That time counts once."""
    clock = Clock()
    compiler = CompilerClock(clock)
    began = event.Event("numba:compiler_lock", event.EventStatus.START)
    spent = Stopwatch(clock, compiler)
    clock.now = 2.0
    compiler.on_start(began)
    clock.now = 5.0
    compiler.on_start(began)
    clock.now = 6.0
    compiler.on_end(began)
    clock.now = 9.0
    compiler.on_end(began)
    clock.now = 9.5
    assert spent.seconds == 2.5


def test_compiling_is_detected_by_events_of_numba() -> None:
    before = COMPILER_CLOCK.seconds
    numba.njit(lambda x: np.sort(x)[0])(np.ones(3))
    assert COMPILER_CLOCK.seconds > before


def test_kernels_that_are_compiled_on_the_way_do_not_exhaust_the_budget(monkeypatch: pytest.MonkeyPatch) -> None:
    """The run of section 2 needs three computations (tests/hard_cases/test_outcomes.py). Each takes a hundredth of the
    budget, after compiling for longer than the whole budget.
    """
    budget, clock = 1.0, Clock()
    computes, compiler, computed = to_accuracy._attempt, CompilerClock(clock), []
    began = event.Event("numba:compiler_lock", event.EventStatus.START)

    def compiling(*words):
        compiler.on_start(began)
        clock.now += 2.0 * budget
        compiler.on_end(began)
        clock.now += 0.01 * budget
        computed.append(clock.now)
        return computes(*words)

    monkeypatch.setattr(to_accuracy, "_attempt", compiling)
    monkeypatch.setattr(to_accuracy, "Stopwatch", lambda: Stopwatch(clock, compiler))
    found = run(scene("sec2"), periods=20, record=1, samples=8, budget=budget)
    assert found.status == "done" and len(computed) >= 3
    assert found.cost.wall_s == pytest.approx(0.01 * budget * len(computed))  # as printed: without the compile time


def test_typical_errors_fall_as_the_differences_are_expected_to() -> None:
    """Both terms of a stated error use the same order, the observed one."""
    coarse, fine = MethodSetting("rk4-split", 1.0), MethodSetting("rk4-split", 8.0)
    assert typical_error(coarse) / typical_error(fine) == pytest.approx(StatedErrors(False)._falls(coarse, fine), rel=1e-12)
