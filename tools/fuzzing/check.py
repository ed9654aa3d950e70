"""The verdict on one drawn scene: a motion or an outcome with a sentence, and every check that failed."""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from granchain_core import BadInput, Cancelled, ComputationError, Run, Scene, run
from granchain_core.errors import OverBudget
from granchain_core.execution.stop import Stop
from granchain_core.integrate import Engine, MethodSetting, method_for
from granchain_core.scene.state import rest

from . import oracle, properties
from .properties import SAMPLES, distance
from .scenes import Draw

PERIODS = 2
#: Time that a run may take [s].
BUDGET = 5.0
#: After twice the budget plus this time [s], a run counts as hung, and its stop flag is raised.
FLOOR = 5.0
#: Relative error of a displacement from which it matters.
SILENT = 1e-3
#: Relative change that rounding alone may make.
_ROUNDING = 1e-10
#: How much more rounding may be magnified than a change of tolerance shows.
_MAGNIFIED = 1e3
#: Largest energy residual over the error of the displacements; being a quadrature along the motion, it reached 17.
_ENERGY = 50.0
#: Time that SciPy takes, in both its runs, per step of dop853 [s]; a scene that would take too long is not started.
_SCIPY_STEP = 2.5e-4
#: A motion known less accurately than this is chaotic, and only its outcome, time and symmetries are judged.
_CHAOS = 1e-4


@dataclass
class Verdict:
    """The result of a draw. Errors are relative to the largest displacement.

    `known` is the error of the truth itself, and `steps` the number of steps of dop853. `faults` are (name, figure) of
    the checks that failed, and `others` are outcomes and errors of the naive solvers.
    """

    draw: Draw
    outcome: str
    sentence: str = ""
    seconds: float = 0.0
    error: float = np.nan
    stated: float = np.nan
    known: float = np.nan
    steps: int = 0
    against_scipy: bool = False
    faults: list[tuple[str, float]] = field(default_factory=list)
    others: dict[str, tuple[str, float]] = field(default_factory=dict)

    @property
    def judged(self) -> bool:
        """Whether the truth is known clearly better than the stated error."""
        return bool(self.known < 0.3 * self.stated)


def check(draw: Draw, compute: Callable[..., Run] = run, scipy: float = 0.0, others: float = 0.0,
          budget: float = BUDGET, patience: float = 1.0) -> Verdict:
    """Return the verdict on one draw; `compute` is used instead of `run`.

    The independent solver of oracle.py is a second judge if it takes at most `scipy` seconds. If tension is cut, `run`
    uses dop853 itself, and that solver is the only independent one. Naive RK4 and LSODA are judged too, for at most
    `others` seconds each. A computation that exceeds its time is ended only after `patience` times as long, so that the
    verdict does not depend on how busy the machine is: which computations start at all depends on estimates and counted
    steps.
    """
    try:
        chosen = draw.scene()
    except BadInput as refusal:
        fault = [] if draw.spoiled and str(refusal).endswith(".") else [("refused without need or sentence", 1.0)]
        return Verdict(draw, "refused: BadInput", str(refusal), faults=fault)
    except Exception as problem:  # any other failure is untyped, which is what the fuzzer looks for
        return Verdict(draw, "untyped", repr(problem), faults=[("untyped failure", 1.0)])
    verdict, found = _outcome(draw, chosen, compute, budget, patience)
    if draw.spoiled:
        verdict.faults.append(("a spoiled knob was accepted", 1.0))
    if found is None:
        return verdict
    _finite(verdict, found)
    try:
        with limit(2.0 * budget * patience) as stop:
            truth = _judge(verdict, found, stop)
            _properties(verdict, chosen, stop)
    except Cancelled:  # dop853 at its finest takes longer than the run; counted as not judged
        return verdict
    except ComputationError as problem:
        verdict.sentence = f"the judge failed: {problem}"
        return verdict
    if scipy > _SCIPY_STEP * verdict.steps:
        _second_judge(verdict, found, scipy * patience)
    if others > 0.0:
        _others(verdict, chosen, truth, others)
    return verdict


@contextlib.contextmanager
def limit(seconds: float) -> Iterator[np.ndarray]:
    """Yield a stop flag that is raised after `seconds`."""
    stop = Stop()

    def over() -> None:
        stop.set()

    timer = threading.Timer(seconds, over)
    timer.daemon = True
    timer.start()
    try:
        yield stop
    finally:
        timer.cancel()


def _outcome(draw: Draw, chosen: Scene, compute: Callable[..., Run], budget: float,
             patience: float) -> tuple[Verdict, Run | None]:
    began, found, fault, most = time.perf_counter(), None, "", patience * (2.0 * budget + FLOOR)
    try:
        with limit(most) as stop:
            found = compute(chosen, periods=0, record=PERIODS, samples=SAMPLES, stop=stop, budget=budget)
        outcome, sentence = found.status, ""
    except OverBudget as refusal:
        outcome, sentence = "refused: over budget", str(refusal)
    except BadInput as refusal:
        outcome, sentence = "refused: BadInput", str(refusal)
    except ComputationError as failure:
        outcome, sentence = f"failed: {failure.status}", failure.sentence
    except Cancelled:
        outcome, sentence, fault = "hang", f"stopped after {most:g} s", "hang"
    except Exception as problem:  # as above
        outcome, sentence, fault = "untyped", repr(problem), "untyped failure"
    seconds = time.perf_counter() - began
    verdict = Verdict(draw, outcome, sentence, seconds)
    if fault or seconds > most:
        verdict.faults.append((fault or "hang", seconds))
    elif found is None and not sentence.endswith("."):
        verdict.faults.append(("no sentence", 1.0))
    return verdict, found


def _finite(verdict: Verdict, found: Run) -> None:
    for name in ("displacement", "velocity", "force", "max_output_force", "displacement_error", "energy_residual"):
        value: Any = getattr(found, name)
        if value is None or not np.isfinite(value).all():
            verdict.faults.append((f"{name} is not finite", 1.0))


def _judge(verdict: Verdict, found: Run, stop: Stop) -> np.ndarray:
    """Compare the run with dop853 at its finest and check its energy; return the true displacements [m]."""
    chosen, kept = found.scene, []
    for tolerance in (3e-14, 3e-15):
        engine = Engine(chosen, MethodSetting("dop853", tolerance=tolerance), SAMPLES, account=True, stop=stop)
        engine.start(rest(chosen))
        kept.append(engine.record(PERIODS * SAMPLES))
        verdict.steps = engine.counts.steps
    true = kept[1].displacement * chosen.A0
    verdict.known = distance(kept[0].displacement, kept[1].displacement)
    verdict.stated = float("nan") if found.displacement_error is None else found.displacement_error
    verdict.error = distance(found.displacement, true)
    _bounded(verdict, "", verdict.error, verdict.known)
    if found.status == "done" and not verdict.stated <= chosen.accuracy:
        verdict.faults.append(("done, with a stated error above the accuracy asked for", verdict.stated / chosen.accuracy))
    if verdict.known < _CHAOS:
        limits = 1e-9 + 100.0 * verdict.known, 1e-9 + _ENERGY * max(verdict.stated, chosen.accuracy)
        figures = properties.energy(engine.scaled, kept[1]), found.energy_residual
        for name, figure, bar in zip(("energy of dop853", "energy"), figures, limits, strict=True):
            if figure is None or not figure <= bar:
                verdict.faults.append((name, np.nan if figure is None else figure / bar))
    return true


def _bounded(verdict: Verdict, by: str, error: float, known: float) -> None:
    """Add a fault if the stated error is below the true error, and a silent error if that error matters."""
    sure = error - 3.0 * known
    if not sure <= verdict.stated:
        verdict.faults.append((f"bound{by}", error / (verdict.stated + 3.0 * known)))
    if not sure <= max(SILENT, verdict.stated):
        verdict.faults.append((f"silent error{by}", error))


def _properties(verdict: Verdict, chosen: Scene, stop: Stop) -> None:
    rng = np.random.default_rng([verdict.draw.seed, verdict.draw.index, 1])
    bar = _ROUNDING + _MAGNIFIED * verdict.known
    power = int(rng.choice([-2, -1, 1, 2]))
    *figures, own = properties.mirrored(chosen, rng, stop)
    found = [("symmetric start", _ROUNDING + own), ("mirrored start", _ROUNDING + own)]
    if verdict.known < _CHAOS:
        found += [("scaling", bar), ("shift by a period", bar)]
        figures += [properties.scaling(chosen, power, stop), properties.shifted(chosen, stop)]
    verdict.faults += [(name, figure) for (name, most), figure in zip(found, figures, strict=True) if not figure <= most]


def _second_judge(verdict: Verdict, found: Run, seconds: float) -> None:
    """Compare the run with SciPy's DOP853 in (u, v), restarted at every event, within the error of that solver."""
    try:
        nearly, true = (oracle.located(found.scene, PERIODS, SAMPLES, rtol, seconds) for rtol in (1e-9, 1e-11))
    except (oracle.TooLong, ComputationError):
        return
    known = distance(nearly, true)
    if known < 0.3 * max(verdict.stated, SILENT):
        verdict.against_scipy = True
        _bounded(verdict, " (SciPy)", distance(found.displacement, true), known)


def _others(verdict: Verdict, chosen: Scene, true: np.ndarray, seconds: float) -> None:
    """Record the answers of naive RK4, with the steps of our own fixed-step method, and of LSODA as a user calls it."""
    refine = 2.0 * method_for(max(chosen.accuracy, 1e-9)).refine

    def naive() -> np.ndarray:
        with limit(seconds) as stop:
            engine = Engine(chosen, MethodSetting("rk4-naive", refine), SAMPLES, stop=stop)
            engine.start(rest(chosen))
            return engine.record(PERIODS * SAMPLES).displacement * chosen.A0

    for name, compute in (("naive RK4", naive), ("LSODA", lambda: oracle.as_a_user(chosen, PERIODS, SAMPLES, seconds))):
        try:
            verdict.others[name] = "returned", distance(compute(), true)
        except ComputationError as failure:
            verdict.others[name] = "failed, and said so", np.nan
            del failure
        except (Cancelled, oracle.TooLong):
            verdict.others[name] = "took too long", np.nan
