"""The output force from naive methods (plain steps in (u, v)), for comparison with the accurate force.

The accuracy page shows them, because the picture looks like a result, and nothing in it shows that it is wrong.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..errors import ComputationError
from ..execution.stop import Stop
from ..integrate import METHODS, Engine, MethodSetting, dop853_setting
from ..integrate.scaling import ScaledChain
from ..scene import Scene

#: Usual numbers of steps per drive period; the second is shown first.
NATURAL_STEPS = (100, 200, 500, 1000, 2000)
#: Samples per period of the plotted force, a divisor of all these numbers of steps.
_SAMPLES = 100
#: Drive periods run from rest; without a drive, a single time 1/f.
_RUN = 10
#: Drive periods shown, the last of the run: in a 1:3 resonance, one push in three is strong.
_SHOWN = 3
#: The reference.
_TRUE = dop853_setting(1e-11)


@dataclass(frozen=True)
class PlainSteps(MethodSetting):
    """A fixed-step setting given by its number of steps per drive period."""

    steps: int = 0

    def steps_per_period(self, scaled: ScaledChain, samples: int) -> int:
        """Return the requested number of steps, which must be a multiple of `samples`."""
        return self.steps


@dataclass(frozen=True, eq=False)
class NaiveLine:
    """One naive method at one step: its output force [N], and the largest error over the run's largest force.

    `failure` says why there is no result.
    """

    method: str
    steps: int
    error: float
    force: np.ndarray
    failure: str = ""


@dataclass(eq=False)
class NaiveComparison:
    """The accurate output force [N] over time [s] at the end of a run from rest, and the naive methods' results."""

    time: np.ndarray
    force: np.ndarray
    lines: list[NaiveLine] = field(default_factory=list)


def naive_comparison(scene: Scene, stop: Stop) -> NaiveComparison:
    """Run the naive methods at usual steps. Raises `ComputationError` where the reference fails, and `Cancelled`."""
    first = (_RUN - _SHOWN) * _SAMPLES if scene.is_driven else 0
    forces = output_force(scene, _TRUE, stop)
    true = forces[first:]
    time = (first + np.arange(len(true))) / _SAMPLES * scene.period
    result = NaiveComparison(time, true)
    largest = float(np.abs(forces).max())
    for method in METHODS.values():
        if not method.naive:
            continue
        for steps in NATURAL_STEPS:
            try:
                force = output_force(scene, PlainSteps(method.name, steps=steps), stop)[first:]
            except ComputationError as problem:
                result.lines.append(NaiveLine(method.name, steps=steps, error=float("inf"), force=np.zeros(0),
                                              failure=problem.sentence))
                continue
            error = float(np.abs(force - true).max()) / largest if largest > 0.0 else 0.0
            result.lines.append(NaiveLine(method.name, steps, error, force))
    return result


def output_force(scene: Scene, setting: MethodSetting, stop: Stop) -> np.ndarray:
    """Return the total force on the wall from rest [N], at both ends of every sample."""
    engine = Engine(scene, setting, _SAMPLES, stop=stop)
    return engine.scaled.scales.forces(engine.record((_RUN if scene.is_driven else 1) * _SAMPLES).force[:, -1])
