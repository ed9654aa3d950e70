"""Decisions from several measurements of one motion's Lyapunov exponent."""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core.kernels.strobes.periodicity import LONGEST_PERIOD
from granchain_core.steady.exponent_measurements import (
    EXPONENT_BLOCKS,
    MEASURED_PERIODS,
    TURNING_PERIODS,
    ExponentMeasurements,
)
from granchain_core.steady.lyapunov import block_means
from granchain_core.steady.regime_criteria import (
    _BOUNDED_GROWTH,
    _LONGEST_COMPARISON,
    CLEAR_GROWTH,
    SLOW_RECORD,
    mean_and_error,
)
from granchain_core.steady.settling.regime_decisions import _MOST_PARTS

#: A closed curve: strobes of a bead whose phase advances by the golden mean.
PHASE = 2.0 * np.pi * 0.6180339887 * np.arange(SLOW_RECORD + LONGEST_PERIOD)
CURVE = np.stack([np.cos(PHASE), np.sin(PHASE)], axis=1)[:, :, np.newaxis]


#: The offset of a neighbouring trajectory, which is stored but not used here.
OFFSET = np.zeros(6)


def growth(mean: float, scatter: float = 1e-3) -> np.ndarray:
    """Return the growth in the periods of one measurement, independent from period to period."""
    return mean + scatter * np.random.default_rng(4).standard_normal(MEASURED_PERIODS)


def swing(size: float, period: float, measurement: int = 0) -> np.ndarray:
    """Return the growth in the periods of a measurement on a closed curve, where a distance oscillates about its mean.
    """
    return size * np.sin(2.0 * np.pi * (np.arange(MEASURED_PERIODS) + measurement * MEASURED_PERIODS) / period)


def decided(*means: float) -> list[str | None]:
    """Return the name that each of several measurements decides."""
    measurements = ExponentMeasurements()
    regimes = [measurements.add(growth(mean), OFFSET, CURVE, 400 + 200 * i) for i, mean in enumerate(means)]
    return [regime.name if regime else None for regime in regimes]


@pytest.mark.parametrize(("means", "names"), [
    ((0.0, 0.0), [None, "quasi-periodic"]),
    ((0.04, 0.04), [None, "chaotic"]),
    ((0.045, 0.04, 0.04), [None, None, "chaotic"]),
    ((0.04, 0.0, 0.0), [None, None, "quasi-periodic"]),
    ((-0.02, -0.02), [None, None]),
])
def test_two_measurements_in_a_row_must_agree(means: tuple[float, ...], names: list[str | None]) -> None:
    assert decided(*means) == names


def test_a_growth_that_no_departure_sustains_decides_alone() -> None:
    assert decided(CLEAR_GROWTH + 0.01) == ["chaotic"]
    assert decided(CLEAR_GROWTH - 0.01) == [None]
    assert decided(0.0, CLEAR_GROWTH + 0.01) == [None, "chaotic"], "whatever was measured before"


def test_a_measurement_with_a_large_error_is_continued() -> None:
    """0.02 per period is e⁴ over 200 periods, which a closed curve may show, but e⁸ over 400."""
    measurements = ExponentMeasurements()
    assert measurements.add(growth(0.02), OFFSET, CURVE, 400) is None and measurements.latest is None
    assert len(measurements.unfinished) == MEASURED_PERIODS - TURNING_PERIODS and measurements.complete == 0
    assert measurements.add(growth(0.03), OFFSET, CURVE, 600) is None and measurements.complete == 1
    assert measurements.latest is not None and measurements.latest.name == "chaotic"
    exponent, _ = measurements.latest.lyapunov or (0.0, 0.0)
    assert exponent == pytest.approx(0.025, abs=1e-3), "all periods count"
    assert measurements.latest.lyapunov_periods == 2 * MEASURED_PERIODS - TURNING_PERIODS, "a neighbour turns once"
    assert len(measurements.unfinished) == 0


def test_a_swing_shorter_than_a_block_leaves_no_error() -> None:
    """For an oscillation by e^{±1.2} in 9.3 periods, plain means of ten blocks of 20 periods have an error of 0.006."""
    counted = swing(0.4, 9.3)[TURNING_PERIODS:]
    plain = counted.reshape(10, 20).mean(axis=1)
    assert plain.std(ddof=1) / np.sqrt(10) > 0.006
    mean, error = mean_and_error(block_means(counted, EXPONENT_BLOCKS))
    assert abs(mean) < 1e-3 and error < 1e-3


def test_longer_blocks_measure_a_slower_swing() -> None:
    """An oscillation in 45 periods is longer than a block of 36, but shorter than one of 76."""
    measurements = ExponentMeasurements()
    assert measurements.add(swing(0.1, 45.0), OFFSET, CURVE, 400) is None and measurements.latest is None
    regime = measurements.add(swing(0.1, 45.0, 1), OFFSET, CURVE, 600)
    assert regime is not None and regime.name == "quasi-periodic", "it is as long as two that agree"
    assert regime.lyapunov is not None and abs(regime.lyapunov[0]) <= 3.0 * regime.lyapunov[1] < 0.01


@pytest.mark.parametrize("periods", [200, 420])
def test_the_standard_error_is_that_of_the_mean(periods: int) -> None:
    """For 4000 series of independent growth, the error accounts for the correlation of overlapping blocks, to 3 %.

    The scatter of 4000 squares is 2 %.
    """
    dice = np.random.default_rng(5)
    means_and_errors = np.array([mean_and_error(block_means(dice.standard_normal(periods), EXPONENT_BLOCKS)) for _ in range(4000)])
    assert means_and_errors[:, 0].std() == pytest.approx(np.sqrt((means_and_errors[:, 1] ** 2).mean()), rel=0.03)
    assert means_and_errors[:, 0].std() == pytest.approx(1.0 / np.sqrt(periods), rel=0.08), "hardly a period is lost at the ends"


@pytest.mark.parametrize(("mean", "name", "parts"), [(0.008, "chaotic", 4), (-0.008, "unsettled", 4), (0.003, "quasi-periodic", 1)])
def test_a_neutral_mean_above_its_error_is_measured_until_it_exceeds_the_bias_of_a_torus(mean: float, name: str, parts: int) -> None:
    """Over 200 periods, 0.008 ± 0.0001 is e^1.6, and a torus may show e⁶; over 6/0.008 = 750 periods, it is more. For
    0.003, this would take 2000 periods, longer than the longest measurement.
    """
    measurements = ExponentMeasurements()
    while measurements.latest is None:
        measurements.add(growth(mean), OFFSET, CURVE, 400 + len(measurements.unfinished))
    assert (measurements.latest.name, measurements.latest.lyapunov_periods) == (name, parts * MEASURED_PERIODS - TURNING_PERIODS)


def test_a_neutral_mean_is_compared_for_as_long_as_a_chain_alone_measures() -> None:
    assert _LONGEST_COMPARISON == _MOST_PARTS * MEASURED_PERIODS


#: Largest swing of the logarithm of a distance that was observed on a torus (`_BOUNDED_GROWTH`).
SEEN_SWING = 4.0
@pytest.mark.parametrize("periods", [200, 420])
@pytest.mark.parametrize(("length", "left"), [
    (0.25, 0.0), (0.4, 0.148), (0.5, 0.0), (0.75, 0.617), (0.9, 0.807), (1.0, 0.0), (1.5, 0.863), (2.0, 1.045),
    (4.0, 0.772),
])
def test_the_bias_of_a_bounded_swing_by_its_period(periods: int, length: float, left: float) -> None:
    """`left` is the mean's bias at the worst phase relative to the swing/P of a plain mean, for a swing whose period is
    `length` blocks. The window has zeros at 1, 1/2 and 1/4 block. Swings much shorter than half a block are averaged
    out, and longer ones are not, so the limit of a neutral mean needs the whole swing over P.
    """
    block = 2 * (periods // (EXPONENT_BLOCKS + 1))
    time = np.arange(periods + 1)
    bias = 0.0
    for phase in np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False):
        logarithm = 0.5 * SEEN_SWING * np.sin(2.0 * np.pi * time / (length * block) + phase)
        bias = max(bias, abs(mean_and_error(block_means(np.diff(logarithm), EXPONENT_BLOCKS))[0]))
    assert bias * periods / SEEN_SWING == pytest.approx(left, abs=0.01)
    assert bias < _BOUNDED_GROWTH / periods


def test_the_last_measurement_is_not_continued() -> None:
    measurements = ExponentMeasurements()
    assert measurements.add(swing(1.0, 70.0), OFFSET, CURVE, 400, last=True) is None
    assert measurements.latest is not None and measurements.latest.name == "unsettled"
    assert len(measurements.unfinished) == 0


def test_neighbours_that_approach_are_on_the_way_to_an_orbit() -> None:
    measurements = ExponentMeasurements()
    assert measurements.approach_rate == 0.0
    measurements.add(growth(-0.02), OFFSET, CURVE, 400)
    assert measurements.approach_rate == pytest.approx(0.02, abs=1e-3)
    measurements.add(growth(0.04), OFFSET, CURVE, 600)
    assert measurements.approach_rate == 0.0
