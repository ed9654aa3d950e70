"""What a motion is that has come to look periodic, or has not for a long time: one decision after the other.

A motion that seems settled is confirmed by the multipliers of its orbit. One that is still moving is asked whether it
goes to an orbit beside it, or leaves one: the first is followed to its orbit, the second is taken to where its
departure is no longer small. Only what does neither is told apart by its Lyapunov exponent, measured twice.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..integrate import Engine
from ..scene import Scene
from .lyapunov import exponents
from .nearby_orbit import MOST_BEADS, NearbyOrbit, orbit_of, orbits_beside
from .regime import Regime, agree, clearly_chaotic, departing, irregular, look, slowing

#: Periods after which a motion that has not settled is looked at in another way, and most that are run in all.
MOST_PERIODS, SLOW_PERIODS = 400, 4000
#: Blocks and periods a block of one measurement of the Lyapunov exponent.
BLOCKS, BLOCK = 10, 20
#: Beads up to which every claim of `settled` is confirmed by multipliers; of longer chains those in doubt.
_ALWAYS = 30
#: A claim is in doubt if changes shrink by less than this a drive period: an orbit that grows slowly may look like it.
CLEAR_DECAY = 0.9
#: How often a motion that leaves an orbit is taken along its departure.
_MOST_DEPARTURES = 6


@dataclass(frozen=True, eq=False)
class Decision:
    """A regime, a scaled state (2N,) to go on from, strobes of periods that were run meanwhile, or nothing yet."""

    regime: Regime | None = None
    state: np.ndarray | None = None
    strobes: np.ndarray | None = None


class Decisions:
    """The decisions on one motion; `carried` if it began on a state that another setting left behind."""

    def __init__(self, scene: Scene, carried: bool) -> None:
        self.scene, self._carried = scene, carried
        self._departures = 0
        self._measured: Regime | None = None

    def next(self, engine: Engine, strobes: np.ndarray, regime: Regime) -> Decision:
        """What follows from the last strobes (P, 2, N) of `engine` and from the regime that they show."""
        if regime.name == "periodic":
            return self._confirmed(engine, regime)
        if self.scene.N <= MOST_BEADS:
            for orbit in orbits_beside(self.scene, strobes, _scaled(engine), engine.stop):
                found = self._beside(orbit, regime)
                if found is not None:
                    return found
        if regime.periods_run >= SLOW_PERIODS * (1 + (self._departures > 0)):
            return Decision(self._given_up(strobes, regime))
        if slowing(strobes) or departing(strobes):
            return Decision()
        return self._measure(engine, strobes, regime)

    def _confirmed(self, engine: Engine, regime: Regime) -> Decision:
        """A motion that seems settled: on an orbit that is stable, or beside one that it will leave."""
        assert regime.period is not None
        doubtful = self._carried or (regime.decay or 0.0) ** (1.0 / regime.period) > CLEAR_DECAY
        if (MOST_BEADS if doubtful else _ALWAYS) < self.scene.N:
            return Decision(regime)
        orbit = orbit_of(self.scene, regime.period, _scaled(engine), engine.stop)
        if orbit is None:
            return Decision(replace(regime, name="unsettled", period=None, distance=None) if doubtful else regime)
        if orbit.stable:
            found = replace(regime, period=orbit.period, multiplier=orbit.modulus)
            return Decision(found, orbit.point.x if doubtful else None)
        return self._beside(orbit, regime) or Decision(
            replace(regime, name="unsettled", period=None, distance=None, decay=None, approaches=orbit.period,
                    multiplier=orbit.modulus))

    def _beside(self, orbit: NearbyOrbit, regime: Regime) -> Decision | None:
        """What an orbit beside the motion decides, if anything."""
        if orbit.approached():
            return Decision(replace(regime, name="periodic", period=orbit.period, multiplier=orbit.modulus, decay=None,
                                    distance=orbit.distance, followed=True, approaches=None), orbit.point.x)
        if not orbit.unstable or self._departures >= _MOST_DEPARTURES:
            return None
        further = orbit.drawn_out()
        if further is None:
            return None
        self._departures += 1
        self._measured = None
        return Decision(state=further)

    def _given_up(self, strobes: np.ndarray, regime: Regime) -> Regime:
        _, towards = look(strobes)
        if towards is None:
            return regime
        return replace(regime, approaches=towards.period, decay=towards.rate)

    def _measure(self, engine: Engine, strobes: np.ndarray, regime: Regime) -> Decision:
        """The Lyapunov exponent of the next periods; one that is small counts if a second measurement agrees."""
        found, passed = exponents(engine, BLOCKS, BLOCK)
        record = np.concatenate([strobes, passed])
        run = regime.periods_run + len(passed)
        now, before = irregular(found, record[-len(strobes):], run), self._measured
        if clearly_chaotic(found):
            return Decision(now)
        if before is not None and agree(now, before):
            return Decision(now)
        self._measured = now
        return Decision(strobes=passed)


def _scaled(engine: Engine) -> np.ndarray:
    """The engine's state (2N,) of displacements, then w."""
    row = engine.lowered.row
    return np.concatenate([engine.y[1 : row - 1], engine.y[row + 1 : 2 * row - 1]])
