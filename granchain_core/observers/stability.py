"""Stability of an observer over a knob: its largest multiplier, and where its modulus crosses 1.

The orbit is continued from value to value, each Newton iteration starting from the previous orbit. Where that fails,
the steady state from rest is tried. A crossing is narrowed down by bisection, again on orbits and not on an
interpolated curve. If an orbit could not be reached from the previous one, a change of stability is a jump to another
branch and has no threshold.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..errors import BadInput, ComputationError
from ..execution.stop import Stop
from ..orbits import CONTINUOUS, Orbit, periodic_orbit
from ..scene import Scene

#: A crossing is located to this fraction of the distance between the two neighbouring values.
LOCATED = 1e-3
#: Maximum number of values in one scan.
MOST_VALUES = 2000


@dataclass(frozen=True)
class ObserverPoint:
    """One value of the knob: the leading multipliers of observer and chain; NaN if no orbit was found."""

    value: float
    observer: complex
    chain: complex
    period: int | None
    failure: str

    @property
    def observer_largest(self) -> float:
        """Modulus of the observer's leading multiplier."""
        return abs(self.observer)


@dataclass(frozen=True)
class StabilityChange:
    """A change of the observer's stability between `low` and `high`; with `gains`, it becomes stable at larger values.

    Among the `jumps` of an `ObserverStability`, the orbits at the two values are on different branches, and nothing
    crosses.
    """

    low: float
    high: float
    gains: bool


@dataclass(frozen=True)
class ObserverStability:
    """Points in the order of the values, and every crossing of |μ| = 1 between neighbours on one branch.

    `jumps` are neighbours that differ in stability but are not on one branch, as far as Newton's method shows.
    """

    scene: Scene
    knob: str
    points: tuple[ObserverPoint, ...]
    thresholds: tuple[StabilityChange, ...]
    jumps: tuple[StabilityChange, ...] = ()

    def column(self, name: str) -> np.ndarray:
        """One attribute of all points as an array."""
        return np.array([getattr(p, name) for p in self.points])


def observer_stability(scene: Scene, knob: str, values: Sequence[float], period: int | None = None,
                       stop: Stop | None = None) -> ObserverStability:
    """Compute the observer's largest multiplier at each of the `values` of `knob`, one of `CONTINUOUS`.

    `period` is that of the orbit in drive periods; by default, that of the steady state at the first value. Raises
    `BadInput`.
    """
    if knob not in CONTINUOUS:
        raise BadInput(f"Observer stability cannot be computed over {knob!r}; possible: {', '.join(CONTINUOUS)}.")
    if not 1 <= len(values) <= MOST_VALUES:
        raise BadInput(f"{len(values)} values are outside 1 to {MOST_VALUES}; the nearest valid number is "
                       f"{min(max(len(values), 1), MOST_VALUES)}.")
    scenes = [scene.evolve(**{knob: float(value)}) for value in values]
    orbit: Orbit | None = None
    orbits: list[Orbit | None] = []
    continued: list[bool] = []
    points = []
    for value, chain in zip(values, scenes, strict=True):
        before = orbit
        orbit = _continued(chain, before, stop)
        continued.append(orbit is not None)
        failure = ""
        if orbit is None:  # the previous orbit has ended or is too far away, or there was none
            orbit, failure = _from_rest(chain, period, stop)
        orbits.append(orbit)
        points.append(_point(float(value), orbit, failure))
    thresholds, jumps = [], []
    for (a, left), (b, right), on_branch in zip(zip(points, orbits, strict=True),
                                                zip(points[1:], orbits[1:], strict=True), continued[1:], strict=False):
        if left is None or right is None or (a.observer_largest < 1.0) == (b.observer_largest < 1.0):
            continue
        if on_branch:
            thresholds.append(_locate(scene, knob, a, b, left, stop))
        else:
            jumps.append(_between(a, b, a.value, b.value))
    return ObserverStability(scene, knob, tuple(points), tuple(thresholds), tuple(jumps))


def _continued(scene: Scene, before: Orbit | None, stop: Stop | None) -> Orbit | None:
    """The orbit that Newton's method reaches from the previous one; None if it reaches none."""
    if before is None:
        return None
    try:
        return periodic_orbit(scene, before.period, before.state, observer=True, stop=stop)
    except ComputationError:
        return None


def _from_rest(scene: Scene, period: int | None, stop: Stop | None) -> tuple[Orbit | None, str]:
    """The orbit reached from rest and "", or None and the reason."""
    try:
        return periodic_orbit(scene, period, observer=True, stop=stop), ""
    except ComputationError as problem:
        return None, problem.sentence


def _point(value: float, orbit: Orbit | None, failure: str) -> ObserverPoint:
    if orbit is None or orbit.observer_multipliers is None:
        return ObserverPoint(value, observer=complex(math.nan), chain=complex(math.nan), period=None, failure=failure)
    return ObserverPoint(value, observer=complex(orbit.observer_multipliers[0]), chain=complex(orbit.multipliers[0]),
                         period=orbit.period, failure="")


def _locate(scene: Scene, knob: str, a: ObserverPoint, b: ObserverPoint, orbit: Orbit,
            stop: Stop | None) -> StabilityChange:
    """Locate a crossing by bisection, continuing the orbit to every midpoint."""
    low, high, stable_at_low = a.value, b.value, a.observer_largest < 1.0
    while abs(high - low) > LOCATED * abs(b.value - a.value):
        middle = 0.5 * (low + high)
        now = _continued(scene.evolve(**{knob: middle}), orbit, stop)
        if now is None:
            break
        if bool(now.observer_stable) == stable_at_low:
            low, orbit = middle, now
        else:
            high = middle
    return _between(a, b, low, high)


def _between(a: ObserverPoint, b: ObserverPoint, low: float, high: float) -> StabilityChange:
    """The change of stability between two neighbours, known to lie between the values `low` and `high`."""
    return StabilityChange(min(low, high), max(low, high), (a.observer_largest < 1.0) != (b.value > a.value))
