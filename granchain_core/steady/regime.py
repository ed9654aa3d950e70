"""What kind of motion it is, with the evidence: periodic n, quasi-periodic, chaotic, or unsettled.

A state that hardly changes from one period to the next need not be near the attractor: if changes shrink by r per
orbit, the distance left is change·r/(1 − r). Only that bound makes a motion a candidate; its multipliers then confirm
it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ..kernels.strobes import periodicity as section
from ..kernels.strobes.periodicity import LONGEST_PERIOD, ROUNDING, SETTLED_DISTANCE

#: Mean exponents per period above which a motion may be chaotic, and within which it may be quasi-periodic, however
#: small the standard error: the error that a finite record leaves falls as 1/periods.
_CHAOTIC, _NEUTRAL = 0.01, 5e-4
#: Periods in one of the three windows in which a slow approach must show, and how much changes shrink from one to
#: the next. A closed curve sampled a hundred times shows its extent to about a per cent.
_SLOW_WINDOW, _SHRINKS = 100, 0.98
#: Largest changes of a departure that is still small, relative to the largest displacement and velocity.
_SMALL = 0.1
#: Lyapunov exponent per period that no departure from an orbit sustains over the periods in which a motion may settle.
CLEAR_GROWTH = 0.05
#: Strobes needed for the three windows.
SLOW_RECORD = 3 * _SLOW_WINDOW + LONGEST_PERIOD


@dataclass(frozen=True)
class Regime:
    """What kind of motion it is, and the evidence.

    Attributes
    ----------
    name : str
        "periodic", "quasi-periodic", "chaotic" or "unsettled".
    period : int or None
        In drive periods, where the motion is periodic.
    decay : float or None
        Factor by which changes shrank per orbit, where that was observed.
    distance : float or None
        Bound on the relative distance to the orbit.
    periods_run : int
        Drive periods that were run.
    lyapunov : tuple of float or None
        Lyapunov exponent per drive period and its standard error, where it was measured.
    multiplier : float or None
        Largest |μ| of the n-period map, where it was computed.
    followed : bool
        The motion was still on its way, and the orbit that it approaches was found by Newton's method or extrapolation.
    approaches : int or None
        Period of an orbit that an unsettled motion approaches.

    Examples
    --------
    >>> from granchain_core import scene, settle
    >>> regime = settle(scene("sec2").evolve(N=2, f=2000.0)).regime
    >>> regime.name, regime.period, regime.distance < 1e-4
    ('periodic', 1, True)
    """

    name: str
    period: int | None
    decay: float | None
    distance: float | None
    periods_run: int
    lyapunov: tuple[float, float] | None = None
    multiplier: float | None = None
    followed: bool = False
    approaches: int | None = None

    @classmethod
    def unsettled(cls, periods_run: int) -> Regime:
        """A motion of which nothing is known after `periods_run` periods."""
        return cls("unsettled", None, None, None, periods_run)

    @property
    def slowness(self) -> float:
        """Factor by which a distance shrinks per orbit: |μ|, else the observed decay, else a half."""
        if self.multiplier is not None:
            return min(1.0 - 1e-6, self.multiplier)
        return min(0.999, self.decay or 0.5)

    @property
    def evidence(self) -> str:
        """|μ| where it was computed, else the decay that was seen; empty where neither is known."""
        if self.multiplier is not None:
            return f"|μ| {modulus_words(self.multiplier)}"
        if self.decay is None:
            return ""
        shown = self.period or self.approaches or 1
        return f"decay {modulus_words(self.decay)} per {'period' if shown == 1 else f'{shown} periods'}"

    @property
    def sentence(self) -> str:
        """The regime in words for the dashboard."""
        evidence = f" ({self.evidence})" if self.evidence else ""
        if self.name == "periodic":
            how = "followed to its orbit after" if self.followed else "settled within"
            return f"period {self.period}, {how} {self.periods_run} periods{evidence}"
        if self.name == "unsettled":
            towards = f", on its way to period {self.approaches}{evidence}" if self.approaches else ""
            return f"not settled after {self.periods_run} periods{towards}"
        assert self.lyapunov is not None
        return f"{self.name}, Lyapunov exponent {self.lyapunov[0]:+.3f} ± {self.lyapunov[1]:.3f} per period"


def modulus_words(modulus: float) -> str:
    """A modulus with enough figures to distinguish it from 1 and from 0."""
    if abs(modulus - 1.0) < 0.01:
        return f"{modulus:.6f}" if abs(modulus - 1.0) < 1e-4 else f"{modulus:.4f}"
    if modulus < 0.0095:
        mantissa, exponent = f"{modulus:.0e}".split("e")
        return f"{mantissa}e{int(exponent)}"
    return f"{modulus:.2f}" if modulus >= 0.095 else f"{modulus:.3f}"


@dataclass(frozen=True)
class Approach:
    """A motion on its way to an orbit: its period, the decay per orbit and the present change over it."""

    period: int
    rate: float
    change: float


def changes(strobes: np.ndarray, period: int, count: int) -> np.ndarray:
    """The last `count` relative changes of the state over `period` drive periods; strobes (P + 1, 2, N)."""
    out = np.zeros(count)
    section.record_changes(np.ascontiguousarray(strobes), period, np.zeros(2), out)
    return out


def look(strobes: np.ndarray, longest: int = LONGEST_PERIOD, rounding: float = ROUNDING,
         slowest: float = 0.0) -> tuple[Regime, Approach | None]:
    """Periodic with the smallest n whose distance bound holds, else unsettled and the orbit approached, if any.

    Strobes (P + 1, 2, N). Changes below `rounding` are the method's own and count as none; `slowest` is a
    rate of decay per drive period that is known to be there.
    """
    seen = section.find(np.ascontiguousarray(strobes), longest, rounding, SETTLED_DISTANCE, slowest, np.zeros(2),
                        np.zeros(max(section.LEAST_WINDOW, 3 * longest)))
    return in_words(seen, len(strobes) - 1, rounding)


def in_words(seen: Sequence[float] | np.ndarray, run: int,
             rounding: float = ROUNDING) -> tuple[Regime, Approach | None]:
    """The six numbers of section.find after `run` periods as a regime and the orbit approached, if any.

    Changes that are lost in rounding may still be those of a slow approach: the distance is no better known than
    rounding·r/(1 − r) with the decay r.
    """
    period, rate, distance, approached, its_rate, its_change = seen
    if period > 0:
        if 0.0 < rate < 1.0:
            distance = max(distance, rounding * rate / (1.0 - rate))
        return Regime("periodic", int(period), None if rate < 0.0 else float(rate), float(distance), run), None
    approach = Approach(int(approached), float(its_rate), float(its_change)) if approached else None
    return Regime.unsettled(run), approach


def find_period(strobes: np.ndarray, longest: int = LONGEST_PERIOD, rounding: float = ROUNDING) -> Regime:
    """The regime that `look` sees."""
    return look(strobes, longest, rounding)[0]


def grows(mean: float, error: float) -> bool:
    """Whether neighbours part, by a mean exponent per period and its standard error."""
    return mean > max(3.0 * error, _CHAOTIC)


def is_neutral(mean: float, error: float) -> bool:
    """Whether neighbours neither part nor come together, by a mean exponent per period and its standard error."""
    return abs(mean) <= max(3.0 * error, _NEUTRAL)


def irregular(exponents: np.ndarray, strobes: np.ndarray, run: int) -> Regime:
    """Chaotic, quasi-periodic or unsettled from the Lyapunov exponents of successive blocks of periods.

    Chaotic: the mean is above three standard errors and 0.01 a period. Quasi-periodic: it is zero within three standard
    errors or 5e-4, the section comes back near itself as it does on a closed curve, and the record is long enough to
    show that it is neither shrinking nor growing. Anything else is transient, however slow.
    """
    mean = float(exponents.mean())
    error = float(exponents.std(ddof=1) / math.sqrt(len(exponents)))
    if grows(mean, error):
        name = "chaotic"
    elif is_neutral(mean, error) and stays(strobes) and returns_near(strobes):
        name = "quasi-periodic"
    else:
        name = "unsettled"
    return Regime(name, None, None, None, run, (mean, error))


def clearly_chaotic(exponents: np.ndarray) -> bool:
    """Whether one measurement is enough: both halves show a growth that no departure from an orbit sustains.

    After 400 periods a growth of 0.05 a period has multiplied a distance by 5e8.
    """
    halves = exponents[: len(exponents) // 2], exponents[len(exponents) // 2 :]
    return all(half.mean() > max(3.0 * half.std(ddof=1) / math.sqrt(len(half)), CLEAR_GROWTH) for half in halves)


def agree(one: Regime, other: Regime) -> bool:
    """Whether two Lyapunov measurements give the same regime and agree within 3 combined standard errors (or 1e-3)."""
    if one.name != other.name or one.name == "unsettled" or one.lyapunov is None or other.lyapunov is None:
        return False
    (a, error_a), (b, error_b) = one.lyapunov, other.lyapunov
    return abs(a - b) <= max(3.0 * math.hypot(error_a, error_b), 1e-3)


def _windows(strobes: np.ndarray) -> Iterator[np.ndarray]:
    """For every period the largest changes over it in three windows in a row, (3,); none for a short record."""
    for n in range(1, LONGEST_PERIOD + 1 if len(strobes) >= SLOW_RECORD else 0):
        yield changes(strobes, n, 3 * _SLOW_WINDOW).reshape(3, -1).max(axis=1)


def slowing(strobes: np.ndarray) -> bool:
    """Whether the motion is still on its way: changes over some period shrink through three windows and none grow.

    On a closed curve or a strange attractor their largest value does not change, or some grow while others shrink.
    """
    return _slowing(_windows(strobes))


def shrinking(strobes: np.ndarray) -> bool:
    """Whether changes over some period shrink through three windows: enough to give a motion more periods."""
    return any(_shrinks(a, b, c) for a, b, c in _windows(strobes))


def departing(strobes: np.ndarray) -> bool:
    """Whether the motion leaves an orbit: changes over some period grow, small still, and none shrink."""
    return _departing(_windows(strobes))


def _slowing(seen: Iterable[np.ndarray]) -> bool:
    some = False
    for a, b, c in seen:
        if b < _SHRINKS * c:
            return False
        some = some or _shrinks(a, b, c)
    return some


def _departing(seen: Iterable[np.ndarray]) -> bool:
    some = False
    for a, b, c in seen:
        if c < _SHRINKS * b:
            return False
        some = some or (_shrinks(c, b, a) and c < _SMALL)
    return some


def _shrinks(first: float, second: float, third: float) -> bool:
    return second < _SHRINKS * first and third < _SHRINKS * second


def stays(strobes: np.ndarray) -> bool:
    """Whether a record that is long enough shows a motion that neither slows down nor leaves an orbit."""
    seen = list(_windows(strobes))
    return bool(seen) and not _slowing(seen) and not _departing(seen)


def returns_near(strobes: np.ndarray) -> bool:
    """Whether late states of the section have close neighbours among early ones, as on a closed curve.

    On a curve filled evenly by P points neighbours lie about 2π/P apart; a section that drifts or spreads does not
    come back so near. The limit is five times that.
    """
    half = len(strobes) // 2
    nearest = np.zeros(len(strobes) - half)
    section.nearest_neighbours(np.ascontiguousarray(strobes), np.zeros(2), nearest)
    return bool(np.median(nearest) < 5.0 * 2.0 * np.pi / half)
