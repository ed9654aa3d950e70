"""The search for all steady states of one setting: from rest, from sweeps up and down, and from random states.

All starts are settled in batches; sameness.py merges equal results. A start that ends on an unstable orbit, where a
slow departure looks like a steady state, is displaced and continued.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from ..errors import ComputationError
from ..execution.stop import Stop
from ..inputs.checks import whole_number
from ..integrate import Engine, following_setting
from ..results.forces import ForceErrors
from ..results.regime import Regime
from ..scene import Scene
from ..scene.refusals import require_scene
from ..scene.state import State, rest
from ..steady.batch.job import Start
from ..steady.batch.starts import settle_on_all_cores
from ..steady.exponent_measurements import MEASURED_PERIODS, TURNING_PERIODS
from ..steady.regime_criteria import find_period, grows, is_neutral, rounding_of
from ..steady.settling.regime_decisions import REMEMBERED
from ..steady.steady_state import SteadyState
from .attractor import Attractor, Attractors, Origin
from .sameness import Candidate, merged, with_section

#: [attractors] Number of frequencies in a sweep before the requested one.
_SWEEP_POINTS = 8
#: [attractors] Number of drive periods at each frequency of a sweep, and from rest for the size of the box of random
#: states.
_PASS_PERIODS = 150
#: [attractors] Distance from the requested frequency at which a sweep begins, relative to that frequency.
_SWEEP_RANGE = 0.08
#: [attractors] Size of the box of random states, relative to the largest displacement and velocity of any bead at phase
#: 0 from rest. These are determined over the first `_PASS_PERIODS`.
_BOX_SIZE = 1.5
#: [attractors] Displacement from an unstable orbit, relative to the motion.
_DEPARTURE = 1e-2
#: [attractors] Number of drive periods after a displacement from an unstable orbit before the next check. They are
#: enough to leave an orbit with |μ| = 1.003.
_DEPARTURE_PERIODS = 3000
#: [attractors] Number of further drive periods in which a motion that does not repeat may still reach an orbit. On the
#: way to a locked orbit of long period, it may stay near a closed curve for thousands of periods.
_LATER_PERIODS = 6400
#: [attractors] Maximum number of times that motions are continued, for either reason.
_MOST_ROUNDS = 3
#: [attractors] Maximum number of random states.
MOST_STATES = 10_000


def attractors(scene: Scene, random_states: int = 64, seed: int = 0, stop: Stop | None = None,
               progress: Callable[[float], None] | None = None) -> Attractors:
    """Find the steady states of one setting from rest, from sweeps of f both ways and from random states.

    Random states are uniformly distributed in a box, to which the shares refer (docs/parameter-map.md, "All attractors
    of one setting").

    Parameters
    ----------
    scene : Scene
        The chain.
    random_states : int
        Number of random states, 0 to 10,000.
    seed : int
        Seed of the random states; the same seed gives the same result.
    stop : Stop, optional
        When set, the search ends with the steady states found so far, or raises `Cancelled` if there are none.
    progress : callable, optional
        Called with the completed fraction, 0 to 1.

    Returns
    -------
    Attractors
        A list of `Attractor`, each steady state once, the one to which most starts lead first.

    Raises
    ------
    BadInput
        `random_states` or `seed` is not a whole number, or is out of range.
    ComputationError
        The computation of every start failed.

    Examples
    --------
    >>> from granchain_core import attractors, scene
    >>> [(one.regime.period, one.share) for one in attractors(scene("sec2").evolve(N=2, f=2000.0), random_states=4)]
    [(1, 1.0)]
    """
    require_scene(scene)
    random_states = whole_number("random_states =", random_states, 0, MOST_STATES)
    seed = whole_number("seed =", seed, 0, 2**63 - 1)
    listed, failed = attractors_from(scene, _origins(scene, random_states, seed, stop), stop, progress)
    tried = _random_count(failed) + sum(_random_count(attractor.origins) for attractor in listed)
    for attractor in listed:
        count = _random_count(attractor.origins)
        attractor.share, attractor.share_error = share(count, tried)
        attractor.share_interval = share_interval(count, tried)
    return Attractors(scene, sorted(listed, key=lambda one: (-len(one.origins), one.max_output_force)), failed)


def _random_count(origins: list[Origin]) -> int:
    """Number of random states among these starts."""
    return sum(origin.name.startswith("random") for origin in origins)


def attractors_from(scene: Scene, origins: list[Origin], stop: Stop | None = None,
                    progress: Callable[[float], None] | None = None) -> tuple[list[Attractor], list[Origin]]:
    """Find the steady states that these starts reach, each once with its starts; also return the failed starts.

    Raises the same exceptions as `attractors`.
    """
    starts = [Start(scene, origin.state, number) for number, origin in enumerate(origins)]
    results = _settled(starts, stop, progress)
    if results and not any(not result.failure for result in results):
        raise ComputationError(results[0].failure, results[0].status)
    failed = {result.number for result in results if result.failure}
    groups = merged([with_section(result) for result in results if not result.failure])
    for _ in range(_MOST_ROUNDS):
        left = [group for group in groups if group[0].unstable or _locks(group[0], stop)]
        if not left:
            break
        again = [start for group in left for start in (_beside if group[0].unstable else _later)(group, stop)]
        kept = [member for group in groups if group not in left for member in group]
        ran = {member.result.number: member.result.regime.periods_run
               + (_DEPARTURE_PERIODS if group[0].unstable else _LATER_PERIODS) for group in left for member in group}
        results = _settled(again, stop)
        failed |= {result.number for result in results if result.failure}
        moved = [with_section(_counted(result, ran[result.number])) for result in results if not result.failure]
        groups = merged(kept + moved)
    return [_attractor(group, origins) for group in groups], [origins[number] for number in sorted(failed)]


def _counted(result: SteadyState, before: int) -> SteadyState:
    """The result, with the number of periods `before` its start added to `periods_run`."""
    return replace(result, regime=replace(result.regime, periods_run=before + result.regime.periods_run))


def _settled(starts: list[Start], stop: Stop | None,
             progress: Callable[[float], None] | None = None) -> list[SteadyState]:
    """The steady states that starts reach, in their order."""
    results: list[SteadyState] = []
    for result in settle_on_all_cores(starts, stop):
        results.append(result)
        if progress is not None:
            progress(len(results) / len(starts))
    return sorted(results, key=lambda result: result.number)


def _beside(group: list[Candidate], stop: Stop | None) -> Iterator[Start]:
    """Yield a new start near the orbit for each result on an unstable orbit."""
    orbit = group[0].orbit
    assert orbit is not None
    u, v = orbit.state.displacement, orbit.state.velocity
    for member in group:
        shape = np.random.default_rng(member.result.number).standard_normal((2, len(u)))
        near = State(u + _DEPARTURE * np.abs(u).max() * shape[0], v + _DEPARTURE * np.abs(v).max() * shape[1])
        yield Start(orbit.scene, _run_on(orbit.scene, near, _DEPARTURE_PERIODS, stop)[0], member.result.number)


def _later(group: list[Candidate], stop: Stop | None) -> Iterator[Start]:
    """Yield a new start for each result of a group: the motion's state after `_LATER_PERIODS`."""
    for member in group:
        result = member.result
        yield Start(result.scene, _run_on(result.scene, result.state, _LATER_PERIODS, stop)[0], result.number)


def _locks(candidate: Candidate, stop: Stop | None) -> bool:
    """Whether a motion that does not repeat still reaches an orbit, within `_LATER_PERIODS`."""
    if candidate.result.regime.period is not None:
        return False
    _, strobes, _ = _run_on(candidate.result.scene, candidate.result.state, _LATER_PERIODS, stop)
    rounding = rounding_of(following_setting(candidate.result.scene.cuts_tension))
    return find_period(strobes[-REMEMBERED:], rounding=rounding).period is not None


def share(count: int, of: int) -> tuple[float | None, float | None]:
    """A fraction and its standard error by the plus-four rule (Agresti & Coull 1998), positive even at 0 and 1.

    Both are None if nothing was drawn.
    """
    if of == 0:
        return None, None
    middle = (count + 2.0) / (of + 4.0)
    return count / of, math.sqrt(middle * (1.0 - middle) / (of + 4.0))


def share_interval(count: int, of: int) -> tuple[float, float] | None:
    """The 95 % interval of a fraction (Wilson 1927), within 0 and 1; None if nothing was drawn."""
    from scipy.stats import binomtest  # imported late: only a search with random states needs it

    if of == 0:
        return None
    interval = binomtest(count, of).proportion_ci(0.95, method="wilson")
    return float(interval.low), float(interval.high)


def _origins(scene: Scene, random_states: int, seed: int, stop: Stop | None) -> list[Origin]:
    """Rest, the ends of both sweeps, and random states."""
    _, strobes, velocity = _run_on(scene, rest(scene), _PASS_PERIODS, stop)
    dice = np.random.default_rng(seed)
    size = _BOX_SIZE * np.abs(strobes).max(axis=(0, 2)) * (scene.A0, velocity)
    size = np.maximum(size, (scene.A0, 2.0 * math.pi * scene.f * scene.A0))
    origins = [Origin("rest", rest(scene)), Origin("up", _swept(scene, 1.0 - _SWEEP_RANGE, stop)),
               Origin("down", _swept(scene, 1.0 + _SWEEP_RANGE, stop))]
    for number in range(random_states):
        u, v = size[:, None] * dice.uniform(-1.0, 1.0, (2, scene.N))
        origins.append(Origin(f"random {number}", State(u, v)))
    return origins


def _swept(scene: Scene, factor: float, stop: Stop | None) -> State:
    """The state at the end of a sweep that begins at `factor` times the frequency."""
    state = rest(scene)
    for step in range(_SWEEP_POINTS):
        if stop:
            break
        f = scene.f * (factor + (1.0 - factor) * step / _SWEEP_POINTS)
        state, _, _ = _run_on(scene.evolve(f=f), state, _PASS_PERIODS, stop)
    return state


def _run_on(scene: Scene, state: State, periods: int, stop: Stop | None) -> tuple[State, np.ndarray, float]:
    """The state after `periods` drive periods, the scaled strobes on the way, and the unit of velocity [m/s]."""
    engine = Engine(scene, following_setting(scene.cuts_tension), 1, stop=stop)
    engine.start(state)
    strobes, _ = engine.periods(periods)
    return engine.state, strobes, engine.scaled.scales.velocity


def or_infinite(error: float | None) -> float:
    """A stated error, or infinity if no error is stated, so that it is never the least."""
    return math.inf if error is None else error


def _attractor(group: list[Candidate], origins: list[Origin]) -> Attractor:
    """The attractor of a group: forces with the least error, or for irregular motions the largest of any member."""
    best = min((member.result for member in group), key=lambda result: or_infinite(result.output_force_error))
    first, maxima = group[0], best.maxima
    if first.result.regime.period is None:
        maxima = np.max([member.result.maxima for member in group], axis=0)
    regime = _regime([member.result.regime for member in group])
    state = first.result.state if first.orbit is None else first.orbit.state
    return Attractor(best.scene, regime=regime, max_input_force=float(maxima[0]), max_output_force=float(maxima[1]),
                     max_output_force_elastic=float(maxima[2]), force_errors=ForceErrors.of(best.errors), state=state,
                     orbit=first.orbit, origins=[origins[member.result.number] for member in group])


def _regime(regimes: list[Regime]) -> Regime:
    """The regime of a group; for irregular motions, with the mean of their Lyapunov exponents and its standard error.

    If the members have different regimes, the rule of steady/regime_criteria.py decides by this mean. All members share
    the bias of order 1/P of an exponent measured over P periods. Averaging does not reduce the bias, so the mean is
    judged as if it had been measured over the shortest P, and its neutrality by the error of a single measurement.
    """
    known = [regime.lyapunov for regime in regimes if regime.lyapunov is not None]
    periods = min((regime.lyapunov_periods for regime in regimes if regime.lyapunov_periods is not None),
                  default=MEASURED_PERIODS - TURNING_PERIODS)
    if regimes[0].period is not None or not known:
        return regimes[0]
    mean, error = sum(value for value, _ in known) / len(known), math.sqrt(sum(e**2 for _, e in known)) / len(known)
    names = {regime.name for regime in regimes}
    if len(names) == 1:
        name = regimes[0].name
    elif grows(mean, error, periods):
        name = "chaotic"
    else:
        neutral = is_neutral(mean, error * math.sqrt(len(known)), periods)
        name = "quasi-periodic" if neutral and "quasi-periodic" in names else "unsettled"
    return replace(regimes[0], name=name, lyapunov=(mean, error), lyapunov_periods=periods)
