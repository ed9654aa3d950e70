"""Rotation numbers of section 2's chain, compared with the lines of its force."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from granchain_core import (
    BadInput,
    Cancelled,
    RotationNumber,
    Scene,
    State,
    rotation_number,
    run,
    scene,
    settle,
    spectrum,
)
from granchain_core.analysis.rotation_number import _strobes, with_error
from granchain_core.analysis.winding import winding_of
from granchain_core.execution.stop import Stop
from granchain_core.integrate import Engine, fixed_step_setting

CURVE, THREE = scene("sec2").evolve(f=1700.0), scene("sec2").evolve(f=1078.0)


@pytest.fixture(scope="module")
def curve() -> RotationNumber:
    return rotation_number(CURVE)


@pytest.fixture(scope="module")
def three() -> RotationNumber:
    return rotation_number(THREE)


def peaks_of_the_force(chain: Scene, least: float) -> tuple[np.ndarray, float]:
    """Return frequencies [Hz] of the output force's peaks above this fraction of the largest, and the resolution."""
    found = spectrum(run(chain, 0, 600, 64, start=settle(chain).state))
    size = found.amplitude
    inner = (size[1:-1] > size[:-2]) & (size[1:-1] >= size[2:]) & (size[1:-1] > least * size[1:].max())
    return found.frequency[1:-1][inner], found.resolution


@pytest.mark.parametrize(("name", "orders", "least"), [("curve", 4, 1e-2), ("three", 3, 2e-3)])
def test_the_lines_of_a_force_are_combinations(name: str, orders: int, least: float, request: pytest.FixtureRequest) -> None:
    """Every strong line of the output force is at |i f/n + j f₂| with whole i and j, within the spectrum's resolution.

    n is the number of curves. `by_chance` is the probability that a line is so near to one of them by chance.
    """
    found = request.getfixturevalue(name)
    assert found.value is not None and found.curves == (1 if name == "curve" else 3)
    lines, resolution = peaks_of_the_force(found.scene, least)
    each = found.scene.f / found.curves
    n = np.arange(-orders, orders + 1)
    apart = np.abs((lines[:, None] - n * found.second_frequency + each / 2) % each - each / 2).min(axis=1)
    by_chance = len(n) * resolution / each
    assert len(lines) > 8 and by_chance < 0.08
    assert apart.max() < 0.5 * resolution
    assert (np.abs(lines % each - each / 2) < each / 2 - resolution).sum() > 3  # not only harmonics


def test_the_error_of_a_rotation_number_holds_for_finer_steps() -> None:
    """With the default steps, their error is a hundred times that of the average; six times as many steps show it."""
    chain = scene("sec2").evolve(f=1230.0)
    found = rotation_number(chain)
    engine = Engine(chain, fixed_step_setting(6), 1)
    engine.start(settle(chain).state)
    engine.periods(2000)
    finer = winding_of(engine.periods(8000)[0])
    assert finer.value is not None and found.value is not None and found.error is not None
    assert found.average_error < abs(finer.value - found.value) < found.error < 1e-6


def test_summary_frequency_and_nearest_fraction_are_those_of_the_number(curve: RotationNumber, three: RotationNumber) -> None:
    assert curve.summary()[0].startswith("rotation number 0.2218111") and "per period" in curve.summary()[0]
    assert "3 periods: 3 curves are visited in turn" in three.summary()[0]
    assert curve.second_frequency == curve.value * 1700.0 and three.second_frequency == three.value * 1078.0 / 3
    assert curve.nearest_fraction == Fraction(2, 9) and curve.fraction_distance == abs(curve.value - 2 / 9)
    assert curve.digits > 8.0 and curve.attributes()["rotation_number"] == curve.value


def test_another_start_gives_the_same_rotation_number(curve: RotationNumber) -> None:
    """The attractor is reached from other states as well."""
    pushed = State(np.linspace(1e-8, 0.0, 11), np.zeros(11))
    again = rotation_number(CURVE, start=pushed)
    assert again.value is not None and abs(again.value - curve.value) < curve.error + again.error


@pytest.mark.parametrize(("f", "regime"), [(340.0, "periodic"), (1090.0, "chaotic")])
def test_only_a_quasi_periodic_motion_has_a_rotation_number(f: float, regime: str) -> None:
    found = rotation_number(scene("sec2").evolve(f=f))
    assert found.value is None and found.error is None and found.second_frequency is None
    assert found.nearest_fraction is None and found.digits is None and np.isnan(found.convergence).all()
    assert found.summary() == [f"rotation number not decided: the motion is {regime}, not quasi-periodic"]


def test_the_computation_reports_progress_and_can_be_stopped() -> None:
    seen: list[float] = []
    rotation_number(CURVE, 1000, progress=seen.append)
    assert seen == sorted(seen) and seen[0] > 0.0 and seen[-1] <= 1.0
    stop = Stop()
    stop.set()
    with pytest.raises(Cancelled):
        rotation_number(CURVE, stop=stop)


@pytest.mark.parametrize("periods", [999, 10_001, 1000.5])
def test_a_record_has_a_length(periods: float) -> None:
    with pytest.raises(BadInput, match="periods ="):
        rotation_number(CURVE, periods)  # type: ignore[arg-type]


def test_a_number_has_the_digits_of_its_error() -> None:
    assert with_error(0.123456789, 1.2e-4) == "0.12346 ± 1.2e-04" and with_error(0.5, None) == "0.5"
    assert with_error(377.0, 12.0) == "377 ± 1.2e+01"


@pytest.mark.parametrize("f", [594.0, 1090.0])
def test_the_strobes_of_a_chaotic_chain_are_not_decided(f: float) -> None:
    """This does not depend on the regime's label; six or three bands are visited in turn, with exponents of 0.09 per
    period.
    """
    engine = Engine(scene("sec2").evolve(f=f), fixed_step_setting(), 1)
    engine.periods(1000)
    found = winding_of(engine.periods(6000)[0])
    assert found.value is None and found.curves in {3, 6} and found.reason


def test_of_a_long_chain_every_other_bead_is_kept() -> None:
    chain = scene("sec2").evolve(N=31, f=1700.0)
    kept, every = (Engine(chain, fixed_step_setting(), 1) for _ in range(2))
    np.testing.assert_array_equal(_strobes(kept, 1100), every.periods(1100)[0][1:, :, ::2])
