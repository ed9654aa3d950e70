"""What kind of motion it is, with the evidence: periodic n, quasi-periodic, chaotic, or unsettled.

A state that hardly changes from one period to the next need not be near the attractor: with the multiplier μ of
the stroboscopic map its distance is change·|μ|/(1 − |μ|). Only that bound decides.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

#: Longest period looked for, in drive periods.
LONGEST_PERIOD = 16
#: A state is on its orbit when its distance bound, relative to the largest displacement and velocity, is below this.
SETTLED_DISTANCE = 1e-6
#: Changes below this are rounding of the fixed-step map.
_ROUNDING = 1e-12
#: A change larger than this cannot have a distance bound that small: nothing decays a thousandfold in one period.
_FAR = 1e-3
#: A change this much smaller than the distance asked for is believed without an even rate: what slow mode there
#: might be under it would have to decay a hundred times slower than anything seen.
_DEEP = 1e-2
#: A change over q periods that decays faster than this, per q periods, is going to zero and not to a longer orbit's.
_APPROACHING = 0.97
#: Periods in one of the three windows in which a slow approach must show, and how much changes shrink from one to
#: the next. A closed curve sampled a hundred times shows its extent to about a per cent.
_SLOW_WINDOW, _SHRINKS = 100, 0.98


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


def normalised(strobes: np.ndarray) -> np.ndarray:
    """Stroboscopic states (P, 2, N) as rows (P, 2N), displacements and velocities each over their largest."""
    largest = np.abs(strobes).max(axis=(0, 2), keepdims=True)
    largest[largest == 0.0] = 1.0
    return (strobes / largest).reshape(len(strobes), -1)


def _window(period: int) -> int:
    """Number of changes looked at for the rate."""
    return max(8, 3 * period)


def changes(states: np.ndarray, period: int) -> np.ndarray:
    """Largest change of the state over `period` drive periods, for every later strobe."""
    return np.abs(states[period:] - states[:-period]).max(axis=1)


def decay(change: np.ndarray, period: int) -> tuple[float, bool]:
    """Rate of decay per `period` drive periods, and whether both halves of the window show the same.

    Largest changes over one period at the window's start, middle and end are compared, so that turning complex
    multipliers do not look like decay or growth; the slower half counts.
    """
    ends = [change[:period].max(), change[(len(change) - period) // 2 :][:period].max(), change[-period:].max()]
    if min(ends) <= 0.0:
        return 0.0, True
    blocks = (len(change) - period) / (2 * period)
    first = (ends[1] / ends[0]) ** (1 / blocks)
    second = (ends[2] / ends[1]) ** (1 / blocks)
    rate = max(first, second)
    return rate, abs(first - second) < 0.2 * rate


def find_period(strobes: np.ndarray, longest: int = LONGEST_PERIOD, rounding: float = _ROUNDING) -> Regime:
    """Periodic with the smallest n whose distance bound holds, else unsettled; strobes (P + 1, 2, N).

    Changes below `rounding` are the method's own and count as none.
    """
    states, run = normalised(strobes), len(strobes) - 1
    approaching: list[int] = []
    for n in range(1, longest + 1):
        window = _window(n)
        if run < window + n:
            break
        if np.abs(states[-1] - states[-1 - n]).max() > _FAR:
            continue
        change = changes(states[-(window + n) :], n)
        rate, even = decay(change, n)
        recent = change[-n:].max()
        if change.max() <= rounding:
            return Regime("periodic", n, _earlier_rate(states, n, rounding), rounding, run)
        if rate >= 1.0:
            continue
        if any(n % q == 0 for q in approaching):
            continue  # a shorter period is still being approached: this one's small change is that approach
        if rate < _APPROACHING:
            approaching.append(n)
        distance = recent * rate / (1.0 - rate)
        if distance <= SETTLED_DISTANCE and (even or recent <= _DEEP * SETTLED_DISTANCE):
            return _shortest(states, Regime("periodic", n, float(rate), float(distance), run))
    return Regime("unsettled", None, None, None, run)


def _shortest(states: np.ndarray, found: Regime) -> Regime:
    """The same regime with the shortest period that these states do not contradict.

    The state is within `distance` of the orbit, so a change over q periods that is a few times as small is none.
    """
    n, distance = found.period, found.distance
    assert n is not None and distance is not None
    for q in range(1, n):
        if n % q == 0 and changes(states[-(n + q) :], q).max() <= 10.0 * distance:
            multiplier = found.multiplier ** (q / n) if found.multiplier else found.multiplier
            return replace(found, period=q, multiplier=multiplier)
    return found


def _earlier_rate(states: np.ndarray, n: int, rounding: float) -> float | None:
    """The decay rate from the part of the record that is still above rounding."""
    change = changes(states, n)
    above = np.flatnonzero(change > 1e3 * rounding)
    if len(above) < _window(n):
        return None
    tail = change[above[-1] + 1 - _window(n) : above[-1] + 1]
    rate, _ = decay(tail, n)
    return float(rate) if 0.0 < rate < 1.0 else None


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
    if len(strobes) < 3 * _SLOW_WINDOW + LONGEST_PERIOD:
        return False
    states = normalised(strobes[-(3 * _SLOW_WINDOW + LONGEST_PERIOD) :])
    for n in range(1, LONGEST_PERIOD + 1):
        first, second, third = changes(states, n)[-3 * _SLOW_WINDOW :].reshape(3, -1).max(axis=1)
        if second < _SHRINKS * first and third < _SHRINKS * second:
            return True
    return False


def returns_near(strobes: np.ndarray) -> bool:
    """Whether late states of the section have close neighbours among early ones, as on a closed curve.

    On a curve filled evenly by P points neighbours lie about 2π/P apart; a section that drifts or spreads does not
    come back so near. Five times that is asked for.
    """
    states = normalised(strobes)
    half = len(states) // 2
    nearest = [np.abs(states[:half] - late).max(axis=1).min() for late in states[half:]]
    return bool(np.median(nearest) < 5.0 * 2.0 * np.pi / half)
