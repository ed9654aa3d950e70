"""The motion of a chain without a drive, which has no steady state: from its start, to the requested accuracy."""

from __future__ import annotations

import time
from dataclasses import replace

from ...execution.stop import Stop
from ...integrate import Counts, Engine, MethodSetting, following_setting
from ...integrate.methods import typical_error
from ...integrate.stated import relative_difference
from ...kernels.samples import Samples
from ...results.regime import Regime
from ...results.run import Cost, run_from, start_words
from ...scene import Scene
from ...scene.state import State, checked_start, rest
from ..orbit_errors import errors_between
from .outcome import Settled

#: Finest steps: number of steps that replace one default step.
_FINEST_REFINEMENT = 64


def undriven_motion(scene: Scene, start: State | None, samples: int, began: float, stop: Stop | None) -> Settled:
    """Compute the motion of a chain without a drive from its start, over the time 1/f, to the requested accuracy."""
    begin = rest(scene) if start is None else replace(checked_start(scene, start), phase=0.0)  # there is no phase
    setting, total = following_setting(scene.cuts_tension), Counts()

    def recorded(chosen: MethodSetting) -> tuple[Engine, Samples]:
        engine = Engine(scene, chosen, samples, stop=stop)
        engine.start(begin)
        rows = engine.record(samples)
        total.array += engine.counts.array
        return engine, rows

    coarse, before = recorded(setting)
    while True:
        setting = setting.finer_than(coarse.scaled, samples)
        fine, rows = recorded(setting)
        change = relative_difference(rows.displacement, before.displacement)
        if change <= scene.accuracy or setting.finest or setting.refine >= _FINEST_REFINEMENT:
            break
        coarse, before = fine, rows
    regime, cost = Regime.undriven(1), Cost.of(time.perf_counter() - began, total, setting.method)
    forces = errors_between(fine, coarse.maxima, 0.0, 0.0)
    run = run_from(fine, rows, 0, regime, max(change, typical_error(setting)), cost, force_errors=forces,
                   start=start_words(scene, start))
    return Settled(run, regime, begin, preview=False, final=True)
