"""The budget of a run: its estimated cost, and a refusal that says what would fit.

The number of steps of a fixed-step method is known. That of a method with error control, and the time per step, were
measured on `sec2` and `rig` (`StepCost` in integrate/methods.py) and are scaled to this machine by the speed of its
square roots. A run is computed at least twice, the second time finer, and in about half of all cases a third time, so
the estimate is the geometric mean of the times of two and of three computations.
"""

from __future__ import annotations

import functools
import time
from dataclasses import dataclass

import numpy as np

from ..errors import OverBudget
from ..integrate import METHODS, MethodSetting, fixed_step_setting, method_for
from ..integrate.scaling import ScaledChain, scale_chain
from ..scene import Scene
from ..scene.quantities import QUANTITIES

#: Accuracy that is suggested if the run would then fit the budget.
_COARSE_ACCURACY = "1e-4"
#: Default budget of a run [s].
BUDGET = 86_400.0
#: Time per recorded sample [s], and per bead in it [s].
_SAMPLE = 0.6e-6, 40e-9
#: Time of 4096 square roots on the machine on which step costs were measured [s].
_REFERENCE_SPEED = 5.0e-6


@dataclass(frozen=True)
class Estimate:
    """Seconds and steps that a run is expected to take."""

    seconds: float
    steps: float


@functools.cache
def machine_factor() -> float:
    """Time of 4096 square roots relative to the machine of the step costs; measured once, in about a millisecond."""
    values, out, best = np.linspace(1.0, 2.0, 4096), np.empty(4096), np.inf
    for _ in range(100):
        began = time.perf_counter()
        np.sqrt(values, out=out)
        best = min(best, time.perf_counter() - began)
    return best / _REFERENCE_SPEED


def estimate(scene: Scene, setting: MethodSetting, periods: int, samples: int, record: int) -> Estimate:
    """Estimate the cost of a run whose first setting is `setting`, including the finer one for comparison."""
    return _estimate(scale_chain(scene), setting, periods, samples, record)


def _estimate(scaled: ScaledChain, setting: MethodSetting, periods: int, samples: int, record: int) -> Estimate:
    beads, steps, seconds = scaled.beads, 0.0, 0.0
    finer = setting.finer_than(scaled, samples)
    twice = _relative_cost(setting) + _relative_cost(finer)
    for attempt in (setting, finer):
        cost = METHODS[attempt.method].cost
        if METHODS[attempt.method].error_control:
            # if contacts are open most of the time, as at low frequency, steps are longer
            steps_per_time = cost.steps_per_time * (1e-8 / max(attempt.tolerance, 1e-16)) ** cost.power
            count = periods * max(16.0, scaled.period * steps_per_time)
        else:
            count = float(periods * attempt.steps_per_period(scaled, samples))
        steps += count
        seconds += count * (cost.fixed + cost.per_contact * (beads + 1))
    repetition_factor = np.sqrt(1.0 + _relative_cost(finer.finer_than(scaled, samples)) / twice)
    steps, seconds = steps * repetition_factor, seconds * repetition_factor
    seconds += 2.0 * record * samples * (_SAMPLE[0] + _SAMPLE[1] * beads)
    return Estimate(seconds * machine_factor(), steps)


def picture_seconds(scene: Scene, periods: int, samples: int) -> float:
    """Time [s] of `periods` drive periods by the fixed-step method, with `samples` samples per period."""
    setting, scaled = fixed_step_setting(), scale_chain(scene)
    cost = METHODS[setting.method].cost
    steps = float(periods * setting.steps_per_period(scaled, samples))
    return steps * (cost.fixed + cost.per_contact * (scene.N + 1)) * machine_factor()


def refuse_long_picture(scene: Scene, periods: int, samples: int, budget: float) -> None:
    """Raise `OverBudget`, whose sentence says what fits, if a picture would take longer than `budget` [s]."""
    seconds = picture_seconds(scene, periods, samples)
    if seconds <= budget:
        return
    part = 0.9 * budget / seconds
    beads = 0 if scene.impurities else int(scene.N * part)
    while beads and picture_seconds(scene.evolve(N=beads), periods, samples) > budget:
        beads = int(0.9 * beads)  # the time is not proportional to the number of beads
    fits = [f"N = {beads}"] if beads else []
    fastest = float(f"{1.1 * scene.f / part:.2g}")
    while fastest <= QUANTITIES["f"].high and picture_seconds(scene.evolve(f=fastest), periods, samples) > budget:
        fastest = float(f"{1.5 * fastest:.2g}")  # even a short period has a minimum number of steps
    if fastest <= QUANTITIES["f"].high:
        fits.append(f"f = {fastest:g} Hz")
    remedy = f"{' or '.join(fits)} would fit" if fits else "fewer beads and a higher frequency are needed"
    raise OverBudget(f"The first picture of this chain would take about {_in_words(seconds)}, and the limit "
                     f"is {_in_words(budget)}: {remedy}.", seconds, budget)


def _relative_cost(setting: MethodSetting) -> float:
    """Cost of a computation relative to others of the same run."""
    if METHODS[setting.method].error_control:
        return float(max(setting.tolerance, 1e-16) ** -METHODS[setting.method].cost.power)
    return setting.refine


def check_budget(scene: Scene, setting: MethodSetting, periods: int, record: int, samples: int,
                 budget: float) -> Estimate:
    """Estimate a run of `periods` discarded and `record` recorded periods; raise `OverBudget` if it does not fit."""
    total, scaled = periods + record, scale_chain(scene)
    estimate = _estimate(scaled, setting, total, samples, record)
    if estimate.seconds <= budget:
        return estimate
    fit = _what_fits(scene, total, budget / estimate.seconds)
    if setting == method_for(scene.accuracy, scene.cuts_tension):  # a method given by name keeps its steps
        coarse = method_for(float(_COARSE_ACCURACY), scene.cuts_tension)
        fits = _estimate(scaled, coarse, total, samples, record).seconds <= budget
        fit += [f"an accuracy of {_COARSE_ACCURACY}"] if fits else []
    remedy = f"{', or '.join(fit)} would fit" if fit else "a higher frequency or fewer beads are needed"
    raise OverBudget(f"This run would take about {_in_words(estimate.seconds)} ({estimate.steps:.1e} steps of "
                     f"{setting.method}), the budget is {_in_words(budget)}: {remedy}.", estimate.seconds, budget)


def _what_fits(scene: Scene, total: int, part: float) -> list[str]:
    """Smaller runs that would fit, given that the fraction `part` of this run does."""
    ways, periods, beads = [], int(total * part), int(scene.N * part)
    if periods >= 1:
        ways.append(f"{periods} period{'s' if periods > 1 else ''} in total")
    if beads >= 1 and not scene.impurities and not scene.start_velocity:
        ways.append(f"{beads} bead{'s' if beads > 1 else ''}")
    return ways


def _in_words(seconds: float) -> str:
    for size, unit in ((86400.0 * 365.25, "years"), (86400.0, "days"), (3600.0, "hours"), (60.0, "minutes")):
        if seconds >= 2.0 * size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds:.3g} s"
