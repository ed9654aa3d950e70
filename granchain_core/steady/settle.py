"""Bringing a chain to its steady state, and deciding whether it is there.

The live method runs from the start until the distance bound is small (regime.py); a periodic orbit is then handed
to the certified method, which relaxes onto its own orbit and records it. What is not periodic within the budget
is told apart by its Lyapunov exponent and recorded as it is, without a claim on its error.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from ..integrate import Engine, Setting, State, method_for
from ..integrate.engine import rest
from ..result import Cost, Run, relative_changes, run_from
from ..scene import Scene
from .extrapolate import ORDER, reduced_rank, within_reach
from .lyapunov import exponents
from .regime import Regime, changes, find_period, irregular, slowing

#: Periods after which a chain that has not settled is called that.
MOST_PERIODS = 400
#: As many are allowed to a chain that clearly still approaches its orbit, which is asked every so many periods.
SLOW_PERIODS, _SLOW_CHECK = 4000, 400
#: Strobes looked at when the regime is decided.
_REMEMBERED = 420
#: Steps of the live method after which settling is given up in any case: about half a minute.
MOST_STEPS = 100_000_000
#: Samples a period of a picture.
PICTURE_SAMPLES = 96
#: Periods shown of a motion that is not periodic.
_SHOWN = 4
#: Seconds after which a first picture is shown though nothing is decided yet.
_PREVIEW_AFTER = 0.012
#: Blocks and periods a block for the Lyapunov exponent.
_BLOCKS, _BLOCK = 10, 20
#: Rounds of relaxation onto the certified orbit at most, each of as many orbits as one extrapolation uses.
_MOST_ROUNDS = 12


@dataclass(frozen=True, eq=False)
class Settled:
    """A steady state (or how far one got): the recorded run, its regime, the state at phase 0.

    `start` says where it came from: "rest" or "previous state". A preview is a first picture from the live method;
    `final` is the last and best.
    """

    run: Run
    regime: Regime
    state: State
    start: str
    preview: bool
    final: bool


class Settling:
    """The live method on its way to the steady state, chunk by chunk."""

    def __init__(self, scene: Scene, start: State | None, stop: np.ndarray | None) -> None:
        self.scene = scene
        self.engine = Engine(scene, Setting("rk4-split"), 1, stop=stop)
        self.stop = self.engine.stop
        self.engine.start(start if start is not None else rest(scene))
        self._steps = self.engine.grid
        first = self.engine.state
        scales = self.engine.lowered.scales
        self.strobes = np.array([[first.displacement / scales.length, first.velocity / scales.velocity]])
        self.tops = np.zeros((0, 3))
        self.regime = Regime("unsettled", None, None, None, 0)

    def go_on(self, seconds: float) -> None:
        """Run until the regime is found, the budget is spent, or about `seconds` have passed."""
        end, per_period = time.perf_counter() + seconds, 0.0
        while not self.finished:
            left = end - time.perf_counter()
            if per_period and left < per_period:
                return
            chunk = 2 if per_period == 0.0 else max(1, int(min(self._until_next_look(), left / per_period)))
            chunk = min(chunk, self._next_stop() - self.regime.periods_run, max(1, self._steps_left() // self._steps))
            began = time.perf_counter()
            strobes, tops = self.engine.periods(chunk)
            per_period = (time.perf_counter() - began) / chunk
            self.strobes = np.concatenate([self.strobes, strobes[1:]])
            self.tops = np.concatenate([self.tops, tops])
            self.regime = find_period(self.strobes[-_REMEMBERED:])
            self.regime = replace(self.regime, periods_run=len(self.strobes) - 1)

    def _steps_left(self) -> int:
        return MOST_STEPS - self.engine.counts.steps

    def _until_next_look(self) -> float:
        """Periods until the regime is looked for again: an eighth of those run, so that looking costs little."""
        return max(8.0, self.regime.periods_run / 8)

    def _next_stop(self) -> int:
        """Periods after which it is decided whether a slow chain may go on."""
        run = self.regime.periods_run
        return MOST_PERIODS if run < MOST_PERIODS else (run // _SLOW_CHECK + 1) * _SLOW_CHECK

    @property
    def finished(self) -> bool:
        """Whether the regime is known or running on would not help."""
        run = self.regime.periods_run
        if self.regime.name == "periodic" or run >= SLOW_PERIODS or self._steps_left() <= 0:
            return True
        return run >= MOST_PERIODS and run % _SLOW_CHECK == 0 and not slowing(self.strobes)

    def decide_irregular(self) -> None:
        """Tell chaotic from quasi-periodic from not settled; the engine goes on meanwhile.

        Where the budget of steps is spent the chain stays unsettled: a Lyapunov exponent would cost as much again.
        """
        if self._steps_left() <= 0:
            return
        found, strobes = exponents(self.engine, _BLOCKS, _BLOCK)
        self.strobes = np.concatenate([self.strobes, strobes])
        self.regime = find_period(self.strobes[-_REMEMBERED:])
        run = len(self.strobes) - 1
        if self.regime.name == "periodic":
            self.regime = replace(self.regime, periods_run=run)
        else:
            self.regime = irregular(found, self.strobes[-_REMEMBERED:], run)


def settling(scene: Scene, start: State | None = None, samples: int = PICTURE_SAMPLES,
             stop: np.ndarray | None = None) -> Iterator[Settled]:
    """Pictures on the way to the steady state: a quick preview first, the certified one last.

    Raises `NumbersFailed` and `Cancelled`.
    """
    origin = "rest" if start is None else "previous state"
    began = time.perf_counter()
    way = Settling(scene, start, stop)
    way.go_on(_PREVIEW_AFTER)
    while way.regime.name != "periodic":
        yield live_picture(way, samples, began, origin, final=False)
        if way.finished:
            way.decide_irregular()
            if way.regime.name != "periodic":
                yield live_picture(way, samples, began, origin, final=True)
                return
            break
        way.go_on(0.1)
    yield live_picture(way, samples, began, origin, final=False)
    yield certified_picture(way, samples, began, origin)


def settled(scene: Scene, start: State | None = None, samples: int = PICTURE_SAMPLES,
            stop: np.ndarray | None = None) -> Settled:
    """The steady state reached from rest or from `start`, certified where it is periodic."""
    way = settle(scene, start, stop)
    origin = "rest" if start is None else "previous state"
    began = time.perf_counter()
    if way.regime.name == "periodic":
        return certified_picture(way, samples, began, origin)
    return live_picture(way, samples, began, origin, final=True)


def settle(scene: Scene, start: State | None, stop: np.ndarray | None) -> Settling:
    """Run to the end of the budget or to the steady state, without pictures."""
    way = Settling(scene, start, stop)
    way.go_on(np.inf)
    if way.regime.name != "periodic":
        way.decide_irregular()
    return way


def live_picture(way: Settling, samples: int, began: float, origin: str, final: bool) -> Settled:
    """A picture of what the live method does now, over one orbit or a few periods; the way itself is not moved."""
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
    # an error e of the n-period map moves its fixed point by e/(1 − |μ|), and the forces with it
    still = 1.0 / (1.0 - slowness(way.regime))
    forces = relative_changes(fine.tops, coarse.tops) + 1.5 * still * integration
    integration *= still
    run = run_from(fine, record, 0, regime, integration + distance, cost, force_errors=forces + 1.5 * distance)
    return Settled(run, regime, start, origin, False, True)


def slowness(regime: Regime) -> float:
    """The decay per orbit that bounds rest on: the multiplier seen, a half where none was."""
    return min(0.999, regime.multiplier or 0.5)


def certified_setting(scene: Scene, accuracy: float, rate: float) -> Setting:
    """The first setting for an orbit to `accuracy`: one period's error e moves it by e/(1 − rate)."""
    return method_for(max(1e-13, 0.1 * min(accuracy, 1e-4) * (1.0 - rate)), scene.cuts_tension)


def relax(way: Settling, accuracy: float, samples: int = 1) -> tuple[Engine, float]:
    """The certified method on its own orbit, and the bound on what is left to go.

    The orbit of the live method differs from the true one by its error; a few more periods take that away, and the
    change from one n-period map to the next over 1 − |μ| says how much is left.
    """
    scene, n = way.scene, way.regime.period
    assert n is not None
    rate = slowness(way.regime)
    setting = certified_setting(scene, accuracy, rate)
    engine = Engine(scene, setting, samples, stop=way.stop)
    engine.start(way.engine.state)
    bound = np.inf
    for _ in range(_MOST_ROUNDS):
        before = bound
        states = engine.periods(0)[0]
        for _ in range(ORDER):
            moved, _ = engine.periods(n, watch=False)
            states = np.concatenate([states, moved[-1:]])
            change = float(changes(states, 1, 1)[0])
            bound = change * rate / (1.0 - rate)
            if bound <= 0.3 * accuracy:
                return engine, bound
        if bound > 0.3 * before and not setting.finest:
            # the changes are the method's own: it has to be finer before it can come nearer
            setting, state = setting.finer(), engine.state
            engine = Engine(scene, setting, samples, stop=way.stop)
            engine.start(state)
        else:
            jump(engine, states, change, rate)
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
