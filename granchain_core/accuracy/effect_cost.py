"""The cost of one effect per step: kernels with and without it, timed alternately.

There are two costs. The effect's *code* is timed with plain RK4, whose every step does the same arithmetic. The method
rk4-split also splits steps where contacts open or close, so an effect that changes the motion (a preload that keeps
contacts closed, damping that makes an irregular motion periodic) costs or saves far more than its own code.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..errors import Cancelled
from ..execution.stop import Stop
from ..integrate import Engine, MethodSetting
from ..integrate.methods import RK4_SPLIT
from ..scene import Scene

#: Pairs of freshly allocated chains: an array's place in memory can make all its steps a fifth slower.
_CHAINS = 7
#: Alternating runs of each pair.
_TURNS = 7
#: Time of one run [s]; all runs together take about half a second.
_RUN = 0.004
#: Method that measures only the cost of an effect's code.
CODE = "rk4"
#: Method that measures an effect's cost in this motion, with steps split at contact events.
MOTION = RK4_SPLIT

#: Drive periods before timing, so that the chain is in motion.
_BEFORE = 3


@dataclass(frozen=True)
class Variant:
    """A kernel to be timed: a scene, and whether its equations include the energy account."""

    scene: Scene
    account: bool = False


@dataclass(frozen=True)
class EffectCost:
    """Nanoseconds per step with and without the effect, and their difference: medians over pairs of chains.

    `difference` is computed pair by pair, so that a temporary slowdown of the machine does not count as a cost of the
    effect. `spread` is the median distance of the pairs from it.
    """

    with_it: float
    without: float
    difference: float
    spread: float

    @property
    def percent(self) -> float:
        """Time that the effect adds to a step, in per cent of the time of a step without it."""
        return 100.0 * self.difference / self.without


def effect_cost(with_it: Variant, without: Variant, method: str = CODE, stop: Stop | None = None,
                pause: Callable[[], None] | None = None) -> EffectCost:
    """Time both kernels alternately; `pause` is called before each. Raises `Cancelled`.

    The fastest of a pair's runs count, because other processes on the machine can only make a run slower.
    """
    stop = Stop() if stop is None else stop
    times = np.zeros((_CHAINS, _TURNS, 2))
    for chain, turn in np.ndindex(_CHAINS, _TURNS):
        if pause is not None:
            pause()
        if stop:
            raise Cancelled
        if turn == 0:
            pair = [_Stepper(variant, method, stop) for variant in (with_it, without)]
        order = (0, 1) if turn % 2 else (1, 0)  # which one runs first alternates
        for place in order:
            times[chain, turn, place] = pair[place].nanoseconds_per_step()
    fastest = times.min(axis=1)
    middle = np.median(fastest, axis=0)
    differences = fastest[:, 0] - fastest[:, 1]
    difference = float(np.median(differences))
    spread = float(np.median(np.abs(differences - difference)))
    return EffectCost(float(middle[0]), float(middle[1]), difference, spread)


class _Stepper:
    """A chain in motion that can be timed for a short while."""

    def __init__(self, variant: Variant, method: str, stop: Stop) -> None:
        self._engine = Engine(variant.scene, MethodSetting(method), 1, account=variant.account, stop=stop)
        self._engine.periods(_BEFORE)
        self._periods = 1
        self._periods = max(1, int(_RUN / max(self._seconds(), 1e-7)))

    def _seconds(self) -> float:
        began = time.perf_counter()
        self._engine.periods(self._periods)
        return time.perf_counter() - began

    def nanoseconds_per_step(self) -> float:
        """Time one short run."""
        before = self._engine.counts.steps
        seconds = self._seconds()
        return 1e9 * seconds / (self._engine.counts.steps - before)
