"""Numbers that fail are caught and said, never hidden."""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core import NumbersFailed, run, scene
from granchain_core.integrate import Engine, Setting
from granchain_core.integrate.failure import Failure
from granchain_core.kernels.flow import run as flow
from granchain_core.kernels.flow.attempt import FlowProblem
from granchain_core.kernels.status import CHATTER, DONE, TOO_MANY_STEPS
from granchain_core.orbits.stroboscopic_map import StroboscopicMap


@pytest.mark.parametrize("method", ["rk4", "rk4-split", "dop853", "dop853-root"])
@pytest.mark.parametrize("row", ["displacement", "w"])
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("bead", [1, 6, 11])
def test_an_injected_nan_or_infinity_ends_the_run_with_its_sentence(method, row, value, bead):
    """Whatever bead and variable it is put into, the next record says that the numbers failed."""
    engine = Engine(scene("sec2"), Setting(method, tolerance=1e-6), 8)
    engine.record(12)
    engine.y[bead + (13 if row == "w" else 0)] = value
    with pytest.raises(NumbersFailed) as caught:
        engine.record(8)
    assert caught.value.status == "not-finite"
    assert "bead" in caught.value.sentence
    assert "s (" in caught.value.sentence


@pytest.mark.parametrize("method", ["rk4", "rk4-split", "dop853", "dop853-root"])
def test_the_sentence_names_the_bead_that_failed(method):
    """Not the first one by default: exit status 3 promises which bead, when and why."""
    engine = Engine(scene("sec2"), Setting(method, tolerance=1e-6), 8)
    engine.record(12)
    engine.y[9] = np.nan
    with pytest.raises(NumbersFailed, match="bead 9 "):
        engine.record(8)


def test_the_sentence_names_the_time_since_the_start():
    """After twenty periods the failure is at about twenty periods, not at the beginning of the present chunk."""
    engine = Engine(scene("sec2"), Setting("rk4", tolerance=1e-6), 8)
    engine.periods(20)
    engine.y[1:12] = np.nan
    with pytest.raises(NumbersFailed, match=r"\(2\d(\.\d+)? drive periods\)"):
        engine.periods(2)


@pytest.mark.parametrize("method", ["rk4", "rk4-split", "dop853", "dop853-root"])
def test_a_nan_in_the_periods_kernel_is_caught_too(method):
    """The kernel for settling looks as well as the one for recording."""
    engine = Engine(scene("sec2"), Setting(method, tolerance=1e-6), 1)
    engine.periods(2)
    engine.y[4] = np.nan
    with pytest.raises(NumbersFailed, match="bead 4 stopped being a finite number"):
        engine.periods(1)


@pytest.mark.parametrize("accuracy", [1e-3, 1e-5, 1e-8])
@pytest.mark.parametrize("k", [1e8, 1e10])
def test_the_stiffest_foundation_that_is_accepted_is_integrated(k, accuracy):
    """k is valid up to 1e10 N/m; its bead frequency has to enter the choice of the step."""
    result = run(scene("sec2").evolve(k=k, accuracy=accuracy, f=3000.0), periods=0, record=1, samples=8)
    assert result.status == "done"
    assert np.abs(result.displacement).max() < result.scene.A0


@pytest.mark.parametrize("knobs", [{"D": 1e4}, {"A0": 1e-10}, {"A0": 1e-4}, {"F0": 1e4}, {"wall": 1e6}, {"wall": 1e-6},
                                   {"f": 1e6}, {"N": 1}, {"N": 300}])
@pytest.mark.parametrize("accuracy", [1e-4, 1e-8])
def test_extreme_but_valid_knobs_give_a_finite_motion(knobs, accuracy):
    """Every corner of the ranges that one can wait for is computed to the accuracy asked for."""
    result = run(scene("sec2").evolve(f=3000.0, accuracy=accuracy).evolve(**knobs), periods=0, record=1, samples=8)
    assert result.status == "done"
    assert np.isfinite(result.force).all()
    assert np.isfinite(result.displacement).all()


def failure(status: int) -> Failure:
    """A computation that ended with this status."""
    return Failure(status, 1.0, 0, None, {}, scene("sec2"), "dop853")


def test_a_status_nobody_knows_is_no_chatter() -> None:
    with pytest.raises(ValueError, match="99 is not the status"):
        _ = failure(99).error
    assert failure(CHATTER).error.status == "chatter"


def test_a_period_of_too_many_steps_is_no_step_that_shrank(monkeypatch: pytest.MonkeyPatch) -> None:
    """The flow's own loop, with steps that lead nowhere and patience for three of them."""
    def step(*words: object) -> tuple[int, None, float, int]:
        return DONE, None, 0.0, -1

    monkeypatch.setattr(flow, "_MOST_STEPS", 3)
    monkeypatch.setattr(flow, "begin", lambda *words: None)
    monkeypatch.setattr(flow, "evaluate", lambda *words: None)
    monkeypatch.setattr(flow, "flow_step", step)
    stroboscopic_map = StroboscopicMap(scene("sec2"), 1)
    engine = stroboscopic_map.engine
    status, done, _ = flow.run_flow.py_func(engine.stepper.method, FlowProblem(engine.stepper.trajectory(engine.y), stroboscopic_map._contacts, None), 1,
                                            engine.counts.array, engine.stop.flag)
    assert (status, done) == (TOO_MANY_STEPS, 0)
    assert failure(status).error.status == "too-many-steps"
