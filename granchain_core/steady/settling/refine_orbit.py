"""Refining an orbit that was found with the default step, by a few more periods with a finer setting or extrapolation.
"""

from __future__ import annotations

import numpy as np

from ...integrate import Engine, MethodSetting, method_for
from ...kernels.strobes.extrapolation import ORBITS
from ...scene import Scene
from ...scene.state import State
from ..regime_criteria import changes
from .advance import SettlingRun
from .reduced_rank import reduced_rank, within_reach

#: [no threshold] Fraction of the requested error that the integration over an orbit may have on the first attempt.
INTEGRATION_FRACTION = 0.1
#: [no threshold] Fraction of the requested error that the remaining distance to the orbit may have.
_DISTANCE_FRACTION = 0.3
#: [no threshold] An orbit is computed at least to this relative accuracy, even if the scene requests less.
LEAST_ACCURATE = 1e-4
#: [no threshold] Smallest error of one period that is requested of a method: below it are rounding errors.
_LEAST_ERROR = 1e-13
#: [no threshold] The method is too coarse if a round leaves more than this fraction of the distance.
_STALLED_FRACTION = 0.3
#: [period n] A chain that a finer method leaves farther from its orbit than this is not called periodic: the orbit may
#: be stable only with coarse steps. In a batch, such a chain is left undecided and then settled alone.
FARTHEST_FROM_ORBIT = 1e-3
#: [no threshold] Maximum number of rounds; each has as many orbits as one extrapolation uses.
_MOST_ROUNDS = 12


def orbit_setting(scene: Scene, accuracy: float, contraction: float) -> MethodSetting:
    """The first setting for an orbit to `accuracy`: an error e of one period moves it by e/(1 − contraction).

    It is rk4-split with finer steps; dop853 if tension is cut, or if one period's error must be below
    `FIXED_STEP_CHEAPER_ABOVE` (integrate/methods.py).
    """
    one_period = INTEGRATION_FRACTION * min(accuracy, LEAST_ACCURATE) * (1.0 - contraction)
    return method_for(max(_LEAST_ERROR, one_period), scene.cuts_tension)


def refined_orbit(settling: SettlingRun, accuracy: float, samples: int = 1) -> tuple[Engine, float]:
    """Return an engine of the finer method on its own orbit, and the bound on the remaining distance.

    The orbit that the chain settled on differs from the true one by the error of its steps; a few more periods remove
    this difference. With r the contraction factor of the regime (|μ| if it was computed, otherwise the observed one)
    and `change` from one n-period map to the next, the remaining distance is change·r/(1 − r), or `change` if that is
    larger: a map that is not normal contracts by |μ| only in the long run. After an extrapolation it is known from the
    changes that follow; if these are not smaller, the extrapolation is undone.
    """
    scene, n = settling.scene, settling.regime.period
    assert n is not None
    contraction = settling.regime.assumed_contraction
    setting = orbit_setting(scene, accuracy, contraction)
    engine = Engine(scene, setting, samples, stop=settling.stop)
    engine.start(settling.engine.state)
    bound, unproved = np.inf, None
    for rounds in range(_MOST_ROUNDS):
        before = bound
        states = engine.strobe()
        for _ in range(ORBITS):
            moved, _ = engine.periods(n, watch=False)
            states = np.concatenate([states, moved[-1:]])
            change = float(changes(states, 1, 1)[0])
            if unproved is not None and change >= unproved[1]:
                break
            unproved, bound = None, change * max(1.0, contraction / (1.0 - contraction))
            if bound <= _DISTANCE_FRACTION * accuracy:
                return engine, bound
        if unproved is not None:  # the extrapolation did not come nearer: return to where it began
            engine.start(unproved[0])
            unproved, bound = None, np.inf
        elif bound > _STALLED_FRACTION * before and not setting.finest:
            # the changes are due to the method: it has to be finer to come nearer
            setting, state = setting.finer(), engine.state
            engine = Engine(scene, setting, samples, stop=settling.stop)
            engine.start(state)
        elif rounds < _MOST_ROUNDS - 1:  # a change after the last extrapolation must prove it
            here = engine.state
            unproved = (here, change) if move_to_limit(engine, states, change, contraction) else None
    return engine, bound


def move_to_limit(engine: Engine, states: np.ndarray, change: float, contraction: float) -> bool:
    """Put the engine at the limit of successive states (k, 2, N) if it is within reach; return True if it was."""
    limit = reduced_rank(states)
    largest = np.abs(states).max(axis=(0, 2))[:, None]
    if not within_reach(states[-1] / largest, limit / largest, change, contraction):
        return False
    scales = engine.scaled.scales
    engine.start(State(scales.displacements(limit[0]), scales.velocities(limit[1])))
    return True
