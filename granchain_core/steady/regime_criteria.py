"""The regime of a motion from its stroboscopic states and its Lyapunov exponents.

A state that hardly changes from one period to the next need not be near the attractor: if changes shrink by a factor r
per orbit, the remaining distance is change·r/(1 − r). If this bound is small enough, the motion is a candidate for a
periodic one; settling/regime_decisions.py and batch/jobs_in_batch.py confirm it.
"""

from __future__ import annotations

import math

import numpy as np

from ..integrate import MethodSetting
from ..integrate.batch import change_workspace
from ..kernels.strobes import periodicity
from ..kernels.strobes.periodicity import LONGEST_PERIOD, ROUNDING, SETTLED_DISTANCE
from ..results.regime import Regime

#: [chaotic, quasi-periodic] Number of standard errors within which a mean exponent counts as unknown (from ten blocks:
#: about 98.5 % for independent normal means).
STANDARD_ERRORS = 3.0
#: [period n] Longest period tested when a chain is settled alone, in drive periods. Orbits locked to the drive among
#: quasi-periodic motions may be that long.
LONGEST_LOCKED_PERIOD = 60
#: [chaotic, quasi-periodic] Variance of the mean of ten overlapping blocks (`block_means` in lyapunov.py), over that of
#: ten independent ones with the variance that they show. Neighbours correlate by 1/6: (1 + 0.3)/(1 − 1/30).
OVERLAP_FACTOR = 1.35
#: [chaotic, quasi-periodic] On a torus the distance between neighbours stays bounded: its logarithm varies by up to
#: this. Over P periods, this biases a mean exponent by up to this value over P. Variations of up to 4 were observed.
_BOUNDED_GROWTH = 6.0
#: [quasi-periodic] Largest mean exponent per period, and largest value of three standard errors of it. All chaos is
#: excluded except weak chaos, below this exponent.
_LARGEST_NEUTRAL_EXPONENT = 0.01
#: [quasi-periodic] The measurement of a neutral mean that differs from zero by more than its error is continued if this
#: many periods in total can distinguish it from the bias on a torus. A chain settled alone is not measured longer.
_LONGEST_COMPARISON = 1760
#: [quasi-periodic] Drive periods in each of the three windows in which a slow approach must show.
_SLOW_WINDOW = 100
#: [quasi-periodic] Changes shrink if those of a window are less than this fraction of those in the window before. A
#: closed curve sampled a hundred times shows its extent to about one per cent.
_SHRINK_FACTOR = 0.98
#: [quasi-periodic] Changes of a departure are small below this, relative to the largest displacement and velocity.
_LARGEST_DEPARTURE = 0.1
#: [chaotic] One measurement suffices if both halves are above this exponent per period, and above three standard
#: errors. No departure from an orbit sustains such growth over the periods in which a motion may settle.
CLEAR_GROWTH = 0.05
#: [chaotic, quasi-periodic] Two mean exponents per period agree if they differ by less than this, or by three combined
#: standard errors.
_EXPONENT_DIFFERENCE = 1e-3
#: [quasi-periodic] The section returns near itself if the median distance between neighbours is at most this many times
#: that on an evenly filled curve.
_RETURN_FACTOR = 5.0
#: [no threshold] Number of states of a window that are compared at once, which makes the inner loop long.
_STATES_AT_ONCE = 8
#: [quasi-periodic] Number of strobes needed for the three windows.
SLOW_RECORD = 3 * _SLOW_WINDOW + LONGEST_PERIOD


def changes(strobes: np.ndarray, period: int, count: int) -> np.ndarray:
    """The last `count` relative changes of the state over `period` drive periods; strobes (P + 1, 2, N)."""
    out = np.zeros(count)
    periodicity.record_changes(np.ascontiguousarray(strobes), period, np.zeros(2), out)
    return out


def window_changes(strobes: np.ndarray, window: int, windows: int, longest: int) -> list[list[float]]:
    """The largest relative change over 1, 2, … `longest` periods in each of the last windows, the oldest first.

    There are `windows` of them, of `window` strobes each; `strobes` (P, 2, N) has at least windows·window + longest.
    Returns lists, because a regime is decided number by number, for which an array takes longer.
    """
    largest, workspace = np.zeros((longest, windows)), np.zeros((_STATES_AT_ONCE, *strobes.shape[1:]))
    periodicity.window_changes(np.ascontiguousarray(strobes), window, np.zeros(2), workspace, largest)
    changes: list[list[float]] = largest.tolist()
    return changes


def find_period(strobes: np.ndarray, longest: int = LONGEST_LOCKED_PERIOD, rounding: float = ROUNDING) -> Regime:
    """Periodic with the smallest n whose distance bound is small enough, otherwise unsettled; strobes (P + 1, 2, N).

    Changes below `rounding` are due to the method and count as zero. A slow approach may be hidden below it, so the
    distance is not known better than rounding·r/(1 − r), where r is the observed contraction factor.
    """
    periods_run = len(strobes) - 1
    period, contraction, distance, *_ = periodicity.detect_period(
        np.ascontiguousarray(strobes), longest, rounding, SETTLED_DISTANCE, 0.0, np.zeros(2), change_workspace(longest))
    if period == 0:
        return Regime.unsettled(periods_run)
    if 0.0 < contraction < 1.0:
        distance = max(distance, rounding * contraction / (1.0 - contraction))
    return Regime(name="periodic", period=int(period), distance=float(distance), periods_run=periods_run,
                  observed_contraction=None if contraction < 0.0 else float(contraction))


def rounding_of(setting: MethodSetting) -> float:
    """Largest change of strobes that counts as zero: rounding, or with error control the tolerance of a step."""
    return max(ROUNDING, setting.tolerance)


def grows(mean: float, error: float, periods: int) -> bool:
    """Whether nearby trajectories diverge, judging by a mean exponent over `periods` drive periods and its error.

    The criterion is mean > max(`STANDARD_ERRORS` σ, `_BOUNDED_GROWTH`/periods), with the standard error σ.
    """
    return mean > max(STANDARD_ERRORS * error, _BOUNDED_GROWTH / periods)


def is_neutral(mean: float, error: float, periods: int) -> bool:
    """Whether a mean exponent is small enough for a torus: at most its bias, or three standard errors.

    |mean| ≤ min(max(s, `_BOUNDED_GROWTH`/periods), `_LARGEST_NEUTRAL_EXPONENT`) with s = `STANDARD_ERRORS` σ, which
    must be below `_LARGEST_NEUTRAL_EXPONENT` too: a large error must not make this easier. A mean over a short time may
    be neutral although it differs from zero by more than its error: `needs_more_periods` decides how long its
    measurement is continued. A mean that is neither neutral nor clearly positive or negative is undecided.
    docs/regimes.md ("Quasi-periodic") gives the reasons.
    """
    uncertain = STANDARD_ERRORS * error
    limit = min(max(uncertain, _BOUNDED_GROWTH / periods), _LARGEST_NEUTRAL_EXPONENT)
    return abs(mean) <= limit and uncertain < _LARGEST_NEUTRAL_EXPONENT


def mean_and_error(exponents: np.ndarray) -> tuple[float, float]:
    """Mean of the exponents of overlapping blocks, and its standard error."""
    values = exponents.tolist()  # ten numbers: an array would take longer
    mean = math.fsum(values) / len(values)
    variance = math.fsum((value - mean) ** 2 for value in values) / (len(values) - 1)
    return mean, math.sqrt(OVERLAP_FACTOR * variance / len(values))


def needs_more_periods(exponents: np.ndarray, periods: int) -> bool:
    """Whether a measurement must be continued, because its blocks, `periods` in total, do not suffice for a decision.

    The blocks do not suffice if the error is too large: the mean is neither clearly positive, nor clearly negative, nor
    neutral. Nor do they suffice if a neutral mean may be more than the bias on a torus and at most
    `_LONGEST_COMPARISON` periods will show it.
    """
    mean, error = mean_and_error(exponents)
    if is_neutral(mean, error, periods):
        return periods < _periods_of_comparison(mean, error) <= _LONGEST_COMPARISON
    return mean >= -STANDARD_ERRORS * error and not grows(mean, error, periods)


def _periods_of_comparison(mean: float, error: float) -> float:
    """Periods P over which the bias on a torus, `_BOUNDED_GROWTH`/P, falls to the excess of |mean| over its error."""
    certain = abs(mean) - STANDARD_ERRORS * error
    return _BOUNDED_GROWTH / certain if certain > 0.0 else math.inf


def regime_from_exponents(exponents: np.ndarray, periods: int, strobes: np.ndarray, periods_run: int) -> Regime:
    """Chaotic, quasi-periodic or unsettled, from the Lyapunov exponents of overlapping blocks, `periods` in total.

    Chaotic: the mean is above three standard errors and a least value (`grows`). Quasi-periodic: it is neutral
    (`is_neutral`), the section returns near itself (`return_limit`), and the record is long enough to show that
    changes neither shrink nor grow. Anything else is unsettled. If the mean is neutral, the regime includes the numbers
    behind the other two conditions, whether these are met or not.
    """
    mean, error = mean_and_error(exponents)
    if grows(mean, error, periods):
        return Regime(name="chaotic", period=None, observed_contraction=None, distance=None, periods_run=periods_run,
                      lyapunov=(mean, error), lyapunov_periods=periods)
    if not is_neutral(mean, error, periods):
        return Regime.unsettled(periods_run, (mean, error), periods)
    windows, distance, limit = _windows(strobes), return_distance(strobes), return_limit(strobes)
    name = "quasi-periodic" if _neither_converges_nor_departs(windows) and distance < limit else "unsettled"
    return Regime(name=name, period=None, observed_contraction=None, distance=None, periods_run=periods_run,
                  lyapunov=(mean, error), lyapunov_periods=periods, return_distance=distance, return_limit=limit,
                  window_ratios=_window_ratios(windows))


def clearly_chaotic(exponents: np.ndarray) -> bool:
    """Whether one measurement is enough: both halves show a growth that no departure from an orbit sustains.

    In 400 periods, an exponent of 0.05 per period multiplies a distance by 5e8.
    """
    halves = exponents[: len(exponents) // 2], exponents[len(exponents) // 2 :]
    return all(mean > max(STANDARD_ERRORS * error, CLEAR_GROWTH) for mean, error in map(mean_and_error, halves))


def agree(first: Regime, second: Regime) -> bool:
    """Whether two Lyapunov measurements agree: the same regime, and for a chaotic one the same mean.

    Means agree within the larger of `STANDARD_ERRORS` combined standard errors and `_EXPONENT_DIFFERENCE`. Those of a
    quasi-periodic motion are not compared: both are neutral (`is_neutral`).
    """
    if first.name != second.name or first.name == "unsettled" or first.lyapunov is None or second.lyapunov is None:
        return False
    if first.name == "quasi-periodic":
        return True
    (a, error_a), (b, error_b) = first.lyapunov, second.lyapunov
    return abs(a - b) <= max(STANDARD_ERRORS * math.hypot(error_a, error_b), _EXPONENT_DIFFERENCE)


def _windows(strobes: np.ndarray, longest: int = LONGEST_PERIOD) -> list[list[float]]:
    """Largest changes over 1, 2, … `longest` periods, each in three successive windows; empty for a short record."""
    return window_changes(strobes, _SLOW_WINDOW, 3, longest) if len(strobes) >= SLOW_RECORD else []


def converging(strobes: np.ndarray) -> bool:
    """Whether the motion converges: changes over some period shrink through three windows, and none grow.

    On a closed curve or a strange attractor, the largest changes stay the same, or some grow while others shrink.
    """
    strobes = np.ascontiguousarray(strobes)  # once for both calls
    # most irregular motions show growth over one or two periods, so the other fourteen need not be computed
    return not _some_grow(_windows(strobes, 2)) and _converging(_windows(strobes))


def departing(strobes: np.ndarray) -> bool:
    """Whether the motion departs from an orbit: changes over some period grow but are still small, and none shrink."""
    return _departing(_windows(strobes))


def _some_grow(seen: list[list[float]]) -> bool:
    return any(second < _SHRINK_FACTOR * third for _, second, third in seen)


def _converging(seen: list[list[float]]) -> bool:
    return not _some_grow(seen) and any(_shrinks(*row) for row in seen)


def _departing(seen: list[list[float]]) -> bool:
    some = False
    for a, b, c in seen:
        if c < _SHRINK_FACTOR * b:
            return False
        some = some or (_shrinks(c, b, a) and c < _LARGEST_DEPARTURE)
    return some


def _shrinks(first: float, second: float, third: float) -> bool:
    return second < _SHRINK_FACTOR * first and third < _SHRINK_FACTOR * second


def _neither_converges_nor_departs(seen: list[list[float]]) -> bool:
    """Whether a record of three windows shows neither convergence nor departure."""
    return len(seen) > 0 and not _converging(seen) and not _departing(seen)


def _window_ratios(seen: list[list[float]]) -> tuple[float, float] | None:
    """Smallest and largest ratio of a window's largest change to that of the window before, over all periods.

    None if the record is too short for three windows.
    """
    before = [change for row in seen for change in row[:-1]]
    if not before or min(before) <= 0.0:
        return None
    ratios = [now / then for then, now in zip(before, (change for row in seen for change in row[1:]), strict=True)]
    return min(ratios), max(ratios)


def return_distance(strobes: np.ndarray) -> float:
    """Median relative distance from a state of the record's second half to the nearest one of its first half."""
    nearest = np.zeros(len(strobes) - len(strobes) // 2)
    order = np.argsort(strobes[: len(strobes) // 2, 0, 0], kind="stable")
    periodicity.nearest_neighbours(np.ascontiguousarray(strobes), order, np.zeros(2), nearest)
    nearest.sort()  # np.median takes longer than the search
    return 0.5 * float(nearest[(len(nearest) - 1) // 2] + nearest[len(nearest) // 2])


def return_limit(strobes: np.ndarray) -> float:
    """The limit of `return_distance` below which the section returns near itself.

    This is a coarse test: it excludes drift and spreading, but does not prove a closed curve, and a torus with three
    frequencies may pass. On a curve filled evenly by P points, neighbours are about 2π/P apart. The limit is
    `_RETURN_FACTOR` times that, where P is the number of states in the first half.
    """
    return _RETURN_FACTOR * 2.0 * math.pi / (len(strobes) // 2)
