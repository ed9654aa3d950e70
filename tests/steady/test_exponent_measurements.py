"""What several measurements of one motion's Lyapunov exponent decide together."""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core.kernels.strobes.periodicity import LONGEST_PERIOD
from granchain_core.steady.exponent_measurements import EXPONENT_BLOCKS, ExponentMeasurements
from granchain_core.steady.regime_criteria import CLEAR_GROWTH, SLOW_RECORD

#: A closed curve: strobes of a bead whose phase turns by the golden mean.
PHASE = 2.0 * np.pi * 0.6180339887 * np.arange(SLOW_RECORD + LONGEST_PERIOD)
CURVE = np.stack([np.cos(PHASE), np.sin(PHASE)], axis=1)[:, :, np.newaxis]


def blocks(mean: float, scatter: float = 1e-4) -> np.ndarray:
    """Ten exponents with this mean, half of them above it and half below."""
    return mean + scatter * np.array([1.0, -1.0] * 5)


def decided(*means: float) -> list[str | None]:
    """The name that each of several measurements decides."""
    measurements = ExponentMeasurements()
    found = [measurements.add(blocks(mean), CURVE, 400 + 200 * i) for i, mean in enumerate(means)]
    return [regime.name if regime else None for regime in found]


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
    """0.02 per period is e⁴ over 200 periods, which a closed curve may show; over 400 it is e⁸."""
    measurements = ExponentMeasurements()
    assert measurements.add(blocks(0.02), CURVE, 400) is None and measurements.latest is None
    assert len(measurements.unfinished) == EXPONENT_BLOCKS and measurements.complete == 0
    assert measurements.add(blocks(0.03), CURVE, 600) is None and measurements.complete == 1
    assert measurements.latest is not None and measurements.latest.name == "chaotic"
    exponent, _ = measurements.latest.lyapunov or (0.0, 0.0)
    assert exponent == pytest.approx(0.025), "all blocks count"
    assert len(measurements.unfinished) == 0


def test_longer_blocks_measure_a_swing() -> None:
    """Exponents that swing by ±0.05 from block to block have no error over two of them, as on a closed curve."""
    measurements = ExponentMeasurements()
    assert measurements.add(blocks(0.0, 0.05), CURVE, 400) is None and measurements.latest is None
    found = measurements.add(blocks(0.0, 0.05), CURVE, 600)
    assert found is not None and found.name == "quasi-periodic", "it is as long as two that agree"
    assert found.lyapunov == (pytest.approx(0.0, abs=1e-15), pytest.approx(0.0, abs=1e-15))


def test_the_last_measurement_is_not_continued() -> None:
    measurements = ExponentMeasurements()
    assert measurements.add(blocks(0.0, 0.1), CURVE, 400, last=True) is None
    assert measurements.latest is not None and measurements.latest.name == "unsettled"
    assert len(measurements.unfinished) == 0


def test_neighbours_that_approach_are_on_the_way_to_an_orbit() -> None:
    measurements = ExponentMeasurements()
    assert measurements.approach_rate == 0.0
    measurements.add(blocks(-0.02), CURVE, 400)
    assert measurements.approach_rate == pytest.approx(0.02)
    measurements.add(blocks(0.04), CURVE, 600)
    assert measurements.approach_rate == 0.0
