"""What kind of motion it is, with the evidence: periodic n, quasi-periodic, chaotic, or unsettled.

A state that hardly changes from one period to the next need not be near the attractor: with the multiplier μ of
the stroboscopic map its distance is change·|μ|/(1 − |μ|). Only that bound decides.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..kernels import section
from ..kernels.section import LONGEST_PERIOD, ROUNDING, SETTLED_DISTANCE

#: Periods in one of the three windows in which a slow approach must show, and how much changes shrink from one to
#: the next. A closed curve sampled a hundred times shows its extent to about a per cent.
_SLOW_WINDOW, _SHRINKS = 100, 0.98
#: Strobes that it takes to see that.
SLOW_RECORD = 3 * _SLOW_WINDOW + LONGEST_PERIOD


@dataclass(frozen=True)
class Regime:
    """What the motion is and how one knows.

    `multiplier` is the modulus of the leading multiplier of the n-period map as seen in the decay, `distance` the
    bound on the relative distance to the orbit, `lyapunov` (exponent per period, its standard error) where it was
    measured.
    """

    name: str
    period: int | None
    multiplier: float | None
    distance: float | None
    periods_run: int
    lyapunov: tuple[float, float] | None = None

    @property
    def sentence(self) -> str:
        """The regime in words for the dashboard."""
        if self.name == "periodic":
            mu = f" (|μ| {self.multiplier:.2f})" if self.multiplier is not None else ""
            return f"period {self.period}, settled after {self.periods_run} periods{mu}"
        if self.name == "unsettled":
            return f"not settled after {self.periods_run} periods"
        assert self.lyapunov is not None
        return f"{self.name}, Lyapunov exponent {self.lyapunov[0]:+.3f} ± {self.lyapunov[1]:.3f} per period"


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
    """Periodic with the smallest n whose distance bound holds, else unsettled and what is approached, if anything.

    Strobes (P + 1, 2, N). Changes below `rounding` are the method's own and count as none; `slowest` is a
    rate of decay per drive period that is known to be there.
    """
    seen = section.find(np.ascontiguousarray(strobes), longest, rounding, SETTLED_DISTANCE, slowest, np.zeros(2),
                        np.zeros(max(section.LEAST_WINDOW, 3 * longest)))
    return in_words(seen, len(strobes) - 1, rounding)


def in_words(seen: Sequence[float] | np.ndarray, run: int,
             rounding: float = ROUNDING) -> tuple[Regime, Approach | None]:
    """The six numbers of section.find after `run` periods as a regime and what is approached.

    Changes that are lost in rounding may still be those of a slow approach: the distance is no better known than
    rounding·|μ|/(1 − |μ|).
    """
    period, rate, distance, approached, its_rate, its_change = seen
    if period > 0:
        if 0.0 < rate < 1.0:
            distance = max(distance, rounding * rate / (1.0 - rate))
        return Regime("periodic", int(period), None if rate < 0.0 else float(rate), float(distance), run), None
    approach = Approach(int(approached), float(its_rate), float(its_change)) if approached else None
    return Regime("unsettled", None, None, None, run), approach


def find_period(strobes: np.ndarray, longest: int = LONGEST_PERIOD, rounding: float = ROUNDING) -> Regime:
    """The regime that `look` sees."""
    return look(strobes, longest, rounding)[0]


def irregular(exponents: np.ndarray, strobes: np.ndarray, run: int) -> Regime:
    """Chaotic, quasi-periodic or unsettled from the Lyapunov exponents of successive blocks of periods.

    Chaotic: the mean is above three standard errors and 0.01 a period. Quasi-periodic: it is zero within three standard
    errors, the section comes back near itself as it does on a closed curve, and it is not shrinking. Anything else is
    on its way: neighbours come closer, however slowly.
    """
    mean = float(exponents.mean())
    error = float(exponents.std(ddof=1) / math.sqrt(len(exponents)))
    if mean > max(3.0 * error, 0.01):
        name = "chaotic"
    elif abs(mean) <= max(3.0 * error, 5e-4) and not slowing(strobes) and returns_near(strobes):
        name = "quasi-periodic"
    else:
        name = "unsettled"
    return Regime(name, None, None, None, run, (mean, error))


def slowing(strobes: np.ndarray) -> bool:
    """Whether the motion is still on its way: changes over some period shrink through three windows in a row.

    On a closed curve or a strange attractor their largest value stays what it is.
    """
    if len(strobes) < SLOW_RECORD:
        return False
    for n in range(1, LONGEST_PERIOD + 1):
        first, second, third = changes(strobes, n, 3 * _SLOW_WINDOW).reshape(3, -1).max(axis=1)
        if second < _SHRINKS * first and third < _SHRINKS * second:
            return True
    return False


def returns_near(strobes: np.ndarray) -> bool:
    """Whether late states of the section have close neighbours among early ones, as on a closed curve.

    On a curve filled evenly by P points neighbours lie about 2π/P apart; a section that drifts or spreads does not
    come back so near. Five times that is asked for.
    """
    half = len(strobes) // 2
    nearest = np.zeros(len(strobes) - half)
    section.nearest_neighbours(np.ascontiguousarray(strobes), np.zeros(2), nearest)
    return bool(np.median(nearest) < 5.0 * 2.0 * np.pi / half)
