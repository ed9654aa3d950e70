"""Spectra agree with the underlying motion, with an independently solved linear lattice, and with finer samples."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from granchain_core import BadInput, Run, Scene, run, scene, spectrum, transfer
from granchain_core.analysis.spectrum import cosines
from granchain_core.results.regime import Regime

#: Small waves in a chain with a preload of 50 N: every contact stays closed and is nearly a linear spring.
PRESSED = scene("sec2").evolve(N=5, F0=50.0, A0=1e-9, f=4000.0, accuracy=1e-8)


@pytest.fixture(scope="module")
def period_3() -> Run:
    return run(scene("sec2").evolve(f=1130.0), periods=300, record=12, samples=128)


def test_the_lines_of_an_orbit_add_up_to_its_force(period_3: Run) -> None:
    found = spectrum(period_3)
    assert found.period == 3 and found.frequency[1] == pytest.approx(1130.0 / 3.0)
    time = period_3.time[:384]
    again = (found.amplitude[:, None] * np.cos(2.0 * np.pi * found.frequency[:, None] * time + found.phase[:, None])).sum(axis=0)
    start = len(period_3.time) - 1 - 384
    np.testing.assert_allclose(again, period_3.output_force[start : start + 384], atol=1e-9 * period_3.max_output_force)


def test_a_window_gives_the_lines_their_height(period_3: Run) -> None:
    """The record has four orbits, so with Hann's window, there is no leakage between neighbouring lines."""
    lines = spectrum(period_3)
    window = spectrum(replace(period_3, regime=Regime.unsettled(300)))
    assert window.period is None and window.resolution == pytest.approx(2.0 * 1130.0 / 12.0)
    np.testing.assert_allclose(window.amplitude[4:200:4], lines.amplitude[1:50], rtol=1e-3, atol=1e-6 * lines.amplitude.max())


@pytest.mark.parametrize("repeats", [True, False])
def test_the_line_at_half_the_sampling_frequency_has_its_own_height(repeats: bool) -> None:
    alternating = np.cos(np.pi * np.arange(64))
    assert abs(cosines(alternating, repeats)[-1]) == pytest.approx(1.0, rel=1e-12)


def test_aliasing_is_estimated() -> None:
    coarse, fine = (spectrum(run(scene("sec2").evolve(N=3, f=1200.0), periods=200, record=2, samples=samples))
                    for samples in (32, 1024))
    low = len(coarse.frequency) // 2
    assert np.abs(coarse.amplitude - fine.amplitude[: len(coarse.amplitude)])[:low].max() < coarse.aliasing
    assert fine.aliasing < 0.3 * coarse.aliasing


def lattice(chain: Scene, f: float) -> complex:
    """Return F_out / F_in of the linear chain of masses, springs and dashpots, solved as a linear system."""
    bead, omega = chain.bead(1), 2.0 * np.pi * f
    stiffness, law = np.zeros(chain.N + 1), chain.contact_stiffness()
    overlaps = chain.static_overlap()
    stiffness[:] = 1.5 * law * np.sqrt(overlaps)
    spring = stiffness + 1j * omega * chain.D
    matrix = np.diag(spring[:-1] + spring[1:] - bead.mass * omega**2).astype(complex)
    matrix -= np.diag(spring[1:-1], 1) + np.diag(spring[1:-1], -1)
    u = np.linalg.solve(matrix, np.append(spring[0], np.zeros(chain.N - 1)))
    return complex(spring[-1] * u[-1] / (spring[0] * (1.0 - u[0])))


@pytest.mark.parametrize("changes", [{"N": 4}, {"N": 5, "F0": 1.0, "dissipation": "tsuji"}], ids=["jumps", "pressed"])
def test_gain_and_phase_are_known_to_the_errors_that_are_stated(changes: dict[str, object]) -> None:
    """They are compared with at least sixteen times the samples; without a jump, the error is that of the motion.

    Both chains are settled after 60 periods: after 300, no value differs by more than 1e-10 of its stated error.
    """
    chain = scene("sec2").evolve(f=1200.0, **changes)
    fine = transfer(run(chain.evolve(accuracy=1e-9), periods=60, record=2, samples=4096))
    for samples in (64, 256):
        found = transfer(run(chain, periods=60, record=2, samples=samples))
        same = np.searchsorted(fine.frequency, found.frequency * (1.0 - 1e-9))
        wrong = np.abs(found.gain - fine.gain[same])
        turned = np.abs(np.angle(np.exp(1j * (found.phase - fine.phase[same]))))
        known = ~np.isnan(found.gain_error)
        assert (wrong[known] <= found.gain_error[known]).all() and (turned <= found.phase_error).all()
        assert found.gain_error[1] < 0.1 * found.gain[1] and found.phase_error[1] < 0.1  # meaningful bounds


@pytest.mark.parametrize("f", [2000.0, 4000.0, 6000.0])
def test_small_waves_of_a_pressed_chain_pass_as_the_linear_lattice_says(f: float) -> None:
    """The deviation from the linear chain is of the order of the amplitude over the static overlap, 1e-9 over 3e-6 m.
    """
    chain = PRESSED.evolve(f=f)
    through = transfer(run(chain, periods=400, record=2, samples=64))
    expected = lattice(chain, f)
    assert through.frequency[1] == pytest.approx(f)  # after the mean
    assert through.gain[1] == pytest.approx(abs(expected), rel=2e-3)
    assert np.exp(1j * through.phase[1]) == pytest.approx(expected / abs(expected), abs=2e-3)


def test_motions_without_a_spectrum_are_refused(period_3: Run) -> None:
    odd = run(scene("sec2").evolve(N=2, f=2000.0), periods=60, record=1, samples=5)
    for motion, force, words in ((period_3, "wall", "force 'wall'"), (odd, "output", "even number of samples"),
                                 (replace(period_3, regime=replace(period_3.regime, period=13)), "output", "13 whole recorded")):
        with pytest.raises(BadInput, match=words):
            spectrum(motion, force)
