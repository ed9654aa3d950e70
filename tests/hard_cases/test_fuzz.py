"""Random scenes: every scene satisfies the invariants, and the checker notices planted faults.

This file draws a few scenes of one structure; `python -m tools.fuzzing` draws thousands of all (docs/hard-cases.md).
"""

from __future__ import annotations

import functools
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from granchain_core import Cancelled, ComputationError, Run, run
from granchain_core.errors import OverBudget
from granchain_core.execution.stop import Stop
from granchain_core.integrate.scaling import scale_chain
from tools.fuzzing import check as checker
from tools.fuzzing import oracle, properties
from tools.fuzzing.check import Verdict, check
from tools.fuzzing.many import warm
from tools.fuzzing.scenes import STRUCTURES, Draw, draw
from tools.fuzzing.table import describe, known, silent_other, table

SEED, COUNT = 7, 60
ONE = STRUCTURES[:1]
#: Time allowed for a run here [s]: the slowest scenes are left to the program.
SHORT = 1.0
#: A scene that was begun may take this many times longer, and so may SciPy, which is allowed a second: a busy machine
#: must not decide the outcome.
PATIENCE = 100.0
#: Time allowed for SciPy if its answer is the test [s]: far more than the second it needs, for the same reason.
PATIENT = 600.0
EASY = Draw(0, 0, {"N": 3, "f": 1000.0, "accuracy": 1e-5}, {}, False)


@functools.cache
def found() -> list[Verdict]:
    """Return the verdicts; every tenth scene is judged by SciPy too."""
    warm(ONE)
    return [check(draw(SEED, i, ONE), scipy=0.0 if i % 10 else 1.0, budget=SHORT, patience=PATIENCE)
            for i in range(COUNT)]


@pytest.mark.long
def test_every_check_holds_in_random_scenes() -> None:
    """No exception is allowed, although two computations that agree by chance understate the error in one of 1000
    scenes.
    """
    print(table(found()))
    assert [describe(v) for v in found() if v.faults] == []


def test_most_scenes_are_judged() -> None:
    assert len(known(found())) > 0.8 * COUNT
    assert sum(v.against_scipy for v in found()) >= 4
    assert {"done", "refused: BadInput"} <= {v.outcome for v in found()}


def test_a_scene_is_drawn_from_its_seed_and_number() -> None:
    again = [draw(SEED, i, ONE) for i in (3, 47)]
    assert [(d.knobs, d.special) for d in again] == [(found()[i].draw.knobs, found()[i].draw.special) for i in (3, 47)]
    assert draw(SEED + 1, 3, ONE).knobs != again[0].knobs


# --- planted faults, which the checker must notice --------------------------------------------------------


def faults(change: Callable[[Run], Run]) -> set[str]:
    """Return the names of the faults found in an easy scene whose run is changed."""
    return {name for name, _ in check(EASY, lambda *words, **names: change(run(*words, **names)), scipy=PATIENT).faults}


def moved(result: Run, by: float) -> Run:
    """Return a run whose last displacement is wrong by this fraction of the largest."""
    wrong = result.displacement.copy()
    wrong[-1, -1] += by * np.abs(wrong).max()
    return replace(result, displacement=wrong)


def test_a_correct_run_is_not_reported() -> None:
    assert faults(lambda result: result) == set()


def test_an_error_above_the_stated_one_is_noticed_by_both_judges() -> None:
    assert faults(lambda result: moved(result, 1e-4)) == {"bound", "bound (SciPy)"}


def test_a_silent_error_is_noticed() -> None:
    assert {"silent error", "silent error (SciPy)"} <= faults(lambda result: moved(result, 1e-2))


def test_an_error_that_is_stated_is_not_silent() -> None:
    assert faults(lambda result: replace(moved(result, 1e-2), displacement_error=2e-2, status="accuracy-not-reached")) == set()


def test_a_stated_error_that_is_too_small_is_noticed() -> None:
    assert "bound" in faults(lambda result: replace(result, displacement_error=1e-3 * result.displacement_error))


def test_a_run_that_is_called_done_too_early_is_noticed() -> None:
    assert faults(lambda result: replace(result, displacement_error=0.5)) == {"done, with a stated error above the accuracy asked for"}


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_numbers_that_are_not_finite_are_noticed(bad: float) -> None:
    assert {"displacement is not finite", "silent error"} <= faults(lambda result: moved(result, bad))


def test_energy_that_does_not_close_is_noticed() -> None:
    assert faults(lambda result: replace(result, energy_residual=1e-3)) == {"energy"}


def raising(problem: Exception) -> Callable[..., Run]:
    """Return a function that raises this error instead of running."""
    def compute(*words: Any, **names: Any) -> Run:
        raise problem
    return compute


@pytest.mark.parametrize(("problem", "outcome", "noticed"), [
    (ZeroDivisionError("x"), "untyped", ["untyped failure"]),
    (FloatingPointError("x"), "untyped", ["untyped failure"]),
    (ComputationError("", "not-finite"), "failed: not-finite", ["no sentence"]),
    (ComputationError("Bead 3 is no longer finite.", "not-finite"), "failed: not-finite", []),
    (OverBudget("This would take 3 years.", 1e8, 1.0), "refused: over budget", []),
])
def test_a_failure_without_type_or_sentence_is_noticed(problem: Exception, outcome: str, noticed: list[str]) -> None:
    verdict = check(EASY, raising(problem))
    assert (verdict.outcome, [name for name, _ in verdict.faults]) == (outcome, noticed)


def test_a_hang_is_ended_and_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(checker, "FLOOR", 0.1)

    def never(*words: Any, stop: Stop, **names: Any) -> Run:
        while not stop:
            time.sleep(0.01)
        raise Cancelled

    verdict = check(EASY, never, budget=0.1)
    assert verdict.outcome == "hang" and verdict.faults[0][0] == "hang"


def test_an_invalid_knob_that_is_accepted_is_noticed() -> None:
    assert ("a spoiled knob was accepted", 1.0) in check(replace(EASY, spoiled=True)).faults


def test_an_asymmetry_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    real = properties._symmetric

    def crooked(scene: Any) -> Any:
        made = real(scene)
        made.slots.chain.stiffness[0] *= 1.0 + 1e-6
        return made

    monkeypatch.setattr(properties, "_symmetric", crooked)
    assert {name for name, _ in check(EASY).faults} == {"symmetric start", "mirrored start"}


def test_a_length_that_does_not_scale_and_a_state_that_is_rounded_are_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    real = properties._period

    def absolute(scene: Any, start: Any, stop: Stop) -> np.ndarray:
        return np.round(real(scene, start, stop), 6) + 1e-7 * scene.A0 / EASY.scene().A0 * (start.displacement[0] != 0.0)

    monkeypatch.setattr(properties, "_period", absolute)
    assert "shift by a period" in {name for name, _ in check(EASY).faults}
    monkeypatch.setattr(properties, "_period", lambda scene, start, stop: (
        real(scene, start, stop) + 1e-9 * (scale_chain(scene).scales.length > 1e-6)))
    assert "scaling" in {name for name, _ in check(EASY).faults}


# --- the results of other solvers -------------------------------------------------------------------------


def test_lsoda_as_it_comes_is_silently_wrong_and_a_located_solver_is_not() -> None:
    tiny = replace(EASY, knobs={**EASY.knobs, "A0": 1e-8})
    verdict = check(tiny, scipy=PATIENT, others=PATIENT)
    assert verdict.faults == [] and verdict.against_scipy
    assert silent_other(verdict, "LSODA")
    assert verdict.others["naive RK4"][1] > 10.0 * verdict.error


def test_the_independent_solver_says_when_its_time_is_over() -> None:
    with pytest.raises(oracle.TooLong):
        oracle.located(EASY.scene(), 2, 16, 1e-11, 0.0)
