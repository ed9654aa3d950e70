"""The motion of a settling chain as a result: the motion so far, or its refined periodic orbit with an error.

Motions that are not periodic are recorded with the setting with which they settled, without a stated error. `origin` is
where the motion started, in the words of a run's `start`.
"""

from __future__ import annotations

import time
from dataclasses import replace

from ...integrate import Engine
from ...integrate.stated import relative_difference
from ...results.regime import Regime
from ...results.run import Cost, run_from
from ..orbit_errors import error_of_displacements, errors_between
from .advance import SettlingRun
from .outcome import Settled
from .refine_orbit import FARTHEST_FROM_ORBIT, refined_orbit

#: Number of periods shown of a motion that is not periodic.
_PERIODS_SHOWN = 4


def motion_so_far(motion: SettlingRun, samples: int, began: float, origin: str, final: bool) -> Settled:
    """Record the current motion over one orbit or a few periods; the settling itself is not advanced."""
    engine = Engine(motion.scene, motion.engine.setting, samples, stop=motion.stop)
    state = motion.engine.state
    engine.start(state)
    periods = motion.regime.period or _PERIODS_SHOWN
    record = engine.record(periods * samples)
    engine.counts.array += motion.engine.counts.array
    cost = Cost.of(time.perf_counter() - began, engine.counts, engine.setting.method)
    run = run_from(engine, record, 0, motion.regime, None, cost, start=origin)
    return Settled(run, motion.regime, state, preview=not final, final=final)


def recorded_orbit(motion: SettlingRun, samples: int, began: float, origin: str) -> Settled:
    """Record the periodic orbit with the finer method, and its error: integration plus distance from the orbit.

    An error e of the n-period map moves its fixed point by e/(1 − |μ|). If the finer method does not bring the chain to
    the orbit, it is unsettled.
    """
    n = motion.regime.period
    assert n is not None
    engine, distance = refined_orbit(motion, motion.scene.accuracy, samples)
    if distance > FARTHEST_FROM_ORBIT:
        motion.engine, motion.regime = engine, Regime.unsettled(motion.regime.periods_run)
        return motion_so_far(motion, samples, began, origin, final=True)
    start = engine.state
    fine = Engine(motion.scene, engine.setting.finer(), samples, stop=motion.stop)
    fine.start(start)
    record = fine.record(n * samples)
    coarse = Engine(motion.scene, engine.setting, samples, stop=motion.stop)
    coarse.start(start)
    other = coarse.record(n * samples)
    integration = relative_difference(record.displacement, other.displacement)
    fine.counts.array += motion.engine.counts.array + engine.counts.array + coarse.counts.array
    cost = Cost.of(time.perf_counter() - began, fine.counts, fine.setting.method)
    regime = replace(motion.regime, distance=distance)
    integration = error_of_displacements(integration, fine.setting, motion.regime.assumed_contraction)
    forces = errors_between(fine, coarse.maxima, motion.regime.assumed_contraction, distance)
    run = run_from(fine, record, 0, regime, integration + distance, cost, force_errors=forces, start=origin)
    return Settled(run, regime, start, preview=False, final=True)
