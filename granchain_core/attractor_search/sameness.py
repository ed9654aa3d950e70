"""Comparing results: whether two results are the same steady state.

docs/parameter-map.md ("All attractors of one setting") gives the rules and the reasons.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from ..errors import BadInput, ComputationError
from ..integrate import Engine, MethodSetting, dop853_setting, following_setting
from ..integrate.scaling import scale_chain
from ..orbits import Orbit, periodic_orbit
from ..orbits.search import least_period_of
from ..scene import Scene
from ..scene.state import State
from ..steady.steady_state import SteadyState

#: [attractors] Largest difference between states that one stated error can explain. The largest error of the three
#: forces is used for that of the states, but it is infinite where a force is zero.
_LARGEST_DIFFERENCE = 1e-3
#: [attractors] Error of an orbit found by Newton's method, times 1 − |μ|: orbits that agree within the sum of their
#: errors are the same.
_ORBIT_DIFFERENCE = 1e-7
#: [attractors] Least value that is used for 1 − |μ| of an orbit.
_LEAST_CONTRACTION = 1e-3
#: [attractors] A result is on an unstable orbit if its distance is at most this factor times its tolerance, plus
#: `_UNSTABLE_DISTANCE`. A motion that only passes such an orbit is farther away.
_UNSTABLE_FACTOR = 10.0
#: [attractors] Distance added to that limit, relative to the largest displacement or w.
_UNSTABLE_DISTANCE = 1e-6
#: [attractors] Sections are different if the distance between them exceeds that between neighbouring states of one
#: section by this factor.
_SECTION_FACTOR = 3.0
#: [attractors] Number of states in the section of a motion that is not periodic, and in the longer sections that are
#: compared if these differ. The motion first runs for as many further periods.
_STATES_OF_SECTION = (400, 1600, 6400)
#: Setting for the section of an orbit found by Newton's method.
_DOP853_SETTING = dop853_setting(1e-11)


@dataclass(eq=False)
class Candidate:
    """A result that may be the same steady state as another, with its section (P, 2, N).

    The section has the n strobes (u, w) of a periodic orbit, or a record of strobes (u, v) of any other motion; only
    sections of one kind are compared. `longer` has longer records of a motion that is not periodic, by their number of
    states.
    """

    result: SteadyState
    section: np.ndarray
    orbit: Orbit | None = None
    longer: dict[int, np.ndarray] = field(default_factory=dict)

    @property
    def tolerance(self) -> float:
        """Error of the section's states, relative to the largest displacement or w.

        It is the largest stated error of the three forces, because the states are those of all beads, and the output
        force depends on the last bead only. Without a stated error it is 0: such a result is merged only with an equal
        one. All periodic results have stated errors; others are compared by their sections.
        """
        if self.orbit is not None:
            return _ORBIT_DIFFERENCE / max(_LEAST_CONTRACTION, 1.0 - min(1.0, float(np.abs(self.orbit.multipliers[0]))))
        errors = self.result.errors
        return 0.0 if errors is None else min(_LARGEST_DIFFERENCE, float(np.max(errors)))

    def section_of(self, states: int) -> np.ndarray:
        """The section with `states` states of a motion that is not periodic; the shortest is `section`."""
        if states == _STATES_OF_SECTION[0]:
            return self.section
        if states not in self.longer:
            self.longer[states] = _section(self.result, states)
        return self.longer[states]

    @property
    def unstable(self) -> bool:
        """Whether the result is on an unstable orbit."""
        return self.orbit is not None and not self.orbit.stable


def with_section(result: SteadyState) -> Candidate:
    """Add the section of its motion to a result."""
    period = result.regime.period
    return Candidate(result, _strobes(result.scene, result.state, period, _setting(result)) if period
                 else _section(result, _STATES_OF_SECTION[0]))


def _setting(result: SteadyState) -> MethodSetting:
    """The setting with which the section of a result is computed."""
    return following_setting(result.scene.cuts_tension)


def _section(result: SteadyState, states: int) -> np.ndarray:
    """Stroboscopic states of displacement and velocity of a motion that is not periodic, scaled, (states, 2, N)."""
    engine = Engine(result.scene, _setting(result), 1)
    engine.start(result.state)
    engine.periods(states)
    return engine.periods(states)[0][1:]


def _strobes(scene: Scene, state: State, periods: int, setting: MethodSetting) -> np.ndarray:
    """The next `periods` stroboscopic states of displacement and w, scaled, (periods, 2, N)."""
    engine, scaled = Engine(scene, setting, 1), scale_chain(scene)
    engine.start(state)
    rows = [scaled.from_si(state)]
    for _ in range(periods - 1):
        engine.periods(1, watch=False)
        rows.append(scaled.from_si(engine.state))
    return np.array(rows).reshape(periods, 2, -1)[:, :, 1:-1]


def merged(results: list[Candidate]) -> list[list[Candidate]]:
    """Group results by attractor; the first result of a group represents the group.

    Each is compared with the first of every group, so the order of the results may matter: rest, up, down, random,
    then those that were continued.
    """
    groups: list[list[Candidate]] = []
    for candidate in results:
        _join(groups, [candidate])
    polished: list[list[Candidate]] = []
    for group in groups:
        _join(polished, [_polished(group[0]), *group[1:]])
    return polished


def _join(groups: list[list[Candidate]], new: list[Candidate]) -> None:
    """Add the results `new` of one attractor to its group, or make them a new group."""
    for group in groups:
        if _same(group[0], new[0]):
            group.extend(new)
            return
    groups.append(new)


def _polished(candidate: Candidate) -> Candidate:
    """The result on its converged orbit, if Newton's method ends on the orbit at which it started."""
    period = candidate.result.regime.period
    if period is None or candidate.orbit is not None:
        return candidate
    try:
        orbit = periodic_orbit(candidate.result.scene, period, candidate.result.state)
        section = _strobes(orbit.scene, orbit.state, period, _DOP853_SETTING)
        shortest = least_period_of(orbit)
        if shortest < period:  # a slow, alternating approach looked like twice the period in the batch
            orbit = periodic_orbit(candidate.result.scene, shortest, orbit.state)
    except (BadInput, ComputationError):  # a scene that cuts tension has no converged orbits
        return candidate
    # states are known less accurately than forces; a motion this near to a stable orbit has settled on it
    most = _LARGEST_DIFFERENCE if orbit.stable else _UNSTABLE_FACTOR * candidate.tolerance + _UNSTABLE_DISTANCE
    if _distance(section, candidate.section) > most:
        return candidate
    result = replace(candidate.result, regime=replace(candidate.result.regime, period=shortest))
    return Candidate(result, section[:shortest], orbit)


def _same(a: Candidate, b: Candidate) -> bool:
    """Whether two results are the same steady state."""
    if a.result.regime.period != b.result.regime.period:
        return False
    if a.result.regime.period is not None:
        return _distance(a.section, b.section) <= a.tolerance + b.tolerance
    for states in _STATES_OF_SECTION:
        first, second = a.section_of(states), b.section_of(states)
        scale = _scale(first, second)
        apart = max(_to_nearest(first, second, scale), _to_nearest(second, first, scale))
        if apart <= _SECTION_FACTOR * max(_own(first, scale), _own(second, scale)):
            return True
    return False


def _scale(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The largest displacement of two sections, and their largest w or v, (1, 2, 1)."""
    largest = np.maximum(np.abs(a).max(axis=(0, 2)), np.abs(b).max(axis=(0, 2)))
    return np.where(largest > 0.0, largest, 1.0)[None, :, None]


def _distance(a: np.ndarray, b: np.ndarray) -> float:
    """Largest relative difference between two orbits of n strobes (n, 2, N), with the best shift by whole periods."""
    scale = _scale(a, b)
    return min(float(np.abs((a - np.roll(b, shift, axis=0)) / scale).max()) for shift in range(len(a)))


def _to_nearest(a: np.ndarray, b: np.ndarray, scale: np.ndarray) -> float:
    """Median relative distance from the states of a section (P, 2, N) to the nearest of another; `scale` (1, 2, 1)."""
    return _to_neighbour(a, b, scale, 1)


def _own(section: np.ndarray, scale: np.ndarray) -> float:
    """Median relative distance from the states of a section to the nearest other one."""
    return _to_neighbour(section, section, scale, 2)  # the first is the state itself


def _to_neighbour(a: np.ndarray, b: np.ndarray, scale: np.ndarray, which: int) -> float:
    """Median relative distance from the states of a section to their `which`-th nearest of another."""
    from scipy.spatial import KDTree

    states, others = ((section / scale).reshape(len(section), -1) for section in (a, b))
    return float(np.median(KDTree(others).query(states, k=[which], p=np.inf)[0]))
