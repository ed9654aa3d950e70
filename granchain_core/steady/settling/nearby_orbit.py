"""The periodic orbit near a motion, and whether the motion approaches it or departs from it.

A motion may stay near an unstable orbit for hundreds of periods, and may need thousands to reach a stable one;
meanwhile both look alike. So the orbit itself is found by Newton's method, and its multipliers predict the growth of
small perturbations. The prediction is tested: from its current distance and from smaller and smaller ones, the motion
must approach the orbit about as fast as the multipliers predict. The search for orbits that a motion does not follow,
at any distance, is in orbits/search.py.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ...errors import ComputationError
from ...execution.stop import Stop
from ...kernels.strobes.periodicity import LONGEST_PERIOD
from ...scene import Scene
from ..regime_criteria import changes, window_changes
from ..residuals import least_displacement
from ..returns import shorter_periods
from .finite_difference_map import FiniteDifferenceMap, FixedPoint, fixed_point

#: [period n] A chain alone: an unconfirmed claim needs multipliers up to this many beads. Up to this number, the
#: derivative of the map is computed.
MOST_BEADS_WITH_MULTIPLIERS = 100
#: [period n] An orbit counts as stable if |μ| is below 1 by more than this. The errors of |μ| may be larger near
#: grazings: docs/orbits.md, "Error of the map with fixed steps".
MODULUS_ERROR = 1e-5
#: [followed] Largest relative change over n periods at which an orbit of period n is sought, and largest distance from
#: the orbit that is then found.
NEAR_AN_ORBIT = 0.1
#: [quasi-periodic] In a batch, a motion whose least change over 1 to 16 periods is below this is settled alone, where
#: the orbit near it is examined. On closed curves of section 2 and of the rig, the least change was 1.8e-3 or more; on
#: slow approaches it was 2.2e-4 or less.
_ALMOST_PERIODIC = 1e-3
#: [quasi-periodic] In a batch, number of last changes that must all be below `_ALMOST_PERIODIC`. On a closed curve, a
#: motion may hardly move for some periods, and then continue.
_ALMOST_PERIODIC_CHANGES = 32
#: [followed] The period tried is the shortest over which the motion changes by at most this many times the least
#: change.
_CHANGE_FACTOR = 3.0
#: [followed] Factor from one tested distance to the next. Near an orbit that has just become stable, the motion may
#: stay on a closed curve, and distances vary by a few per cent: hence several distances, and large fractions of each.
_DISTANCE_FACTOR = 0.4
#: [followed] Smallest distance from that orbit that is tested, relative to the orbit.
_SMALLEST_DISTANCE = 1e-5
#: [followed] Fraction of a distance that must decay, as predicted by |μ|, during the orbits of the test. It sets their
#: number.
_PREDICTED_FRACTION = 0.2
#: [followed] Maximum number of orbits in the test.
_MOST_ORBITS = 3000
#: [followed] Fraction of the predicted decay that must be observed.
_OBSERVED_FRACTION = 0.3
#: [followed] Number of orbits at the beginning and at the end of the test, of which the largest distance counts. A
#: distance may oscillate as it shrinks.
_COMPARED_ORBITS = 16
#: [followed] Directions with |μ| below this, or below this fraction of the largest |μ|, are left out of the distance.
#: They have decayed within `_COMPARED_ORBITS` orbits.
_SLOW_DIRECTION = 0.3
#: [followed] A departure is enlarged along the growing directions to this fraction of the motion.
_ENLARGED_LENGTH = 3e-3
#: [period n] An orbit that returns to within this relative distance after a fraction of its period has that shorter
#: period. The fixed-step map is less accurate than that of `granchain_core/orbits/stroboscopic_map.py`.
_SAME_ORBIT_DISTANCE = 1e-6


@dataclass(frozen=True, eq=False)
class NearbyOrbit:
    """An orbit of `period` drive periods near a motion at x (2N,), scaled; `modulus` is its largest |μ|."""

    stroboscopic_map: FiniteDifferenceMap
    point: FixedPoint
    x: np.ndarray
    modulus: float

    @property
    def period(self) -> int:
        """The orbit's period in drive periods."""
        return self.stroboscopic_map.periods

    @property
    def stable(self) -> bool:
        """Whether all multipliers are inside the unit circle by more than their error."""
        return self.modulus < 1.0 - MODULUS_ERROR

    @property
    def unstable(self) -> bool:
        """Whether a multiplier is outside the unit circle by more than its error."""
        return self.modulus > 1.0 + MODULUS_ERROR

    @property
    def distance_of_motion(self) -> float:
        """Distance of the motion from the orbit, relative to the sizes of displacements and of w."""
        return self.stroboscopic_map.relative(self.x - self.point.x, self.point.x)

    @property
    def orbit_error(self) -> float:
        """Distance of this orbit from the exact fixed point of the map: its residual over 1 − |μ|."""
        return self.point.residual / max(MODULUS_ERROR, 1.0 - self.modulus)

    def approached(self) -> bool:
        """Whether the motion approaches this orbit from its current distance and from all shorter ones."""
        if not self.stable or self.distance_of_motion > NEAR_AN_ORBIT:
            return False
        rows = _slow_coordinates(self.point.derivative, max(_SLOW_DIRECTION, _SLOW_DIRECTION * self.modulus))
        orbits = min(_MOST_ORBITS, int(_PREDICTED_FRACTION / (1.0 - self.modulus)))
        left = 1.0 - _OBSERVED_FRACTION * (1.0 - self.modulus ** (orbits + _COMPARED_ORBITS))
        offset = self.x - self.point.x
        while True:
            before, after = self._largest_lengths(rows, offset, orbits)
            if not after <= left * before:
                return False
            offset = offset * _DISTANCE_FACTOR
            if self.stroboscopic_map.relative(offset, self.point.x) < _SMALLEST_DISTANCE:
                return True

    def _largest_lengths(self, rows: np.ndarray, offset: np.ndarray, orbits: int) -> tuple[float, float]:
        """Largest lengths of an offset from the orbit, now and after `orbits` orbits; (0, inf) if the map fails."""
        try:
            passed = self.stroboscopic_map.passed(self.point.x + offset, _COMPARED_ORBITS, orbits)
        except ComputationError:
            return 0.0, np.inf
        now, later = (float(_lengths(rows, states - self.point.x).max()) for states in passed)
        return now, later

    def amplified_departure(self) -> np.ndarray | None:
        """A later state of a motion that leaves this orbit: its offset along the growing directions, enlarged.

        None if the motion is already as far away.
        """
        values, right = np.linalg.eig(self.point.derivative)
        grows = np.abs(values) > 1.0
        parts = np.linalg.solve(right, (self.x - self.point.x).astype(complex))[grows]
        if not np.abs(parts).max() > 0.0:  # on the orbit itself: any direction will do
            parts = np.ones(len(parts), dtype=complex)
        leaving = np.real(right[:, grows] @ parts)
        length = self.stroboscopic_map.relative(leaving, self.point.x)
        return None if length >= _ENLARGED_LENGTH else self.point.x + leaving * (_ENLARGED_LENGTH / length)


def _slow_coordinates(matrix: np.ndarray, slowest: float) -> np.ndarray:
    """Left eigenvectors as rows: in these coordinates, every slow direction shrinks by its own μ."""
    values, vectors = np.linalg.eig(matrix.T)
    return vectors[:, np.abs(values) >= slowest].T


def _lengths(rows: np.ndarray, offsets: np.ndarray) -> np.ndarray:
    return np.asarray(np.linalg.norm(offsets @ rows.T if len(rows) else offsets, axis=1))


def orbit_of(scene: Scene, period: int, x: np.ndarray, stop: Stop) -> NearbyOrbit | None:
    """Find an orbit of `period` drive periods, or of a divisor, by Newton's method from x; None if it finds none."""
    stroboscopic_map = FiniteDifferenceMap(scene, period, stop)
    point = fixed_point(stroboscopic_map, x)
    if point is None:
        return None
    parts = {n: FiniteDifferenceMap(scene, n, stop) for n in range(1, period) if period % n == 0}
    smallest = least_displacement(point.x, stroboscopic_map.engine.scaled.beta)
    for shorter in shorter_periods(lambda n: parts[n](point.x), point.x, period, _SAME_ORBIT_DISTANCE, smallest):
        again = fixed_point(parts[shorter], point.x)
        if again is not None:
            return NearbyOrbit(parts[shorter], again, x, again.modulus)
    return NearbyOrbit(stroboscopic_map, point, x, point.modulus)


def seen_modulus(scene: Scene, period: int, x: np.ndarray, stop: Stop, refine: float) -> float:
    """Compute the largest |μ| at a settled state by one-sided differences: fast, less accurate than central ones."""
    matrix = FiniteDifferenceMap(scene, period, stop, refine).derivative(x, central=False)
    return float(np.abs(np.linalg.eigvals(matrix)).max())


def is_almost_periodic(strobes: np.ndarray) -> bool:
    """Whether an orbit may be near a motion with these last strobes (P, 2, N): it changes little over some period.

    Such a motion may approach the orbit so slowly that its Lyapunov exponent is neutral (`is_neutral`). For a record
    that is too short, the result is False.
    """
    if len(strobes) < _ALMOST_PERIODIC_CHANGES + LONGEST_PERIOD:
        return False
    largest_changes = window_changes(strobes, _ALMOST_PERIODIC_CHANGES, 1, LONGEST_PERIOD)
    return min(change for (change,) in largest_changes) < _ALMOST_PERIODIC


def _changes_over_periods(strobes: np.ndarray) -> list[float]:
    """Largest of the last n changes over n periods, for every period n that a batch can detect."""
    most = min(LONGEST_PERIOD, (len(strobes) - 1) // 2)
    return [float(changes(strobes, n, n).max()) for n in range(1, most + 1)]


def orbits_beside(scene: Scene, strobes: np.ndarray, x: np.ndarray, stop: Stop) -> Iterator[NearbyOrbit]:
    """Yield orbits near a motion with these last strobes (P, 2, N) that is now at x, one for each period tried."""
    moved = _changes_over_periods(strobes)
    if not moved or min(moved) > NEAR_AN_ORBIT:
        return
    tried = {next(n for n, change in enumerate(moved, 1) if change <= _CHANGE_FACTOR * min(moved)),
             1 + int(np.argmin(moved))}
    for n in sorted(tried):
        orbit = orbit_of(scene, n, x, stop)
        if orbit is not None and orbit.distance_of_motion <= NEAR_AN_ORBIT:
            yield orbit
