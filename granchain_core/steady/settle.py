"""Bringing a chain to its steady state, and deciding whether it is there.

The live method runs from the start until the distance bound is small (regime.py) or the regime is decided otherwise
(decide.py); a periodic orbit is then handed to the certified method, which relaxes onto its own
orbit and records it. Other motions are recorded without a claim on their error.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from ..integrate import Engine, Setting, State, live, method_for
from ..integrate.methods import jump_errors, typical_error
from ..result import Cost, Run, relative_changes, run_from
from ..scene import Scene
from ..state import rest
from ..stop import Stop
from .decide import MOST_PERIODS, REMEMBERED, Decisions
from .extrapolate import ORDER, reduced_rank, within_reach
from .orbit_errors import force_distances, orbit_force_errors
from .regime import Regime, changes, find_period

#: Most steps of the live method while settling: about half a minute.
MOST_STEPS = 100_000_000
#: Samples a period of a picture.
PICTURE_SAMPLES = 96
#: Periods shown of a motion that is not periodic.
_SHOWN = 4
#: Time after which a first picture is shown although nothing is decided yet [s].
_PREVIEW_AFTER = 0.012
#: Rounds of relaxation onto the certified orbit at most, each of as many orbits as one extrapolation uses.
_MOST_ROUNDS = 12


@dataclass(frozen=True, eq=False)
class Settled:
    """A steady state, or the motion when settling ended.

    Attributes
    ----------
    run : Run
        The recorded orbit, or a few periods where the motion is not periodic.
    regime : Regime
        What kind of motion it is.
    state : State
        Where the chain is at drive phase 0.
    start : str
        Where the motion came from: "rest" or "previous state".
    preview : bool
        Whether this is a first picture by the live method.
    final : bool
        Whether it is the last and best.

    Examples
    --------
    >>> from granchain_core import scene, settle
    >>> found = settle(scene("sec2").evolve(N=2, f=2000.0), samples=16)
    >>> found.run.time.shape, found.state.displacement.shape
    ((17,), (2,))
    """

    run: Run
    regime: Regime
    state: State
    start: str
    preview: bool
    final: bool


class Settling:
    """The live method on its way to the steady state, chunk by chunk, until the regime is decided."""

    def __init__(self, scene: Scene, start: State | None, stop: Stop | None) -> None:
        self.scene = scene
        self.engine = Engine(scene, live(), 1, stop=stop)
        self.stop = self.engine.stop
        self.engine.start(start if start is not None else rest(scene))
        self._steps = self.engine.grid
        self.tops = np.zeros((0, 3))
        self._begin(0)
        self.decisions = Decisions(self.scene, start is not None)
        self.decided = False

    def _begin(self, run: int) -> None:
        """A new record of strobes from where the engine is, after `run` periods."""
        first, scales = self.engine.state, self.engine.lowered.scales
        self.strobes = np.array([[first.displacement / scales.length, first.velocity / scales.velocity]])
        self._run, self._stop_at = run, MOST_PERIODS
        self.regime = Regime.unsettled(run)

    @property
    def _here(self) -> int:
        """Periods of the present record."""
        return len(self.strobes) - 1

    def go_on(self, seconds: float) -> None:
        """Run until the regime is decided, the budget is spent, or about `seconds` have passed."""
        end = time.perf_counter() + seconds
        while not self.decided and self.run(end - time.perf_counter()):
            self._decide()
            if time.perf_counter() > end:
                return

    def run(self, seconds: float) -> bool:
        """Run until something is to be decided, which may need other kernels, or for that time; whether it is."""
        end, per_period = time.perf_counter() + seconds, 0.0
        while not self._finished:
            left = end - time.perf_counter()
            if per_period and left < per_period:
                return False
            chunk = 2 if per_period == 0.0 else max(1, int(min(self._until_next_look(), left / per_period)))
            chunk = min(chunk, self._stop_at - self._here, max(1, self._steps_left() // self._steps))
            began = time.perf_counter()
            strobes, tops = self.engine.periods(chunk)
            per_period = (time.perf_counter() - began) / chunk
            self.tops = np.concatenate([self.tops, tops])
            self._note(strobes[1:])
        return True

    def _note(self, strobes: np.ndarray) -> None:
        """Add strobes to the record and look for a period."""
        self.strobes = np.concatenate([self.strobes, strobes])
        self.regime = replace(find_period(self.strobes[-REMEMBERED:]), periods_run=self._run + self._here)

    def _steps_left(self) -> int:
        return MOST_STEPS - self.engine.counts.steps

    def _until_next_look(self) -> float:
        """Periods until the next test of the regime: an eighth of those run, so that tests cost little."""
        return max(8.0, self._here / 8)

    @property
    def _finished(self) -> bool:
        """Whether it is time for a decision."""
        return self.regime.name == "periodic" or self._steps_left() <= 0 or self._here >= self._stop_at

    def _decide(self) -> None:
        """Take the next decision: a regime, a state further on from which the motion goes on, or just more periods.

        Where the budget of steps is spent the chain stays unsettled: more evidence would cost as much again.
        """
        if self._steps_left() <= 0 and self.regime.name != "periodic":
            self.decided = True
            return
        found = self.decisions.next(self.engine, self.strobes[-REMEMBERED:], self.regime)
        if found.state is not None:
            self.engine.start_scaled(found.state)
        if found.regime is not None:
            self.regime, self.decided = found.regime, True
        elif found.state is not None:
            self._begin(self._run + self._here)
        else:
            if found.strobes is not None:
                self._note(found.strobes)
            self._stop_at = self._here + MOST_PERIODS


def settling(scene: Scene, start: State | None = None, samples: int = PICTURE_SAMPLES,
             stop: Stop | None = None) -> Iterator[Settled]:
    """Pictures on the way to the steady state: a quick preview first, the certified one last.

    Parameters
    ----------
    scene : Scene
        The chain.
    start : State, optional
        Where the motion begins; at rest if not given.
    samples : int
        Samples a drive period of each picture.
    stop : Stop, optional
        Ends the computation when another thread sets it.

    Yields
    ------
    Settled
        About ten a second; `final` is set on the last.

    Raises
    ------
    NumbersFailed
        The motion is no longer finite.
    Cancelled
        `stop` was set.

    Examples
    --------
    >>> from granchain_core import scene, settling
    >>> [picture.final for picture in settling(scene("sec2").evolve(N=2, f=2000.0))][-1]
    True
    """
    origin = "rest" if start is None else "previous state"
    began = time.perf_counter()
    way = Settling(scene, start, stop)
    way.run(_PREVIEW_AFTER)
    while not way.decided:
        yield live_picture(way, samples, began, origin, final=False)
        way.go_on(0.1)
    if way.regime.name == "periodic":
        yield certified_picture(way, samples, began, origin)
    else:
        yield live_picture(way, samples, began, origin, final=True)


def settled(scene: Scene, start: State | None = None, samples: int = PICTURE_SAMPLES,
            stop: Stop | None = None) -> Settled:
    """The steady state that a chain reaches. Also called `settle`.

    The live method runs until the distance to the orbit is bounded or the regime is decided otherwise; a periodic orbit
    is then computed by the certified method (docs/design.md, "Settled is a bound").

    Parameters
    ----------
    scene : Scene
        The chain.
    start : State, optional
        Where the motion begins; at rest if not given.
    samples : int
        Samples a drive period of the recorded orbit.
    stop : Stop, optional
        Ends the computation when another thread sets it.

    Returns
    -------
    Settled
        One orbit where the motion is periodic, else a few periods of it.

    Raises
    ------
    NumbersFailed
        The motion is no longer finite.
    Cancelled
        `stop` was set.

    Examples
    --------
    >>> from granchain_core import scene, settle
    >>> found = settle(scene("sec2").evolve(N=2, f=2000.0))
    >>> found.regime.name, found.regime.period
    ('periodic', 1)
    >>> f"{found.run.max_output_force_elastic:.3f} N"
    '2.260 N'
    """
    began = time.perf_counter()
    way = run_until_settled(scene, start, stop)
    origin = "rest" if start is None else "previous state"
    if way.regime.name == "periodic":
        return certified_picture(way, samples, began, origin)
    return live_picture(way, samples, began, origin, final=True)


def run_until_settled(scene: Scene, start: State | None, stop: Stop | None) -> Settling:
    """Run to the end of the budget or to the steady state, without pictures."""
    way = Settling(scene, start, stop)
    way.go_on(np.inf)
    return way


def live_picture(way: Settling, samples: int, began: float, origin: str, final: bool) -> Settled:
    """The present motion by the live method, over one orbit or a few periods; the settling itself is not advanced."""
    engine = Engine(way.scene, way.engine.setting, samples, stop=way.stop)
    state = way.engine.state
    engine.start(state)
    shown = way.regime.period or _SHOWN
    record = engine.record(shown * samples)
    engine.counts.array += way.engine.counts.array
    cost = Cost.of(time.perf_counter() - began, engine.counts, engine.setting.method)
    run = run_from(engine, record, 0, way.regime, None, cost)
    return Settled(run, way.regime, state, origin, not final, final)


def certified_picture(way: Settling, samples: int, began: float, origin: str) -> Settled:
    """The periodic orbit by the certified method, with its error: integration plus distance from the orbit.

    An error e of the n-period map moves its fixed point by e/(1 − |μ|).
    """
    n = way.regime.period
    assert n is not None
    engine, distance = relax(way, way.scene.accuracy, samples)
    start = engine.state
    fine = Engine(way.scene, engine.setting.finer(), samples, stop=way.stop)
    fine.start(start)
    record = fine.record(n * samples)
    coarse = Engine(way.scene, engine.setting, samples, stop=way.stop)
    coarse.start(start)
    other = coarse.record(n * samples)
    largest = float(np.abs(record.displacement).max())
    integration = float(np.abs(record.displacement - other.displacement).max()) / largest if largest > 0 else 0.0
    fine.counts.array += way.engine.counts.array + engine.counts.array + coarse.counts.array
    cost = Cost.of(time.perf_counter() - began, fine.counts, fine.setting.method)
    regime = replace(way.regime, distance=distance)
    still = 1.0 / (1.0 - way.regime.slowness)
    integration *= still
    jumps = jump_errors(fine.setting, fine.lowered, samples, fine.jumps, fine.tops)
    left = force_distances(distance, fine.lowered, fine.tops, fine.y)
    forces = orbit_force_errors(relative_changes(fine.tops, coarse.tops), left, way.regime.slowness, jumps,
                                typical_error(fine.setting))
    run = run_from(fine, record, 0, regime, integration + distance, cost, force_errors=forces)
    return Settled(run, regime, start, origin, False, True)


def certified_setting(scene: Scene, accuracy: float, rate: float) -> Setting:
    """The first setting for an orbit to `accuracy`: one period's error e moves it by e/(1 − rate)."""
    return method_for(max(1e-13, 0.1 * min(accuracy, 1e-4) * (1.0 - rate)), scene.cuts_tension)


def relax(way: Settling, accuracy: float, samples: int = 1) -> tuple[Engine, float]:
    """The certified method on its own orbit, and the bound on the distance left.

    The orbit of the live method differs from the true one by its error; a few more periods remove it. With r the
    slowness of the regime (|μ| where it was computed, else the decay) and `change` from one n-period map to the next,
    the distance left is change·r/(1 − r). After an extrapolation it is known from the changes that follow; a jump after
    which they are not smaller is undone.
    """
    scene, n = way.scene, way.regime.period
    assert n is not None
    rate = way.regime.slowness
    setting = certified_setting(scene, accuracy, rate)
    engine = Engine(scene, setting, samples, stop=way.stop)
    engine.start(way.engine.state)
    bound, unproved = np.inf, None
    for rounds in range(_MOST_ROUNDS):
        before = bound
        states = engine.periods(0)[0]
        for _ in range(ORDER):
            moved, _ = engine.periods(n, watch=False)
            states = np.concatenate([states, moved[-1:]])
            change = float(changes(states, 1, 1)[0])
            if unproved is not None and change >= unproved[1]:
                break
            unproved, bound = None, change * rate / (1.0 - rate)
            if bound <= 0.3 * accuracy:
                return engine, bound
        if unproved is not None:  # the jump did not lead nearer: back to where it began
            engine.start(unproved[0])
            unproved, bound = None, np.inf
        elif bound > 0.3 * before and not setting.finest:
            # the changes are the method's own: it has to be finer before it can come nearer
            setting, state = setting.finer(), engine.state
            engine = Engine(scene, setting, samples, stop=way.stop)
            engine.start(state)
        elif rounds < _MOST_ROUNDS - 1:  # behind the last jump there must be a change that proves it
            here = engine.state
            unproved = (here, change) if jump(engine, states, change, rate) else None
    return engine, bound


def jump(engine: Engine, states: np.ndarray, change: float, rate: float) -> bool:
    """Put the engine where successive states (k, 2, N) lead, if that is within reach; whether it was."""
    there = reduced_rank(states)
    largest = np.abs(states).max(axis=(0, 2))[:, None]
    if not within_reach(states[-1] / largest, there / largest, change, rate):
        return False
    scales = engine.lowered.scales
    engine.start(State(there[0] * scales.length, there[1] * scales.velocity))
    return True
