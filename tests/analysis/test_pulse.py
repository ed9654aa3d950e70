"""Impacts without a drive: solitary wave, train, impurity, dimer and taper agree with independent computations."""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core import BadInput, Run, pulse, resonance_curve, run, scene, settle
from granchain_core.analysis.pulse import CONTINUUM, solitary_speed
from granchain_core.scene.hertz import SOLITARY_BY_FORCE, SOLITARY_BY_VELOCITY

#: Samples in the time 1/f; the pulse takes about 70 of them to pass a bead.
SAMPLES = 4000
_RUNS: dict[str, Run] = {}


def recorded(name: str) -> Run:
    """Return the motion of a scene from its start over the time 1/f, which is computed once."""
    if name not in _RUNS:
        _RUNS[name] = run(scene(name), periods=0, record=1, samples=SAMPLES)
    return _RUNS[name]


def traveling_wave() -> tuple[np.ndarray, np.ndarray]:
    """Return ξ and the force F(ξ) of the solitary wave with V = K = m = 1, by Petviashvili's iteration.

    Newton's equations for the overlaps, δ'' = F(ξ + 1) − 2F(ξ) + F(ξ − 1), are δ = Λ * δ^{3/2} with the tent function
    Λ, whose Fourier transform is sinc². No code of granchain is used.
    """
    points, length = 2048, 16.0
    xi = (np.arange(points) - points // 2) * length / points
    tent = np.sinc(np.fft.rfftfreq(points, length / points)) ** 2
    overlap = np.exp(-(xi**2))
    for _ in range(300):
        image = np.fft.irfft(tent * np.fft.rfft(np.maximum(overlap, 0.0) ** 1.5), points)
        overlap = (overlap @ overlap / (overlap @ image)) ** 3 * image
    image = np.fft.irfft(tent * np.fft.rfft(np.maximum(overlap, 0.0) ** 1.5), points)
    assert np.abs(image - overlap).max() < 1e-12
    return xi, np.maximum(overlap, 0.0) ** 1.5


def test_both_constants_are_those_of_the_traveling_wave() -> None:
    """V = 1 = c F^{1/6} = c' v^{1/5}; by Newton's law, v(ξ) is the mean force between ξ − 1/2 and ξ + 1/2."""
    xi, force = traveling_wave()
    velocity = np.fft.irfft(np.sinc(np.fft.rfftfreq(len(xi), xi[1] - xi[0])) * np.fft.rfft(force), len(xi))
    assert force.max() ** (-1 / 6) == pytest.approx(SOLITARY_BY_FORCE, abs=1e-7)  # the constants have seven digits
    assert velocity.max() ** (-1 / 5) == pytest.approx(SOLITARY_BY_VELOCITY, abs=1e-7)


def test_nesterenkos_wave_has_both_closed_forms() -> None:
    """With V = K = m = 1, it is a cos⁴ with the largest overlap (5/4)², the force (5/4)³ and v = V δ."""
    overlap = (5.0 / 4.0) ** 2
    assert overlap ** (-1.5 / 6) == pytest.approx(CONTINUUM)
    assert overlap ** (-1 / 5) == pytest.approx(0.64**0.2)


def test_a_speed_has_its_unit_in_its_name() -> None:
    """The speeds differ by a factor, the distance of the beads."""
    found = pulse(recorded("impact"))
    radius = found.scene.beads[0].radius
    np.testing.assert_allclose(found.speed_m_s[1:-1], 2.0 * radius * found.speed_beads_s[1:-1])


def test_the_pulse_of_an_impact_is_the_solitary_wave() -> None:
    """It has the speed, the width and the shape of the solitary wave, more than twelve beads from the impact."""
    found = pulse(recorded("impact"))
    middle = slice(14, 20)
    law = [solitary_speed(found.run.scene, float(force)) for force in found.force]
    # after fifteen beads, the wave is solitary to 1e-4 in force; parabolas through the samples add 1e-6
    np.testing.assert_allclose(found.speed_beads_s[middle], law[middle], rtol=1e-4)
    xi, force = traveling_wave()
    above = xi[force > 0.5 * force.max()]
    # 2048 points over 16 beads: the width is known to one point
    np.testing.assert_allclose(found.width[middle], above[-1] - above[0], atol=0.01)
    contact = recorded("impact").force[:, 17]
    place = (recorded("impact").time - found.time[16]) * found.speed_beads_s[16]
    near = np.abs(place) < 2.0
    np.testing.assert_allclose(contact[near] / found.force[16], np.interp(place[near], xi, force / force.max()),
                               atol=1e-3)  # straight lines between points 1/128 bead apart: h²/8 F'' = 1e-5; speed 1e-4


def test_its_speed_grows_as_the_fifth_root_of_the_strike_and_its_force_as_the_power_six_fifths() -> None:
    """32 times the velocity gives twice the speed and 64 times the force; A0, only the unit of length, is irrelevant.
    """
    fast = scene("impact").evolve(strike=0.32, f=500.0, A0=3e-6)
    one, other = pulse(recorded("impact")), pulse(run(fast, periods=0, record=1, samples=SAMPLES))
    # the equations scale exactly; both runs are within 1e-6 of the truth
    np.testing.assert_allclose(other.speed_beads_s[1:-1], 2.0 * one.speed_beads_s[1:-1], rtol=1e-5)
    np.testing.assert_allclose(other.force, 64.0 * one.force, rtol=1e-5)


def own_motion(mass: np.ndarray, stiffness: np.ndarray, strike: float, time: float, every: int = 4) -> np.ndarray:
    """Return forces (SAMPLES + 1, N + 1) of an undamped chain between fixed ends, by classical RK4 with equal steps in
    SI units.
    """
    n, h = len(mass), time / (SAMPLES * every)
    y = np.zeros((2, n))
    y[1, 0] = strike

    def forces(u: np.ndarray) -> np.ndarray:
        ends = np.concatenate([[0.0], u, [0.0]])
        return np.asarray(stiffness * np.maximum(ends[:-1] - ends[1:], 0.0) ** 1.5)

    def slope(y: np.ndarray) -> np.ndarray:
        f = forces(y[0])
        return np.array([y[1], (f[:-1] - f[1:]) / mass])

    kept = [forces(y[0])]
    for step in range(SAMPLES * every):
        a = slope(y)
        b = slope(y + 0.5 * h * a)
        c = slope(y + 0.5 * h * b)
        y = y + h / 6.0 * (a + 2.0 * b + 2.0 * c + slope(y + h * c))
        if (step + 1) % every == 0:
            kept.append(forces(y[0]))
    return np.array(kept)


def steel(radius: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return masses of section 2's spheres with these radii, and the stiffness (4/3) E* √R* of all contacts."""
    mass = 28.84e-3 * (radius / 9.525e-3) ** 3
    bodies = np.concatenate([radius[:1], radius, radius[-1:]])
    return mass, 4 / 3 * 193e9 / (2 * (1 - 0.3**2)) * np.sqrt(1.0 / (1.0 / bodies[:-1] + 1.0 / bodies[1:]))


def radii(name: str) -> np.ndarray:
    """Return the radii that a scene's description states, written independently."""
    radius, number = np.full(30, 9.525e-3), np.arange(1, 31)
    return {
        "impact-train": np.where(number == 1, 6.0, 1.0) ** (1 / 3) * radius,
        "impact-impurity": np.where(number == 15, 0.2, 1.0) ** (1 / 3) * radius,
        "impact-dimer": np.where(number % 2 == 0, 0.3428, 1.0) ** (1 / 3) * radius,
        "impact-taper": radius * 0.3 ** ((number - 1) / 29),
    }[name]


@pytest.mark.parametrize("name", ["impact-train", "impact-impurity", "impact-dimer", "impact-taper"])
def test_chains_of_unequal_beads_move_as_an_independent_computation_says(name: str) -> None:
    """They agree in every force at every sample."""
    found = recorded(name)
    mass, stiffness = steel(radii(name))
    own = own_motion(mass, stiffness, 0.01, 1.0 / found.scene.f)
    # RK4 through the kinks of δ^{3/2}: h^{5/2} with h about 1/50 of a contact time; measured below 2e-5
    np.testing.assert_allclose(found.force, own, atol=1e-4 * own.max())
    assert found.displacement_error < 1e-5 and found.energy_residual < 1e-8


def test_a_pulse_with_two_maxima_in_a_contact_has_the_force_of_the_larger_one() -> None:
    """At ε = 0.3428, every second contact has two maxima before it opens: 1.42, then 2.07 N."""
    found = pulse(recorded("impact-dimer"))
    mass, stiffness = steel(radii("impact-dimer"))
    own = own_motion(mass, stiffness, 0.01, 1.0 / found.scene.f)
    two = 0
    for contact, force, time in zip(found.contact[:20], found.force, found.time, strict=False):  # a reflection comes later
        there = own[:, contact]
        least = 0.02 * there.max()
        first = int(np.flatnonzero(there > least)[0])
        opens = first + int(np.flatnonzero(there[first:] < least)[0])
        # samples are 1/70 of the passage apart, so the largest is below the maximum by 1e-4
        assert force == pytest.approx(there[first:opens].max(), rel=3e-4)
        assert time == pytest.approx(found.run.time[first + np.argmax(there[first:opens])], abs=1.1e-6)
        two += int(there[first + np.argmax(np.diff(there[first:opens]) < 0.0)] < 0.9 * force)
    assert two >= 5


@pytest.mark.parametrize(("name", "knobs", "first", "times"), [
    ("impact-dimer", {"N": 12, "dimer": 0.1}, 9, [6.528e-4]),
    ("impact", {"N": 8, "striker": 0.001}, 2, [3.37e-4, 5.06e-4, 6.76e-4, 8.44e-4, 1.01e-3, 1.18e-3]),
    ("sec2", {"N": 6}, 4, [5.687e-4]),
])
def test_the_wave_from_the_wall_is_not_the_pulse(name: str, knobs: dict[str, float], first: int, times: list[float]) -> None:
    """The times of the first maxima are from an independent RK4 in (u, v), to the digits given. The wave that returns
    before the contact has opened is larger; when it was used, pulses ran backwards.
    """
    found = pulse(run(scene(name).evolve(**knobs), periods=0, record=1, samples=SAMPLES))
    assert found.time[first - 1 : first - 1 + len(times)] == pytest.approx(times, rel=6e-3)
    assert found.speed_beads_s[1:-1].min() > 0.0 and found.width[1:-1].min() > 0.0


@pytest.mark.parametrize(("name", "knobs"), [
    ("sec2", {}), ("sec2", {"f": 100.0}), ("impact", {"dissipation": "linear", "D": 1000.0}),
])
def test_a_pulse_that_the_wave_from_the_wall_covers_is_refused(name: str, knobs: dict[str, float | str]) -> None:
    """The pulse was once reported at 1.57 ms in contact 8 of sec2, after contact 9 at 1.06 ms."""
    with pytest.raises(BadInput, match=r"cannot be distinguished from the wave .* contact \d+ has its largest force at .* s, after contact"):
        pulse(run(scene(name).evolve(**knobs), periods=0, record=1, samples=SAMPLES))


def test_a_ripple_before_the_pulse_of_a_pressed_chain_is_not_the_pulse() -> None:
    """If a bead strikes a chain under a preload of 0.1 N at 1 m/s, the pulse is nearly the solitary wave."""
    chain = scene("impact").evolve(F0=0.1, strike=1.0, N=20)
    pressed, free = (pulse(run(chain.evolve(F0=F0), periods=0, record=1, samples=SAMPLES)) for F0 in (0.1, 0.0))
    assert pressed.force == pytest.approx(free.force, rel=0.01)
    assert pressed.speed_beads_s[1:-1] == pytest.approx(free.speed_beads_s[1:-1], rel=0.01)


def test_the_sampling_error_shows_coarse_samples() -> None:
    """The stated sampling errors bound the differences from a fine record."""
    fine = pulse(recorded("impact"))
    for samples in (200, 400, 1000):
        coarse = pulse(run(scene("impact"), periods=0, record=1, samples=samples))
        wrong = np.abs(coarse.force / fine.force - 1.0).max()
        assert wrong < coarse.sampling_error < max(1.0, 100.0 * wrong)
        late = np.abs(coarse.time - fine.time).max()
        assert late < coarse.sampling_error_time < 30.0 * late
        for name in ("speed", "width"):
            exact = getattr(fine, name)[1:-1]
            wrong = np.nanmax(np.abs(getattr(coarse, name)[1:-1] / exact - 1.0))
            assert wrong < getattr(coarse, f"sampling_error_{name}") < 30.0 * wrong, name
    assert fine.sampling_error < 1e-5


def test_a_scene_without_a_drive_has_a_picture_and_no_steady_state() -> None:
    """Its picture is the motion from the start; analyses that need an orbit are refused with a sentence."""
    chain = scene("impact").evolve(N=5)
    shown = settle(chain, samples=96)
    assert shown.regime.sentence == "transient without a drive, from its start" and shown.run.velocity[0, 0] == pytest.approx(0.01)
    assert not shown.run.drive_displacement.any() and shown.run.displacement_error < chain.accuracy
    exact = run(chain, periods=0, record=1, samples=96)
    np.testing.assert_allclose(shown.run.displacement, exact.displacement, atol=2e-6 * np.abs(exact.displacement).max())
    with pytest.raises(BadInput, match="drive = rest"):
        resonance_curve(chain, [300.0])
    with pytest.raises(BadInput, match="at least three beads"):
        pulse(run(chain.evolve(N=2), periods=0, record=1, samples=96))


def test_a_chain_that_nothing_moves_is_not_asked_for_a_longer_record() -> None:
    with pytest.raises(BadInput, match="that nothing moves"):
        pulse(run(scene("impact").evolve(strike=0.0), periods=0, record=2))
