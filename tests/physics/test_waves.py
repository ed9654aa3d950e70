"""Pulses and small waves travel as in the theory of granular chains."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from granchain_core import State, run, scene
from granchain_core.hard_cases.chains import Bench
from granchain_core.integrate import Engine, MethodSetting
from granchain_core.kernels.effects.dissipation import LinearDashpot
from granchain_core.kernels.effects.driver import Harmonic
from granchain_core.scene.hertz import SOLITARY_BY_FORCE, SOLITARY_BY_VELOCITY


def top(time: np.ndarray, values: np.ndarray) -> tuple[float, float]:
    """Return time and height of a smooth pulse, from the parabola through the highest sample and its neighbours."""
    i = int(values.argmax())
    before, best, after = values[i - 1 : i + 2]
    curvature = before - 2.0 * best + after
    shift = 0.5 * (before - after) / curvature
    return time[i] + shift * (time[1] - time[0]), best - 0.125 * (before - after) ** 2 / curvature


def test_solitary_wave_of_the_uncompressed_chain_has_its_speed():
    """After an impact on bead 1, V = c F_max^{1/6} = c' v_max^{1/5} (K = m = 1, in beads per unit time)."""
    beads, samples = 60, 4000
    chain = Bench(beads, 60.0, samples, ends=(0.0, 1.0), tolerance=1e-11)
    chain.throw(np.eye(beads)[0])
    kept = chain.record()
    passes = {c: top(chain.time, kept.force[:, c]) for c in (30, 40)}
    speed = 10.0 / (passes[40][0] - passes[30][0])
    force = 0.5 * (passes[30][1] + passes[40][1])
    velocity = top(chain.time, kept.velocity[:, 35])[1]
    # Beyond bead 30, the pulse is solitary to 1e-5; sampling at 0.015 and the parabola add about 1e-6.
    assert speed == pytest.approx(SOLITARY_BY_FORCE * force ** (1 / 6), rel=2e-5)
    assert speed == pytest.approx(SOLITARY_BY_VELOCITY * velocity**0.2, rel=2e-5)


def test_momentum_changes_by_the_forces_on_the_ends_and_nothing_else():
    """Σ m v changes by ∫ (F_0 − F_N) dt, up to the error of the quadrature."""
    # a tension cut and damping only redistribute momentum; with a preload, all forces are smooth and Simpson's rule
    # converges
    result = run(scene("sec2").evolve(F0=5.0, accuracy=1e-9), periods=0, record=2, samples=400)
    momentum = (result.scene.masses() * result.velocity).sum(axis=1)
    push = result.input_force - result.output_force
    step = result.time[1] - result.time[0]
    impulse = step / 3 * (push[0] + 4 * push[1::2].sum() + 2 * push[2:-1:2].sum() + push[-1])
    # Simpson's error is h⁴/180·t·F'''' with h = 1/400 period; with the chain's 8 kHz cut-off, it is a few 1e-3 of the
    # largest impulse over one swing of the fastest mode, and far less over slow ones; measured 1e-7.
    assert impulse == pytest.approx(momentum[-1] - momentum[0], abs=1e-6 * np.abs(momentum).max())


def linear_modes(chain) -> tuple[np.ndarray, np.ndarray]:
    """Return frequencies [Hz], ascending, and shapes of small waves about the precompressed rest, with fixed driver."""
    slope = 1.5 * chain.contact_stiffness() * np.sqrt(chain.static_overlap())
    matrix = np.diag(slope[:-1] + slope[1:]) - np.diag(slope[1:-1], 1) - np.diag(slope[1:-1], -1)
    root = 1.0 / np.sqrt(chain.masses())
    squares, shapes = np.linalg.eigh(root[:, None] * matrix * root)
    return np.sqrt(squares) / (2 * np.pi), root[:, None] * shapes


def swing(chain, mode: int, amplitude: float) -> float:
    """Return the largest deviation, over the amplitude, from the linear motion of one mode during three periods."""
    frequencies, shapes = linear_modes(chain)
    shape = shapes[:, mode] / np.abs(shapes[:, mode]).max()
    clock = chain.evolve(f=frequencies[mode] / 3.0)
    engine = Engine(clock, MethodSetting("dop853", tolerance=1e-12), 48)
    scaled = engine.scaled
    slots = scaled.slots._replace(driver=Harmonic(0.0, scaled.beta), dissipation=LinearDashpot(0.0))
    engine.use(replace(scaled, slots=slots))
    engine.start(State(amplitude * shape, np.zeros(chain.N)))
    moved = engine.record(48).displacement * scaled.scales.length
    linear = amplitude * np.outer(np.cos(2 * np.pi * 3 * np.arange(49) / 48), shape)
    return float(np.abs(moved - linear).max() / amplitude)


@pytest.mark.parametrize("mode", [0, 10])
def test_small_waves_of_the_precompressed_chain_follow_the_linear_modes(mode):
    """The relative deviation from the linear mode is small and grows with the amplitude (the force's next term is δ²).
    """
    chain = scene("sec2").evolve(F0=10.0)
    static = float(chain.static_overlap()[0])
    small, larger = (swing(chain, mode, x * static) for x in (1e-5, 1e-4))
    assert small < 1e-3  # 1e-5 of the overlap, times the quadratic term's order-one factor and three periods
    assert larger / small == pytest.approx(10.0, rel=0.05)  # the next power of the amplitude is 1e-4 of it


def test_upper_end_of_the_linear_modes_is_the_cut_off_frequency():
    """With many beads, the highest mode approaches f_c = (1/π)√(1.5 K^{2/3} F0^{1/3}/m) as 1 − O(1/N²)."""
    chain = scene("sec2").evolve(F0=10.0, N=200)
    cut_off = np.sqrt(1.5 * chain.K ** (2 / 3) * chain.F0 ** (1 / 3) / chain.bead(1).mass) / np.pi
    assert linear_modes(chain)[0][-1] == pytest.approx(cut_off, rel=(np.pi / 400) ** 2)


@pytest.mark.parametrize("ratio", [0.8, 1.25])
def test_weakly_driven_precompressed_chain_answers_as_the_linear_lattice_with_dashpots(ratio):
    """Below and above the cut-off, the settled motion is Im(U e^{iωt}) with U from a complex linear system."""
    chain = scene("sec2").evolve(F0=10.0, N=8, A0=1e-10, D=50.0, accuracy=1e-6)
    cut_off = np.sqrt(1.5 * chain.K ** (2 / 3) * chain.F0 ** (1 / 3) / chain.bead(1).mass) / np.pi
    driven = chain.evolve(f=ratio * cut_off)
    result = run(driven, periods=3000, record=1, samples=16)  # the slowest mode has decayed by e^-30
    omega = 2 * np.pi * driven.f
    slope = 1.5 * chain.contact_stiffness() * np.sqrt(chain.static_overlap()) + 1j * omega * chain.D
    matrix = np.diag(slope[:-1] + slope[1:]) - np.diag(slope[1:-1], 1) - np.diag(slope[1:-1], -1)
    answer = np.linalg.solve(matrix - omega**2 * np.diag(chain.masses()), np.eye(8)[0] * slope[0] * chain.A0)
    expected = np.imag(np.outer(np.exp(2j * np.pi * np.arange(17) / 16), answer))
    # the force's next term is δ_dynamic/(4 δ_static) = 1e-4/4 of the linear one
    np.testing.assert_allclose(result.displacement, expected, atol=2e-4 * chain.A0)


def test_scaling_of_amplitude_frequency_and_damping_leaves_the_scaled_orbit_alone():
    one = scene("sec2").evolve(kappa=0.001, accuracy=1e-9)
    s = 7.0
    a, b = (run(x, periods=0, record=5, samples=16) for x in (one, one.scaled(s)))
    # equal up to rounding of the parameters, amplified by the motion's sensitivity of about 4 (reference) and by the
    # steps that rounding moves: far below the requested accuracy
    np.testing.assert_allclose(b.displacement, s * a.displacement, atol=2e-9 * s * np.abs(a.displacement).max())
    np.testing.assert_allclose(b.force, s**1.5 * a.force, atol=2e-8 * s**1.5 * np.abs(a.force).max())
