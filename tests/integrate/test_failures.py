"""Numbers that fail are detected and reported, never hidden."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from granchain_core import Cancelled, ComputationError, Stop, run, scene
from granchain_core.integrate import METHODS, Engine, MethodSetting, error_controlled, fixed
from granchain_core.integrate.failure import Failure
from granchain_core.kernels.flow import run as flow
from granchain_core.kernels.flow.attempt import FlowProblem
from granchain_core.kernels.status import CHATTER, DONE, NOT_FINITE, TOO_MANY_STEPS
from granchain_core.orbits.stroboscopic_map import StroboscopicMap

#: Methods whose failures are located.
LOCATED = ["rk4", "rk4-split", "dop853", "dop853-root"]


@pytest.mark.parametrize("method", LOCATED)
@pytest.mark.parametrize("row", ["displacement", "w"])
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("bead", [1, 6, 11])
def test_no_call_begins_from_a_number_that_is_not_finite(method, row, value, bead):
    """Whichever bead and variable has it, the next call names the bead before a kernel runs."""
    engine = Engine(scene("sec2"), MethodSetting(method, tolerance=1e-6), 8)
    engine.record(12)
    engine.y[bead + (13 if row == "w" else 0)] = value
    for call in (lambda: engine.record(8), lambda: engine.periods(1)):
        with pytest.raises(ComputationError, match=f"bead {bead} ") as caught:
            call()
        assert caught.value.status == "not-finite" and "s (" in caught.value.sentence


def break_contact(engine: Engine, contact: int) -> None:
    """Make a contact's stiffness a NaN, so that the failure occurs in the kernel."""
    stepper = engine.stepper
    stepper.scaled.slots.chain.stiffness[contact] = np.nan
    if METHODS[engine.setting.method].error_control:
        stepper.use(stepper.scaled)
    else:
        stepper.work = stepper.work._replace(simd=stepper.new_simd_workspace())


@pytest.mark.parametrize("method", LOCATED)
@pytest.mark.parametrize(("samples", "f"), [(0, 1130.0), (5, 1130.0), (31, 340.0)])
@pytest.mark.parametrize("contact", [0, 4, 8, 11])
def test_the_bead_beside_a_broken_contact_is_named(method, samples, f, contact):
    """The first step from rest, and the one after 31 samples at 340 Hz, are split at contact events."""
    engine = Engine(scene("sec2").evolve(f=f), MethodSetting(method, tolerance=1e-6), 8)
    if samples:
        engine.record(samples)
    break_contact(engine, contact)
    with pytest.raises(ComputationError) as caught:
        engine.record(8)
    assert caught.value.bead in {max(1, contact), min(11, contact + 1)}
    assert f"bead {caught.value.bead} stopped being a finite number" in caught.value.sentence


@pytest.mark.parametrize("method", LOCATED)
def test_the_kernel_of_whole_periods_notices_numbers_that_are_not_finite(method):
    engine = Engine(scene("sec2"), MethodSetting(method, tolerance=1e-6), 1)
    engine.periods(2)
    break_contact(engine, 4)
    with pytest.raises(ComputationError, match=r"bead [45] stopped being a finite number"):
        engine.periods(1)


@pytest.mark.parametrize("method", [name for name in LOCATED if name != "dop853"])
@pytest.mark.parametrize("periods", [False, True])
def test_the_repeated_call_that_finds_the_bead_is_cancelled_as_any_other(method, periods, monkeypatch):
    """It may take as long as the call that failed; dop853 repeats no call."""
    stop = Stop()
    engine = Engine(scene("sec2"), MethodSetting(method, tolerance=1e-6), 8, stop=stop)
    engine.periods(2)
    break_contact(engine, 4)
    before, flags, locate = engine.y.copy(), [], engine.stepper.locate_failure

    def spied(kernel, *words):
        flags.append(words[-1].stop)
        return kernel(*words)

    monkeypatch.setattr(fixed, "run_steps", partial(spied, fixed.run_steps))
    monkeypatch.setattr(error_controlled, "RUN_ERROR_CONTROLLED", partial(spied, error_controlled.RUN_ERROR_CONTROLLED))

    def while_it_is_located(*words):
        stop.set()
        flags.clear()
        return locate(*words)

    monkeypatch.setattr(engine.stepper, "locate_failure", while_it_is_located)
    with pytest.raises(Cancelled):
        engine.periods(1) if periods else engine.record(8)
    assert len(flags) == 1 and flags[0] is stop.flag, "the kernel reads the flag"
    np.testing.assert_array_equal(engine.y, before)


@pytest.mark.parametrize("method", LOCATED)
def test_no_bead_is_named_if_none_is_identified(method):
    """If every number is finite, no bead is named as the first that failed."""
    engine = Engine(scene("sec2"), MethodSetting(method, tolerance=1e-6), 8)
    engine.record(8)
    assert engine.stepper.locate_failure(engine.y, None, 0.0, Stop())[0] == 0
    problem = Failure(NOT_FINITE, 1.0, 0, None, {}, scene("sec2"), method).error
    assert isinstance(problem, ComputationError)
    assert problem.bead is None and problem.sentence.startswith("The motion stopped being a finite number at about")


def test_the_sentence_names_the_time_since_the_start():
    """After twenty periods, the failure is reported at about twenty periods, not at the beginning of the current call.
    """
    engine = Engine(scene("sec2"), MethodSetting("rk4", tolerance=1e-6), 8)
    engine.periods(20)
    engine.y[1:12] = np.nan
    with pytest.raises(ComputationError, match=r"\(2\d(\.\d+)? drive periods\)"):
        engine.periods(2)


@pytest.mark.parametrize("accuracy", [1e-3, 1e-5, 1e-8])
@pytest.mark.parametrize("k", [1e8, 1e10])
def test_the_stiffest_foundation_that_is_accepted_is_integrated(k, accuracy):
    """k is valid up to 1e10 N/m, so its bead frequency must enter the choice of the step."""
    result = run(scene("sec2").evolve(k=k, accuracy=accuracy, f=3000.0), periods=0, record=1, samples=8)
    assert result.status == "done"
    assert np.abs(result.displacement).max() < result.scene.A0


@pytest.mark.parametrize("knobs", [{"D": 1e4}, {"A0": 1e-10}, {"A0": 1e-4}, {"F0": 1e4}, {"wall": 1e6}, {"wall": 1e-6},
                                   {"f": 1e6}, {"N": 1}, {"N": 300}])
@pytest.mark.parametrize("accuracy", [1e-4, 1e-8])
def test_extreme_but_valid_knobs_give_a_finite_motion(knobs, accuracy):
    """Every corner of the ranges that does not take too long is computed to the requested accuracy."""
    result = run(scene("sec2").evolve(f=3000.0, accuracy=accuracy).evolve(**knobs), periods=0, record=1, samples=8)
    assert result.status == "done"
    assert np.isfinite(result.force).all()
    assert np.isfinite(result.displacement).all()


def failure(status: int) -> Failure:
    """Return the failure of a computation that ended with this status."""
    return Failure(status, 1.0, 0, None, {}, scene("sec2"), "dop853")


def test_an_unknown_status_raises_value_error() -> None:
    with pytest.raises(ValueError, match="99 is not the status"):
        _ = failure(99).error
    assert failure(CHATTER).error.status == "chatter"


def test_too_many_steps_in_a_period_have_a_status_of_their_own(monkeypatch: pytest.MonkeyPatch) -> None:
    """The flow's own loop is given steps that do not advance, and a limit of three steps."""
    def step(*words: object) -> tuple[int, None, float, int]:
        return DONE, None, 0.0, -1

    monkeypatch.setattr(flow, "_MOST_STEPS", 3)
    monkeypatch.setattr(flow, "begin", lambda *words: None)
    monkeypatch.setattr(flow, "evaluate", lambda *words: None)
    monkeypatch.setattr(flow, "flow_step", step)
    stroboscopic_map = StroboscopicMap(scene("sec2"), 1)
    engine = stroboscopic_map.engine
    problem = FlowProblem(engine.stepper.trajectory(engine.y), stroboscopic_map._contacts, None)
    status, done, _ = flow.run_flow.py_func(engine.stepper.method, problem, 1, engine.counts.array, engine.stop.flag)
    assert (status, done) == (TOO_MANY_STEPS, 0)
    assert failure(status).error.status == "too-many-steps"


def test_an_orbit_with_more_events_than_its_log_holds_has_a_status_of_its_own() -> None:
    """An undamped bead between a slow driver and the wall has 4600 contact events in one drive period; the log has 4000
    places.
    """
    stroboscopic_map = StroboscopicMap(scene("sec2").evolve(N=1, dissipation="none", f=5.0), 1)
    velocity = 0.5 / stroboscopic_map.engine.scaled.scales.velocity
    with pytest.raises(ComputationError, match="more than 2000 contact events") as caught:
        stroboscopic_map.end(np.array([0.0, velocity]))
    assert caught.value.status == "too-many-events"
