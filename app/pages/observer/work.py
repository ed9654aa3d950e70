"""Chain and observer of the Observer page, computed period by period, with the rate that the multiplier predicts."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from granchain_core import BadInput, ComputationError, Scene, Settled, State
from granchain_core.execution.stop import Stop
from granchain_core.kernels.forces.peaks import next_period
from granchain_core.observers.drift import departure_words, observer_drift
from granchain_core.observers.pair import Pair
from granchain_core.observers.twin import (
    SYNCHRONISED,
    linear_window,
    multipliers_of,
    observer_start,
)
from granchain_core.orbits import Orbit, periodic_orbit
from granchain_core.scene.state import rest

from ...frames import samples_for

#: Root-mean-square displacement of the observer's beads in a nudge, over A0.
NUDGE = 1e-3
#: Most rows per drive period.
_MOST_ROWS = 192
#: Drive periods whose stroboscopic differences are kept.
_MOST_STROBES = 400


@dataclass(frozen=True)
class ObserverStep:
    """One drive period: its number, and T rows in SI of chain and observer and of their distance.

    `largest_input` is the largest input force [N] so far, including jumps between two rows.
    """

    number: int
    samples: int
    drive: np.ndarray
    chain: np.ndarray
    observer: np.ndarray
    chain_force: np.ndarray
    observer_force: np.ndarray
    chain_energy: np.ndarray
    observer_energy: np.ndarray
    distance: np.ndarray
    largest_input: float


class ObserverRun:
    """A chain with its observer, which start from the states of `previous`, the run before a knob was moved."""

    def __init__(self, scene: Scene, settled: Settled | None, stop: Stop, previous: ObserverRun | None) -> None:
        self.scene = scene
        self.orbit: Orbit | None = None
        self.drifts = False
        self.failure = ""
        self.samples = min(_MOST_ROWS, samples_for(scene))
        self.pair = Pair(scene, self.samples, stop)
        self.number, self.since = 0, 0
        self._largest_input = 0.0  # over all periods so far: an orbit of period 3 may have a single push
        if previous is not None and previous.scene.N == scene.N:
            self.number = previous.number
            self._begin(*previous.pair.states)
        else:
            start = settled.state if settled is not None else rest(scene)
            self._begin(start, observer_start(scene, start, NUDGE))

    def _begin(self, chain: State, observer: State) -> None:
        """Continue both chains from these states, and forget earlier measurements."""
        self.pair.start(State(chain.displacement, chain.velocity), State(observer.displacement, observer.velocity))
        self.since = self.number
        self.strobes: list[np.ndarray] = []
        self.in_step = False

    def nudge(self) -> None:
        """Displace the observer's beads slightly, always by the same amounts."""
        chain, observer = self.pair.states
        moved = observer_start(self.scene, chain, NUDGE)
        self._begin(chain, State(observer.displacement + moved.displacement - chain.displacement, observer.velocity))

    def from_rest(self) -> None:
        """Restart the observer at rest, without any knowledge of the chain."""
        self._begin(self.pair.states[0], rest(self.scene))

    def predict(self, settled: Settled) -> None:
        """Find the orbit of a settled picture of this chain, and the observer's multipliers on it."""
        try:
            self.orbit = periodic_orbit(self.scene, settled.regime.period, settled.state, observer=True,
                                        stop=self.pair.engine.stop)
            self.drifts = observer_drift(self.orbit) is not None
        except (ComputationError, BadInput) as problem:  # `BadInput` if tension is cut
            self.failure = str(problem)

    @property
    def leading(self) -> complex | None:
        """The observer's leading multiplier, over `orbit.period` drive periods."""
        return None if self.orbit is None else self.orbit.leading_observer_multiplier

    @property
    def predicted(self) -> float | None:
        """The factor by which the distance changes per drive period while it is small; None if unknown."""
        if self.orbit is None or self.leading is None:
            return None
        return float(abs(self.leading) ** (1.0 / self.orbit.period))

    @property
    def measured(self) -> float | None:
        """The factor by which the distance has changed per drive period since the last start.

        None until the motion has been linear for enough periods.
        """
        linear = self._linear
        if len(self.strobes) < 8 * self._every or len(linear) < self._orbits_needed:
            return None
        return max((abs(z) ** (1.0 / self._every) for z in multipliers_of(linear)), default=None)

    @property
    def _orbits_needed(self) -> float:
        """Fewest orbits to measure: the faster modes have died out after half the time constant of the leading mode."""
        if self.leading is None or abs(self.leading) in (0.0, 1.0):
            return 0.0
        return min(0.5 / abs(math.log(abs(self.leading))), 0.5 * _MOST_STROBES / self._every)

    @property
    def _every(self) -> int:
        """Drive periods after which the linear map repeats."""
        return 1 if self.orbit is None else self.orbit.period

    @property
    def _linear(self) -> np.ndarray:
        """The stroboscopic differences after the transient, one per orbit, where they are small but above rounding."""
        strobes = np.array(self.strobes).reshape(len(self.strobes), -1)[:: self._every]
        first, end = linear_window(np.sqrt((strobes**2).sum(axis=1)))
        return strobes[first:end]

    def step(self) -> ObserverStep:
        """Compute the next drive period."""
        engine, n = self.pair.engine, self.scene.N
        next_period(engine.log.peaks)
        rows = engine.record(self.samples)
        difference = self.pair.difference(rows)
        if not self.strobes:
            self.strobes.append(difference[0])
        self.strobes = [*self.strobes[1 - _MOST_STROBES :], difference[-1]]
        self.in_step = bool(np.abs(difference).max() < SYNCHRONISED)
        scales, number = engine.scaled.scales, self.number
        self.number += 1
        u, v = scales.displacements(rows.displacement), scales.velocities(rows.velocity)
        self._largest_input = max(self._largest_input, float(scales.forces(engine.maxima[0])))
        force, half_mass = scales.forces(rows.force), 0.5 * self.scene.masses()
        return ObserverStep(
            number=number, samples=self.samples,
            drive=self.scene.A0 * np.sin(2 * np.pi * np.arange(self.samples + 1) / self.samples),
            chain=u[:, :n], observer=u[:, n + 1 :], chain_force=force[:, : n + 1],
            observer_force=np.hstack([force[:, :1], force[:, n + 2 :]]), chain_energy=half_mass * v[:, :n] ** 2,
            observer_energy=half_mass * v[:, n + 1 :] ** 2, distance=np.sqrt((difference**2).sum(axis=1)),
            largest_input=self._largest_input,
        )

    @property
    def sentence(self) -> str:
        """The multiplier's prediction in one sentence."""
        mu, factor = self.leading, self.predicted
        if self.in_step:
            return "The observer agrees with its chain to rounding; nudge it and watch it converge again."
        if mu is None or factor is None:
            return self.failure or ("The multiplier's prediction appears once the picture has settled to a periodic "
                                    "motion.")
        periods = self._every
        per = "" if periods == 1 else f" per {periods} drive periods (× {factor:.4g} in each)"
        beginning = f"Observer |μ| = {abs(mu):.4g}{per}:"
        if factor < 1.0:
            tenfold = np.log(0.1) / np.log(factor)
            return (f"{beginning} it synchronises with its chain: the distance falls tenfold every {tenfold:.3g} drive "
                    "periods.")
        return f"{beginning} it {departure_words(self.drifts, mu)}."
