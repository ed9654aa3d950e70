"""Settling a single chain, for points of curves and maps that a batch cannot compute or decide."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...errors import ComputationError
from ...execution.stop import Stop
from ...integrate import Engine
from ...results.regime import Regime
from ...scene import Scene
from ...scene.state import State
from ..orbit_errors import errors_between
from ..steady_state import IRREGULAR_PERIODS, SteadyState
from .advance import SettlingRun, run_until_settled
from .refine_orbit import FARTHEST_FROM_ORBIT, refined_orbit

#: Points of curves and maps that are settled alone are computed at best to this relative accuracy, even if the scene
#: requests more. A batch does not read the scene's accuracy.
CURVE_ACCURACY = 1e-5


def settle_to_forces(scene: Scene, start: State | None, stop: Stop, periods_run: int = 0) -> SteadyState:
    """Settle `scene` from rest or from `start`; refine the steady state if it is periodic.

    `periods_run` drive periods came before `start`.
    """
    settling = run_until_settled(scene, start, stop, periods_run)
    if settling.regime.name == "periodic":
        return _on_its_orbit(settling)
    maxima = settling.engine.scaled.scales.forces(settling.maxima[-IRREGULAR_PERIODS:].max(axis=0))
    return SteadyState(scene, maxima=maxima, regime=settling.regime, errors=None, state=settling.engine.state)


def _on_its_orbit(settling: SettlingRun) -> SteadyState:
    """Largest forces on the refined orbit, and their errors from a finer computation.

    If the finer method does not bring the chain to the orbit, it is unsettled.
    """
    engine, distance = refined_orbit(settling, max(settling.scene.accuracy, CURVE_ACCURACY))
    n = settling.regime.period
    assert n is not None
    if distance > FARTHEST_FROM_ORBIT:
        _, maxima = engine.periods(IRREGULAR_PERIODS)
        return SteadyState(settling.scene, maxima=engine.scaled.scales.forces(maxima.max(axis=0)),
                           regime=Regime.unsettled(settling.regime.periods_run), errors=None, state=engine.state)
    before = engine.advance_and_find_largest(n)
    finer = Engine(settling.scene, engine.setting.finer(), 1, stop=settling.stop)
    finer.start(engine.state)
    maxima = finer.advance_and_find_largest(n)
    errors = errors_between(finer, before, settling.regime.assumed_contraction, distance)
    return SteadyState(settling.scene, maxima=finer.scaled.scales.forces(maxima), regime=settling.regime, errors=errors,
                       state=finer.state)


def settle_or_failure(scene: Scene, start: State | None, stop: Stop, periods_run: int = 0) -> SteadyState:
    """Like `settle_to_forces`, but return a steady state with the failure, so that one failed point loses no curve."""
    try:
        return settle_to_forces(scene, start, stop, periods_run)
    except ComputationError as failed:
        resting = State(np.zeros(scene.N), np.zeros(scene.N))
        return SteadyState(scene, maxima=np.full(3, np.nan), regime=Regime.unsettled(periods_run), errors=None,
                           state=start or resting, failure=failed.sentence, status=failed.status)


def settled_alone(undecided: SteadyState, stop: Stop) -> SteadyState:
    """Settle alone, from its last state, a chain that failed in a batch or was left undecided by it."""
    settled = settle_or_failure(undecided.scene, undecided.state, stop, undecided.regime.periods_run)
    return replace(settled, number=undecided.number)
