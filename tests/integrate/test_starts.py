"""Starts: a motion may begin at any drive phase from which the computation can continue, in a state of the same chain.

The oracle is the motion itself: a motion that passes through a state continues from it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from granchain_core import BadInput, LiveChain, Signal, State, drive, lyapunov_spectrum, orbit, run, scene, settle
from granchain_core.integrate import METHODS, Engine, MethodSetting, fixed_step_setting
from granchain_core.integrate.start import at_phase_0
from granchain_core.steady.poincare import iter_section

CHAIN = scene("sec2").evolve(N=2, f=2000.0)
#: A motion from rest, with 16 samples in its second period.
MOTION = run(CHAIN, periods=1, record=1, samples=16)


def state_at(sample: int) -> State:
    """Return the motion's state at a sample."""
    return State(MOTION.displacement[sample], MOTION.velocity[sample], sample / 16)


@pytest.mark.parametrize("phase", [0.25, 0.5, 7 / 16, 0.75])
@pytest.mark.parametrize("way", [lambda start: settle(CHAIN, start).run.max_output_force,
                                 lambda start: run(CHAIN, periods=200, record=1, start=start).max_output_force],
                         ids=["settle", "run"])
def test_a_settled_motion_does_not_depend_on_the_phase_of_its_start(way: Callable[[State], float],
                                                                    phase: float) -> None:
    """There is one attractor, so the force is the same whether the chain starts at rest at phase 0 or at another phase.
    """
    found = settle(CHAIN).run
    assert way(State(np.zeros(2), np.zeros(2), phase)) == pytest.approx(found.max_output_force, rel=1e-5)


@pytest.mark.parametrize("sample", [1, 4, 11, 15])
def test_a_state_is_carried_on_to_where_its_motion_is_at_phase_0(sample: int) -> None:
    """They agree to the accuracy of the fixed-step method: about 1e-5 of the displacements, ten times that of
    velocities.
    """
    there, size = at_phase_0(CHAIN, state_at(sample)), np.abs(MOTION.displacement).max()
    assert there.phase == 0.0
    assert there.displacement == pytest.approx(MOTION.displacement[-1], abs=1e-4 * size)
    assert there.velocity == pytest.approx(MOTION.velocity[-1], abs=1e-3 * np.abs(MOTION.velocity).max())


def test_a_state_at_phase_0_is_not_changed() -> None:
    begin = state_at(0)
    there = at_phase_0(CHAIN, begin)
    assert there.phase == 0.0 and (there.displacement == begin.displacement).all()
    assert at_phase_0(CHAIN, replace(begin, phase=1.0)).phase == 0.0


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("samples", [16, 48, 112])
def test_a_run_goes_on_from_any_of_its_samples(method: str, samples: int) -> None:
    """From a state within a period, the rest of the period is computed with every method and several numbers of
    samples. The steps per period are a multiple of these, and none reads the drive beyond its end. Both runs have
    stated errors.
    """
    first = 5 if samples == 16 else 4  # 4/16 of a period is a sample with both numbers
    found = run(CHAIN, periods=0, record=1, samples=samples, start=state_at(first), method=method)
    behind = found.displacement[(16 - first) * samples // 16]
    error = 10.0 * (found.displacement_error + MOTION.displacement_error)  # the error of the start may have grown
    assert error < 1e-2
    assert behind == pytest.approx(MOTION.displacement[-1], abs=error * np.abs(MOTION.displacement).max())
    assert found.time[0] * CHAIN.f == pytest.approx(first / 16)


@pytest.mark.parametrize("call", [
    lambda start: lyapunov_spectrum(CHAIN, 20, start=start), lambda start: next(iter_section(CHAIN, start, 4)),
    lambda start: orbit(CHAIN, start=start)], ids=["lyapunov", "section", "orbit"])
def test_functions_that_run_whole_periods_take_any_phase(call: Callable[[State], Any]) -> None:
    at_once, later = call(state_at(5)), call(at_phase_0(CHAIN, state_at(5)))
    for name in ("exponents", "displacement", "multipliers"):
        if hasattr(at_once, name):
            assert (getattr(at_once, name) == getattr(later, name)).all()


@pytest.mark.parametrize(("phase", "samples", "nearest"), [
    (0.3, 96, "29/96"), (0.3031, 100, "30/100"), (0.5, 7, "4/7")])
def test_a_run_between_two_samples_is_refused(phase: float, samples: int, nearest: str) -> None:
    with pytest.raises(BadInput, match=f"a multiple of 1/{samples}; the nearest is {nearest}"):
        run(CHAIN, periods=1, record=1, samples=samples, start=State(np.zeros(2), np.zeros(2), phase))
    with pytest.raises(BadInput, match="between two samples"):
        Engine(CHAIN, fixed_step_setting(), samples).start(State(np.zeros(2), np.zeros(2), phase))


def test_a_phase_that_is_no_fraction_is_refused_with_the_nearest() -> None:
    with pytest.raises(BadInput, match="the nearest is 1393/9850"):
        settle(CHAIN, State(np.zeros(2), np.zeros(2), np.sqrt(2.0) / 10.0))


@pytest.mark.parametrize(("start", "sentence"), [
    (State(np.zeros(1), np.zeros(1)), r"displacements of shape \(1,\); a chain of 2 beads has \(2,\)"),
    (State(np.zeros(3), np.zeros(3)), r"displacements of shape \(3,\)"),
    (State(np.zeros(2), np.zeros(3)), r"velocities of shape \(3,\)"),
    (State(np.array([0.0, np.nan]), np.zeros(2)), "not finite, the first at bead 2"),
    (State(np.zeros(2), np.zeros(2), -0.25), "phase -0.25, outside 0 to 1"),
    (State(np.zeros(2), np.zeros(2), float("nan")), "phase nan"),
    (State(["a", "b"], np.zeros(2)), "that are numbers"),  # type: ignore[arg-type]
    (np.zeros(4), "must be a State, not ndarray"),
])
@pytest.mark.parametrize("call", [
    lambda start: run(CHAIN, periods=0, record=1, start=start), lambda start: settle(CHAIN, start),
    lambda start: orbit(CHAIN, start=start), lambda start: LiveChain(CHAIN, start=start),
    lambda start: settle(CHAIN.evolve(drive="rest"), start), lambda start: lyapunov_spectrum(CHAIN, 20, start=start),
    lambda start: drive(CHAIN, Signal.burst(1e-7, 2000.0, 1, 0.001), start=start)],
    ids=["run", "settle", "orbit", "live", "undriven", "lyapunov", "drive"])
def test_a_state_of_another_chain_is_refused(call: Callable[[Any], object], start: Any, sentence: str) -> None:
    with pytest.raises(BadInput, match=sentence):
        call(start)


def test_a_state_may_be_given_by_lists() -> None:
    start = State([0.0, 0.0], [0.01, 0.0])  # type: ignore[arg-type]
    assert run(CHAIN, periods=0, record=1, start=start).velocity[0] == pytest.approx([0.01, 0.0])


@pytest.mark.parametrize("method", [name for name, row in METHODS.items() if row.error_control])
def test_a_second_start_begins_with_the_first_step(method: str) -> None:
    """The same start gives the same bits: the step size of the previous motion is forgotten."""
    engine = Engine(CHAIN, MethodSetting(method, tolerance=1e-8), 8)
    start = engine.state
    first = engine.record(32).displacement
    engine.start(start)
    assert np.array_equal(engine.record(32).displacement, first)
