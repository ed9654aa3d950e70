"""The search for unstable periodic orbits near a motion.

A chaotic or quasi-periodic motion passes near unstable periodic orbits. States that nearly return after n periods are
near an orbit of period n (Auerbach et al. 1987). An orbit that lost its stability at a period doubling or a
Neimark–Sacker bifurcation lies inside the attractor that was born there. Newton's method on the stroboscopic map starts
from the present state, from the mean of the section's states and from the closest returns. It may end on an orbit far
from its start: the distance between orbit and motion is reported, but not limited.

The search of steady/settling/nearby_orbit.py has another purpose: it decides whether a motion settles on an orbit, and
accepts only orbits within a tenth of the motion.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from ..errors import ComputationError
from ..execution.stop import Stop
from ..inputs.checks import whole_number
from ..integrate.scaling import scale_chain
from ..scene import Scene
from ..scene.refusals import require_scene
from ..scene.state import State
from ..steady.poincare import iter_section
from ..steady.regime_criteria import LONGEST_LOCKED_PERIOD
from ..steady.residuals import least_displacement
from ..steady.returns import least_period
from ..steady.settling.advance import run_until_settled
from .find_orbit import NO_PERIOD_OF_SEARCH, periodic_orbit
from .orbit import Orbit
from .stroboscopic_map import SAME_ORBIT_DISTANCE, StroboscopicMap, refuse_cut

#: Number of closest returns from which Newton's method is started.
_STARTS = 4
#: Minimum number of periods between two starts, so that each is from a different passage near an orbit: several
#: successive states of one passage return closely.
_PERIODS_BETWEEN_STARTS = 5
#: Number of periods recorded of the settled motion near which an orbit is sought.
_RECORDED_PERIODS = 400
#: Distance between an orbit and a settled motion below which the orbit counts as the motion's own.
OWN_ORBIT_DISTANCE = 1e-3
#: Number of late section states of which every n-th is averaged, n being the period.
_STATES_OF_MEAN = 120


def orbit_near_motion(scene: Scene, period: int | None = None, stop: Stop | None = None) -> Orbit:
    """Find an unstable periodic orbit of `period` drive periods (1 by default) near the settled motion from rest.

    After it has settled, the motion is recorded for 400 periods, and `search_orbit` starts from this record.
    `Orbit.distance_of_motion` is the least distance between motion and orbit. Raises the exceptions of `search_orbit`,
    and `ComputationError` where the search ends on the orbit that the motion follows.
    """
    require_scene(scene)
    n = whole_number("period", 1 if period is None else period, 1, LONGEST_LOCKED_PERIOD)
    refuse_cut(scene)
    settling = run_until_settled(scene, None, stop)
    start = settling.engine.state
    *_, section = iter_section(scene, start, _RECORDED_PERIODS, samples=1, stop=stop)
    orbit = search_orbit(scene, n, start, section.strobes(), stop)
    if settling.regime.period is not None:
        strobes = section.strobes()[: settling.regime.period].astype(float)
        refuse_own_orbit(orbit, [State(*strobe) for strobe in strobes])
    return replace(orbit, period_note=NO_PERIOD_OF_SEARCH if period is None else "")


def refuse_own_orbit(orbit: Orbit, states: Iterable[State]) -> None:
    """Raise `ComputationError` if an orbit goes through one of the `states` of a settled motion at phase 0."""
    if min(distance_of_states(orbit.state, state) for state in states) < OWN_ORBIT_DISTANCE:
        raise ComputationError(f"Newton's method ended on the orbit that the chain follows, of {orbit.period} drive "
                               f"period{'s' if orbit.period > 1 else ''}; try another period.", "same-orbit")


def distance_of_states(state: State, reference: State) -> float:
    """Largest difference between two states, relative to the largest displacement and velocity of the second."""
    return max(float(np.abs(a - b).max() / max(1e-300, np.abs(b).max()))
               for a, b in ((state.displacement, reference.displacement), (state.velocity, reference.velocity)))


def search_orbit(scene: Scene, period: int, start: State, strobes: np.ndarray,
                 stop: Stop | None = None) -> Orbit:
    """Find an orbit of `period` drive periods by Newton's method, started near a motion.

    The starts are the state `start`, the mean of the section's states and its closest returns. The distance between
    orbit and motion is reported as `Orbit.distance_of_motion`; it is not limited.

    `strobes` (P, 2, N) are states of the motion at phase 0 in SI, without the transient; P may be 0. If the orbit
    repeats after fewer than `period` periods, it is returned with its least period. Raises `BadInput` for a period
    out of range, `ComputationError` where no start leads to an orbit, and `Cancelled`.
    """
    tried = 0
    for begin in (start, *_mean(strobes, period), *_close_returns(strobes, period)):
        tried += 1
        try:
            orbit = periodic_orbit(scene, period, begin, stop=stop)
        except ComputationError as failure:
            if failure.status != "no-convergence":
                raise
            continue
        shortest = least_period_of(orbit, stop)
        if shortest != period:
            orbit = periodic_orbit(scene, shortest, orbit.state, stop=stop)
        return replace(orbit, distance_of_motion=_distance_of_motion(orbit.state, start, strobes))
    raise ComputationError(f"Newton's method found no orbit of {period} drive periods from the present state or from "
                           f"{tried - 1} places of the section; try another period.", "no-convergence")


def _distance_of_motion(state: State, start: State, strobes: np.ndarray) -> float:
    """Least distance of a state from a motion, relative to the largest displacement and velocity of the motion."""
    motion = np.concatenate([np.array([[start.displacement, start.velocity]]), strobes.astype(float)])
    size = np.maximum(1e-300, np.abs(motion).max(axis=(0, 2)))[:, None]
    distances = np.abs(motion - np.array([state.displacement, state.velocity])) / size
    return float(distances.max(axis=(1, 2)).min())


def _mean(strobes: np.ndarray, period: int) -> Iterator[State]:
    """Yield the mean of every n-th late state, n being `period`, if there are at least two."""
    late = strobes[-_STATES_OF_MEAN:][::period]
    if len(late) > 1:
        yield State(*np.asarray(late, dtype=float).mean(axis=0))


def _close_returns(strobes: np.ndarray, period: int) -> Iterator[State]:
    """Yield the states of the section that return closest after `period` periods, closest first, one per passage."""
    if len(strobes) <= period:
        return
    size = np.maximum(1e-300, np.abs(strobes).max(axis=(0, 2)))[:, None]
    distances = (np.abs(strobes[period:] - strobes[:-period]) / size).max(axis=(1, 2))
    chosen: list[int] = []
    for number in np.argsort(distances):
        if all(abs(int(number) - earlier) >= _PERIODS_BETWEEN_STARTS for earlier in chosen):
            chosen.append(int(number))
            yield State(*np.asarray(strobes[number], dtype=float))
        if len(chosen) == _STARTS:
            return


def least_period_of(orbit: Orbit, stop: Stop | None = None) -> int:
    """Compute the least period of an orbit, in drive periods."""
    scaled = scale_chain(orbit.scene)
    x = scaled.beads_of(scaled.from_si(orbit.state))

    def after(periods: int) -> np.ndarray:
        return StroboscopicMap(orbit.scene, periods, stop)(x, directions=np.zeros((len(x), 0))).end

    return least_period(after, x, orbit.period, SAME_ORBIT_DISTANCE, least_displacement(x, scaled.beta))
