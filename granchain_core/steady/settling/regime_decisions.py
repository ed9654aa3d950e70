"""Decisions on the regime of a motion that seems periodic, or that has not settled for a long time.

A motion that seems settled is confirmed by the multipliers of its orbit. Otherwise a nearby orbit is examined: if the
motion approaches it, the orbit is reported; if the motion departs from it, the departure is enlarged. A motion that
does neither is classified by its Lyapunov exponent (steady/exponent_measurements.py).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from ...integrate import Engine
from ...results.regime import NEWTON, Regime
from ...scene import Scene
from ..exponent_measurements import MEASURED_PERIODS, ExponentMeasurements
from ..lyapunov import growth_along
from ..regime_criteria import changes, converging, departing
from .nearby_orbit import MOST_BEADS_WITH_MULTIPLIERS, NEAR_AN_ORBIT, NearbyOrbit, orbit_of, orbits_beside, seen_modulus

#: [followed] Drive periods after which the orbit near an unsettled motion is examined.
EXAMINED_AFTER = 400
#: [unsettled] Maximum number of drive periods.
MOST_SETTLING_PERIODS = 4000
#: [quasi-periodic] Number of strobes on which the decision is based. A batch keeps a few more (`STROBES_KEPT` in
#: kernels/batch/record.py).
REMEMBERED = 420
#: [chaotic, quasi-periodic] In a batch, or for a motion that is not continued (`run`), maximum number of measurements
#: of the exponent.
MOST_MEASUREMENTS = 3
#: [chaotic, quasi-periodic] For a chain settled alone, maximum number of parts of one measurement, each of
#: `MEASURED_PERIODS`.
_MOST_PARTS = 8
#: [period n] A chain alone: up to this many beads, multipliers confirm every claim that a motion is periodic; in longer
#: chains, only unconfirmed ones.
_CONFIRMED_BEADS = 30
#: [period n] A chain alone: a claim is unconfirmed if the contraction factor per drive period is above this, or if the
#: motion started from another state than rest. A slowly unstable orbit may look the same.
CLEAR_CONTRACTION = 0.9
#: [unsettled] Factor on the maximum number of drive periods for a motion that leaves an unstable orbit. Departures are
#: slow too.
_DEPARTURE_FACTOR = 4
#: [period n] A chain alone: if |μ| at the motion's own state, by differences, is larger than this, the orbit is found
#: by Newton's method.
_CLEAR_MULTIPLIER = 0.97
#: [followed] Maximum number of departures from an orbit that are enlarged in one motion.
_MOST_DEPARTURES = 6


@dataclass(frozen=True, eq=False)
class Decision:
    """A regime, a scaled state (2N,) to continue from, the strobes of periods that were run meanwhile, or nothing."""

    regime: Regime | None = None
    state: np.ndarray | None = None
    strobes: np.ndarray | None = None


class Decisions:
    """The decisions on one motion; `carried` if it started from a given state and not from rest."""

    def __init__(self, scene: Scene, carried: bool) -> None:
        self.scene, self._carried = scene, carried
        self._departures, self._leaves = 0, False
        self._measurements = ExponentMeasurements()

    def decide(self, engine: Engine, strobes: np.ndarray, regime: Regime) -> Decision:
        """Make the next decision from the last strobes (P, 2, N) of `engine` and the regime that they show."""
        if regime.name == "periodic":
            return self._confirm_period(engine, strobes, regime)
        for orbit in _orbits_near_motion(engine, strobes):
            decision = self._decision_by_orbit(orbit, regime)
            if decision is not None:
                return decision
        leaves = self._leaves and self._measurements.approach_rate == 0.0
        if regime.periods_run >= MOST_SETTLING_PERIODS * (_DEPARTURE_FACTOR if leaves else 1):
            return Decision(regime)
        if converging(strobes) or departing(strobes):
            return Decision()
        return self._measure(engine, strobes, regime)

    def _confirm_period(self, engine: Engine, strobes: np.ndarray, regime: Regime) -> Decision:
        """The decision on a motion that seems settled: on a stable orbit, or near one that it will leave.

        A motion that alternates about an orbit while it settles is nearer to itself after two of its periods than after
        one, and may be mistaken for one of twice the period. If it almost repeats after a fraction of the period,
        Newton's method finds the orbit and its least period.

        If Newton's method finds no orbit near the motion, an unconfirmed claim is withdrawn, and a clear contraction
        from rest is accepted.
        """
        assert regime.period is not None
        unconfirmed = self._carried or not _decays_clearly(regime)
        if (MOST_BEADS_WITH_MULTIPLIERS if unconfirmed else _CONFIRMED_BEADS) < self.scene.N:
            return Decision(regime)
        modulus = seen_modulus(self.scene, regime.period, _state_of(engine), engine.stop, refine=4.0)
        if modulus <= _CLEAR_MULTIPLIER and not _may_repeat_sooner(strobes, regime.period):
            return Decision(replace(regime, multiplier=modulus))
        orbit = orbit_of(self.scene, regime.period, _state_of(engine), engine.stop)
        if orbit is None or orbit.distance_of_motion > NEAR_AN_ORBIT:
            return Decision(replace(regime, name="unsettled", period=None, distance=None) if unconfirmed else regime)
        if orbit.stable:
            return Decision(_regime_on_orbit(orbit, regime), orbit.point.x if unconfirmed else None)
        return self._decision_by_orbit(orbit, regime) or Decision(
            replace(regime, name="unsettled", period=None, distance=None, observed_contraction=None))

    def _decision_by_orbit(self, orbit: NearbyOrbit, regime: Regime) -> Decision | None:
        """The decision based on an orbit near the motion, or None if it does not decide."""
        if orbit.approached():
            return Decision(replace(regime, name="periodic", period=orbit.period, multiplier=orbit.modulus,
                                    observed_contraction=None, distance=orbit.orbit_error,
                                    orbit_found_by=NEWTON, approaches=None), orbit.point.x)
        self._leaves = self._leaves or orbit.unstable
        if not orbit.unstable or self._departures >= _MOST_DEPARTURES:
            return None
        further = orbit.amplified_departure()
        if further is None:
            return None
        self._departures += 1
        self._measurements = ExponentMeasurements()
        return Decision(state=further)

    def _measure(self, engine: Engine, strobes: np.ndarray, regime: Regime) -> Decision:
        """The regime, if the Lyapunov exponent of the next periods decides it."""
        self._measurements.interrupted()
        decided, passed = _measured(engine, strobes, regime, self._measurements)
        return Decision(decided, strobes=passed if decided is None else None)


def _may_repeat_sooner(strobes: np.ndarray, period: int) -> bool:
    """Whether the state almost repeats after a fraction of the period."""
    return any(period % n == 0 and float(changes(strobes, n, n).max()) <= NEAR_AN_ORBIT for n in range(1, period))


def _decays_clearly(regime: Regime) -> bool:
    """Whether the observed contraction leaves no doubt of a periodic regime, if the motion started from rest."""
    assert regime.period is not None
    return (regime.observed_contraction or 0.0) ** (1.0 / regime.period) <= CLEAR_CONTRACTION


def _regime_on_orbit(orbit: NearbyOrbit, regime: Regime) -> Regime:
    """The periodic regime of a motion on a stable orbit that Newton's method has found from it."""
    # the contraction over a longer period says nothing about a shorter one
    observed = regime.observed_contraction if orbit.period == regime.period else None
    return replace(regime, period=orbit.period, multiplier=orbit.modulus, observed_contraction=observed)


def _orbits_near_motion(engine: Engine, strobes: np.ndarray) -> Iterator[NearbyOrbit]:
    """Yield orbits near the motion of `engine` with these last strobes (P, 2, N); none for long chains."""
    scene = engine.scaled.scene
    if scene.N <= MOST_BEADS_WITH_MULTIPLIERS:
        yield from orbits_beside(scene, strobes, _state_of(engine), engine.stop)


def regime_without_continuing(engine: Engine, strobes: np.ndarray, regime: Regime) -> Regime:
    """Decide the regime of a motion that is not continued: one only approaching an orbit is not called periodic.

    `engine` is at the end of the strobes (P, 2, N); it is advanced if a Lyapunov exponent is measured.
    """
    scene = engine.scaled.scene
    if regime.period is not None:
        if _decays_clearly(regime) or scene.N > MOST_BEADS_WITH_MULTIPLIERS:
            return regime
        orbit = orbit_of(scene, regime.period, _state_of(engine), engine.stop)
        if orbit is None or not orbit.stable or orbit.distance_of_motion > NEAR_AN_ORBIT:
            return Regime.unsettled(regime.periods_run)
        return _regime_on_orbit(orbit, regime)
    for orbit in _orbits_near_motion(engine, strobes):
        if orbit.approached():
            return replace(regime, approaches=orbit.period, multiplier=orbit.modulus)
        if orbit.unstable and orbit.amplified_departure() is not None:
            return regime
    return _classified_by_exponent(engine, strobes, regime)


def _measured(engine: Engine, strobes: np.ndarray, regime: Regime,
              measurements: ExponentMeasurements) -> tuple[Regime | None, np.ndarray]:
    """The regime if one more measurement of the Lyapunov exponent decides it, and the measurement's strobes (P, 2, N).
    """
    passed = strobes[:0]
    for part in range(_MOST_PARTS):
        growth, more, offset = growth_along(engine, MEASURED_PERIODS, measurements.offset)
        passed = np.concatenate([passed, more])
        decided = measurements.add(growth, offset, np.concatenate([strobes, passed])[-REMEMBERED:],
                                   regime.periods_run + len(passed), last=part == _MOST_PARTS - 1)
        if not len(measurements.unfinished):
            break
    return decided, passed


def _classified_by_exponent(engine: Engine, strobes: np.ndarray, regime: Regime) -> Regime:
    """Chaotic or quasi-periodic by its Lyapunov exponent, otherwise unsettled."""
    measurements = ExponentMeasurements()
    for _ in range(MOST_MEASUREMENTS):
        decided, passed = _measured(engine, strobes, regime, measurements)
        if decided is not None:
            return decided
        strobes = np.concatenate([strobes, passed])[-REMEMBERED:]
        regime = replace(regime, periods_run=regime.periods_run + len(passed))
    assert measurements.latest is not None
    return replace(measurements.latest, name="unsettled")


def _state_of(engine: Engine) -> np.ndarray:
    """The engine's state (2N,) of displacements, then w."""
    return engine.scaled.beads_of(engine.y)
