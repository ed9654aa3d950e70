"""Rotation numbers of maps with known ones, and of section 2's chain compared with the lines of its force."""

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
from granchain_core.analysis.birkhoff import average, refined_frequency, weights
from granchain_core.analysis.rotation_number import _strobes, with_error
from granchain_core.analysis.winding import Winding, winding_of
from granchain_core.execution.stop import Stop
from granchain_core.integrate import Engine, fixed_step_setting

GOLDEN = (3.0 - np.sqrt(5.0)) / 2.0  # 0.38…, in [0, ½]
COUNT = 4001


def circle(theta: np.ndarray) -> np.ndarray:
    """Return angles in turns as states (P, 2, 1) on the unit circle."""
    return np.stack([np.cos(2 * np.pi * theta), np.sin(2 * np.pi * theta)], axis=1)[:, :, None]


def rigid(rho: float, count: int = COUNT) -> np.ndarray:
    """Return the angles of a rigid rotation."""
    return np.asarray(0.1 + rho * np.arange(count))


def circle_map(omega: float, strength: float, count: int = COUNT) -> np.ndarray:
    """Return the angles of Arnold's circle map θ + Ω − (K / 2π) sin 2πθ."""
    theta = np.zeros(count)
    for p in range(1, count):
        theta[p] = theta[p - 1] + omega - strength / (2 * np.pi) * np.sin(2 * np.pi * theta[p - 1])
    return theta


def omega_of(rho: float, strength: float) -> float:
    """Return the Ω with which the circle map has the rotation number ρ, from its conjugacy to a rotation.

    h(φ + ρ) = h(φ) + Ω − (K / 2π) sin 2πh(φ) with h(φ) = φ + u(φ) is solved for Ω and the Fourier series u by
    iteration.
    """
    phi, modes = np.arange(64) / 64, np.fft.fftfreq(64, 1 / 64)
    divisor = np.exp(2j * np.pi * modes * rho) - 1.0
    divisor[0] = 1.0
    u, omega = np.zeros(64), rho
    for _ in range(200):
        force = -strength / (2 * np.pi) * np.sin(2 * np.pi * (phi + u))
        omega = rho - force.mean()
        series = np.fft.fft(force) / divisor
        series[[0, 32]] = 0.0
        u = np.fft.ifft(series).real
    return omega


def off(found: Winding, rho: float) -> float:
    """Return the distance from the known ρ, which must be within the stated error."""
    assert found.value is not None and found.error is not None, found.reason
    distance = abs(found.value - rho)
    assert distance <= found.error < 1e-2
    return distance


def test_the_weights_are_those_of_the_source() -> None:
    """Their sum is 1, they are symmetric, and averages of smooth functions on a rotation are exact up to rounding."""
    assert weights(1000).sum() == pytest.approx(1.0, abs=1e-14)
    np.testing.assert_allclose(weights(1000), weights(1000)[::-1], atol=1e-15)
    assert weights(3)[1] / weights(3)[0] == pytest.approx(np.exp(-4.0 + 16.0 / 3.0))
    seen = np.exp(np.cos(2 * np.pi * rigid(GOLDEN)))
    assert average(seen) == pytest.approx(np.i0(1.0), abs=1e-14) and seen.mean() != pytest.approx(np.i0(1.0), abs=1e-6)


def test_a_lines_frequency_is_found_far_within_the_resolution() -> None:
    states = circle(rigid(GOLDEN)).reshape(COUNT, 2)
    assert refined_frequency(states, GOLDEN + 0.4 / COUNT) == pytest.approx(GOLDEN, abs=1e-14)


@pytest.mark.parametrize("rho", [GOLDEN, np.sqrt(2.0) - 1.0, 1.0 / np.pi, np.exp(-2.5), np.pi - 2.65])
def test_a_rigid_rotation(rho: float) -> None:
    assert off(winding_of(circle(rigid(rho))), rho) < 1e-13


@pytest.mark.parametrize("strength", [0.1, 0.3, 0.5])
def test_the_circle_map(strength: float) -> None:
    found = winding_of(circle(circle_map(omega_of(GOLDEN, strength), strength)))
    assert off(found, GOLDEN) < 1e-11 and found.error < 1e-10 and found.curves == 1 and found.projections >= 3


def test_the_circle_map_by_its_conjugacy_far_from_linear() -> None:
    """h(φ) = φ + 0.8 sin(2πφ) / 2π transforms a rotation into a map whose steps differ by a factor of nine."""
    phi = rigid(GOLDEN)
    assert off(winding_of(circle(phi + 0.8 * np.sin(2 * np.pi * phi) / (2 * np.pi))), GOLDEN) < 1e-10


def test_the_average_converges_faster_than_any_power() -> None:
    """From 500 to 2000 states, the difference of halves falls by more than 4⁴. The unweighted mean is wrong by 1e-6."""
    theta = circle_map(omega_of(GOLDEN, 0.5), 0.5)
    found = winding_of(circle(theta))
    assert found.convergence is not None
    assert list(found.convergence[:, 0]) == [500, 1000, 2000, 3999]
    assert found.convergence[0, 2] > 4.0**4 * found.convergence[2, 2]
    assert abs((theta[-1] - theta[0]) / (COUNT - 1) - GOLDEN) > 1e-6


def test_sign_time_and_whole_turns_make_no_difference() -> None:
    """ρ is known up to its sign and a whole number: reversing time, mirroring or adding turns does not change it."""
    states = circle(circle_map(omega_of(GOLDEN, 0.3), 0.3))
    mirrored = states * np.array([1.0, -1.0])[:, None]
    for same in (states[::-1], mirrored, circle(rigid(1.0 - GOLDEN)), circle(rigid(GOLDEN + 2.0))):
        off(winding_of(np.ascontiguousarray(same)), GOLDEN)


def test_any_linear_change_of_coordinates_gives_the_same() -> None:
    """Eight coordinates are mixed at random, with harmonics that make the curve cross itself in every plane."""
    rng, theta = np.random.default_rng(3), rigid(GOLDEN)
    waves = np.concatenate([np.exp(2j * np.pi * k * theta)[:, None] / k for k in range(1, 5)], axis=1)
    curve = np.concatenate([waves.real, waves.imag], axis=1)
    found = [winding_of((curve @ rng.standard_normal((8, 8))).reshape(COUNT, 2, 4)) for _ in range(5)]
    assert max(off(one, GOLDEN) for one in found) < 1e-11


def test_a_curve_whose_strongest_line_is_twice_the_rotation_number() -> None:
    """Most coordinates go around twice per turn, so ρ is half of the strongest line, or that plus a half."""
    theta = rigid(GOLDEN)
    states = np.concatenate([circle(2 * theta), 0.2 * circle(theta)], axis=2)
    assert off(winding_of(states), GOLDEN) < 1e-12


@pytest.mark.parametrize("curves", [2, 3, 5])
def test_curves_that_are_visited_in_turn(curves: int) -> None:
    """The rotation number is that of the q-th iterate, known up to its sign and a whole number."""
    theta = rigid(GOLDEN / curves, 4000 * curves)
    places = np.random.default_rng(curves).standard_normal((curves, 2, 1))
    found = winding_of(circle(theta) + 5.0 * np.tile(places, (4000, 1, 1)))
    assert found.curves == curves and off(found, GOLDEN) < 1e-12


def test_noise_is_in_the_error() -> None:
    """With noise in the states, the error is larger than without, and is still a bound."""
    rng, states, errors = np.random.default_rng(0), circle(rigid(GOLDEN)), []
    for noise in (1e-6, 1e-3, 3e-2):
        found = winding_of(states + noise * rng.standard_normal(states.shape))
        off(found, GOLDEN)
        errors.append(found.error)
    assert 1e-13 < errors[0] < errors[1] < errors[2] < 1e-3


@pytest.mark.parametrize("seed", range(8))
def test_a_rotation_whose_phase_diffuses_has_a_large_error_or_none(seed: int) -> None:
    """The angle is a random walk around its mean advance, whose error falls as 1/√P. With steps of 5e-4, the error is
    1e-5 here, and the stated one a bound; with steps of 5e-3, nothing is decided.
    """
    walk = np.random.default_rng(seed).standard_normal(COUNT).cumsum()
    slow, fast = (winding_of(circle(rigid(GOLDEN) + step * walk)) for step in (5e-4, 5e-3))
    assert slow.value is not None and 1e-5 < slow.error < 1e-3
    assert abs(slow.value - GOLDEN) < slow.error
    assert fast.value is None


def test_chaos_is_not_decided() -> None:
    """Examples are Hénon's map with a = 1.4 and b = 0.3, and white noise."""
    states = np.zeros((COUNT, 2, 1))
    for p in range(1, COUNT):
        x, y = states[p - 1, :, 0]
        states[p, :, 0] = 1.0 - 1.4 * x * x + y, 0.3 * x
    for seen in (states, np.random.default_rng(0).standard_normal((COUNT, 2, 3))):
        found = winding_of(seen)
        assert found.value is None and "multiples of one frequency" in found.reason


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


def test_three_frequencies_are_not_decided() -> None:
    states = np.concatenate([circle(rigid(GOLDEN)), circle(rigid(np.sqrt(3.0) - 1.5))], axis=2)
    assert "there is a third frequency" in winding_of(states).reason


@pytest.mark.parametrize("fraction", [Fraction(0), Fraction(1, 2), Fraction(1, 3), Fraction(1, 4), Fraction(2, 5), Fraction(1, 6),
                                      Fraction(3, 7)], ids=str)
def test_near_a_fraction_a_multiple_is_not_taken_for_the_number(fraction: Fraction) -> None:
    """For curves with six harmonics, known ρ and 0.5 to 30 turns in the record, the result is right or not decided."""
    random, decided = np.random.default_rng(0), 0
    for _ in range(40):
        rho = float(fraction) + random.uniform(0.5, 30.0) / 4000 / fraction.denominator
        angle, sizes = 2.0 * np.pi * rho * np.arange(4000)[:, None], random.normal(size=(6, 22))
        states = sum(sizes[h] * size * np.cos((h + 1) * angle + h) + sizes[h][::-1] * size * np.sin((h + 1) * angle)
                     for h, size in enumerate((1.0, 1.5, 0.7, 0.4, 0.2, 0.1)))
        found = winding_of(np.reshape(states, (4000, 2, 11)))
        if found.value is not None:
            decided += 1
            assert abs(found.value - abs(rho - round(rho))) <= found.error
    assert decided >= 5


def test_near_a_fraction_the_record_may_be_too_short() -> None:
    """With a third plus 1e-4, the angle advances in 4000 states by 1.2 times the distance between three places."""
    found = winding_of(circle(rigid(1.0 / 3.0 + 1e-4)))
    assert found.value is None
    assert found.reason.startswith("the rotation number is within 1.0e-04 of 1/3, and the record is too short")
    assert off(winding_of(circle(rigid(1.0 / 3.0 + 1e-4, 80_001))), 1.0 / 3.0 + 1e-4) < 1e-12


@pytest.mark.parametrize(("states", "reason"), [
    (np.ones((COUNT, 2, 1)), "all the same"), (circle(rigid(0.4)), "repeat after 5 periods"),
    (circle(rigid(10.0 / 23.0)), "record is too short"), (circle(rigid(GOLDEN, 100)), "fewer than 200 states"),
    (circle(rigid(0.5 * GOLDEN, 300)) + np.tile([[[9.0], [0.0]], [[0.0], [0.0]]], (150, 1, 1)), "each of 2 curves"),
])
def test_states_without_a_rotation_number_have_a_reason(states: np.ndarray, reason: str) -> None:
    found = winding_of(states)
    assert found.value is None and found.error is None and reason in found.reason


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
    """Every strong line of the output force is at |m f/q + n f₂|, for q curves, within the resolution of the spectrum.

    `by_chance` is the probability that a line is so near to one of them by chance.
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
