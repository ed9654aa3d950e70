"""Running a chain towards its steady state until its regime is decided.

The chain runs from its start with the setting of `following_setting` (integrate/methods.py) until the distance bound is
small (steady/regime_criteria.py) or the regime is decided otherwise (regime_decisions.py). A periodic orbit is then
computed again with a finer setting (refine_orbit.py), and recording.py records the motion.
"""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np

from ...execution.stop import Stop
from ...integrate import METHODS, Engine, following_setting
from ...integrate.start import at_phase_0
from ...results.regime import Regime
from ...scene import Scene
from ...scene.refusals import refuse_undriven
from ...scene.state import State, rest
from ..regime_criteria import find_period, rounding_of
from .regime_decisions import EXAMINED_AFTER, REMEMBERED, Decisions

#: [unsettled] Maximum number of steps of a chain settled alone, or of a coarse run. They take 6 s for eleven beads, at
#: 60 ns per step; where tension is cut, a hundred times as long.
MOST_SETTLING_STEPS = 100_000_000
#: [period n] A chain alone: drive periods before the first check for a period.
_FIRST_CHECK = 2
#: [period n] A chain alone: fewest drive periods between two checks; later an eighth of those run so far.
_BETWEEN_CHECKS = 8


class SettlingRun:
    """A chain on its way to its steady state, run chunk by chunk until the regime is decided.

    `periods_run` is the number of drive periods that were run before `start`; they are counted.
    """

    def __init__(self, scene: Scene, start: State | None, stop: Stop | None, periods_run: int = 0) -> None:
        refuse_undriven(scene)
        self.scene = scene
        self.engine = Engine(scene, following_setting(scene.cuts_tension), 1, stop=stop)
        self.stop = self.engine.stop
        self.engine.start(rest(scene) if start is None else at_phase_0(scene, start, self.stop))
        self._first = periods_run
        self.maxima = np.zeros((0, 3))
        self._begin(periods_run)
        self.decisions = Decisions(self.scene, start is not None)
        self.decided = False

    def _begin(self, periods_run: int) -> None:
        """Begin a record of strobes at the engine's state, after `periods_run` periods; `_here` counts from there."""
        first, scales = self.engine.state, self.engine.scaled.scales
        self.strobes = np.array([[scales.scaled_displacements(first.displacement),
                                  scales.scaled_velocities(first.velocity)]])
        self._run_before, self._here, self._stop_at = periods_run, 0, EXAMINED_AFTER
        self._check_at = _FIRST_CHECK
        self.regime = Regime.unsettled(periods_run)

    def go_on(self, seconds: float) -> None:
        """Run until the regime is decided, the budget is used up, or about `seconds` have passed."""
        end = time.perf_counter() + seconds
        while not self.decided and self.advance_for(end - time.perf_counter()):
            self._decide()
            if time.perf_counter() > end:
                return

    def advance_for(self, seconds: float) -> bool:
        """Run for `seconds`, or until a decision is due, which may need other kernels; return True if one is due."""
        end, per_period = time.perf_counter() + seconds, 0.0
        while not self._finished:
            left = end - time.perf_counter()
            if per_period and left < per_period:
                return False
            chunk = _FIRST_CHECK if per_period == 0.0 else max(1, int(min(left / per_period, MOST_SETTLING_STEPS)))
            chunk = min(chunk, self._check_at - self._here, self._stop_at - self._here,
                        max(1, self._steps_left() // self._steps_per_period()))
            began = time.perf_counter()
            strobes, maxima = self.engine.periods(chunk)
            per_period = (time.perf_counter() - began) / chunk
            self.maxima = np.concatenate([self.maxima, maxima])
            self._note(strobes[1:])
        return True

    def _note(self, strobes: np.ndarray) -> None:
        """Add strobes to the record, of which only the last are kept, and check for a period when a check is due.

        The interval between two checks is an eighth of the periods so far, so that checks cost little. When they are
        due depends only on the motion, and not on the speed of the machine.
        """
        self._here += len(strobes)
        self.strobes = np.concatenate([self.strobes[-REMEMBERED:], strobes])
        if self._here >= min(self._check_at, self._stop_at):
            self._check_at = self._here + max(_BETWEEN_CHECKS, self._here // 8)
            self.regime = find_period(self.strobes[-REMEMBERED:], rounding=rounding_of(self.engine.setting))
        self.regime = replace(self.regime, periods_run=self._run_before + self._here)

    def _steps_per_period(self) -> int:
        """Steps per drive period; with error control, their mean so far."""
        if not METHODS[self.engine.setting.method].error_control:
            return self.engine.grid
        return max(1, self.engine.counts.steps // max(1, self.regime.periods_run - self._first))

    def _steps_left(self) -> int:
        return MOST_SETTLING_STEPS - self.engine.counts.steps

    @property
    def _finished(self) -> bool:
        """Whether it is time for a decision."""
        return self.regime.name == "periodic" or self._steps_left() <= 0 or self._here >= self._stop_at

    def _decide(self) -> None:
        """Make the next decision: a regime, a later state from which the motion continues, or just more periods.

        If the budget of steps is used up, the chain remains unsettled: more evidence would cost as much again.
        """
        if self._steps_left() <= 0 and self.regime.name != "periodic":
            self.decided = True
            return
        decision = self.decisions.decide(self.engine, self.strobes[-REMEMBERED:], self.regime)
        if decision.state is not None:
            self.engine.start_scaled(decision.state)
        if decision.regime is not None:
            self.regime, self.decided = decision.regime, True
        elif decision.state is not None:
            self._begin(self._run_before + self._here)
        else:
            if decision.strobes is not None:
                self._note(decision.strobes)
            self._stop_at = self._here + EXAMINED_AFTER


def run_until_settled(scene: Scene, start: State | None, stop: Stop | None, periods_run: int = 0) -> SettlingRun:
    """Run to the steady state, or to the end of the budget; `periods_run` drive periods came before `start`."""
    settling = SettlingRun(scene, start, stop, periods_run)
    settling.go_on(np.inf)
    return settling
