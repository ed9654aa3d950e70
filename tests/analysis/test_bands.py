"""Band edges of precompressed chains agree with closed forms, finite chains and driven motions."""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core import BadInput, LiveChain, bands, resonance_curve, scene, settle, spectrum
from granchain_core.integrate.scaling import scale_chain
from granchain_core.steady.settling.finite_difference_map import FiniteDifferenceMap, fixed_point

CHAIN = scene("precompressed")


def test_equal_beads_have_one_band_up_to_the_cut_off() -> None:
    """f_c = (1/π)√(k/m) with k = (3/2) K^{2/3} F0^{1/3}; a foundation raises the lower edge to √(k_f/m)/2π."""
    cut_off = np.sqrt(1.5 * CHAIN.K ** (2 / 3) * CHAIN.F0 ** (1 / 3) / CHAIN.bead(1).mass) / np.pi
    np.testing.assert_allclose(bands(CHAIN), [(0.0, cut_off)], rtol=1e-12)
    founded = CHAIN.evolve(k=1e7)
    ((low, high),) = bands(founded)
    assert low == pytest.approx(founded.foundation_frequency, rel=1e-9)
    assert high == pytest.approx(np.hypot(cut_off, founded.foundation_frequency), rel=1e-12)


def test_a_dimer_has_a_gap_between_its_acoustic_and_its_optical_band() -> None:
    """Its edges are √(2k/m₁), √(2k/m₂) and √(2k(1/m₁ + 1/m₂)) over 2π, m₂ < m₁ (Nesterenko 2001; Boechler et al. 2010).
    """
    chain = CHAIN.evolve(dimer=0.25)
    heavy, light = chain.bead(1).mass, chain.bead(2).mass
    spring = 1.5 * chain.contact_stiffness()[1] ** (2 / 3) * chain.F0 ** (1 / 3)
    edges = np.sqrt(2 * spring * np.array([1 / heavy, 1 / light, 1 / heavy + 1 / light])) / (2 * np.pi)
    acoustic, optical = bands(chain)
    assert acoustic[0] == bands(CHAIN.evolve(dimer=0.5))[0][0] == 0.0
    np.testing.assert_allclose([acoustic[1], *optical], edges, rtol=1e-12)


def test_the_driven_chain_passes_below_the_cut_off_and_not_above() -> None:
    """The force on the wall is that of the linear lattice with dashpots, solved as a complex linear system."""
    ((_, cut_off),) = bands(CHAIN)
    chain, part = CHAIN.evolve(A0=1e-9), np.array([0.6, 0.9, 1.1, 1.3])
    found = resonance_curve(chain, part * cut_off)
    passed = []
    for f in part * cut_off:
        omega, spring = 2 * np.pi * f, 1.5 * chain.contact_stiffness() * np.sqrt(chain.static_overlap())
        slope = spring + 1j * omega * chain.D
        matrix = np.diag(slope[:-1] + slope[1:]) - np.diag(slope[1:-1], 1) - np.diag(slope[1:-1], -1)
        answer = np.linalg.solve(matrix - omega**2 * np.diag(chain.masses()), np.eye(chain.N)[0] * slope[0] * chain.A0)
        passed.append(spring[-1] * abs(answer[-1]))
    assert passed[3] < 1e-2 * min(passed[:2])  # the cut-off exists
    # the next term of the force is a quarter of dynamic over static overlap, 1e-9 over 1e-6 m and less; the curve's
    # own error, 1e-5 of the largest displacement A0, is added where the last bead hardly moves
    np.testing.assert_allclose(found.column("max_output_force_elastic") - chain.F0, passed, rtol=2e-3,
                               atol=3e-5 * spring[-1] * chain.A0)


@pytest.mark.parametrize(("knobs", "words"), [({"F0": 0.0}, "Without a preload"), ({"taper": 0.5}, "taper = 1")])
def test_chains_without_bands_are_refused(knobs: dict[str, float], words: str) -> None:
    with pytest.raises(BadInput, match=words):
        bands(CHAIN.evolve(**knobs))


def test_the_diode_is_reciprocal_while_it_is_linear() -> None:
    """Small waves pass equally in both directions (linear reciprocity); the light bead's mode is above the cut-off."""
    small = [scene(name).evolve(A0=1e-9, f=4000.0) for name in ("diode", "diode-reverse")]
    forward, backward = (resonance_curve(one, [one.f]).points[0].max_output_force_elastic - one.F0 for one in small)
    # the force's next term is a quarter of dynamic over static overlap, a few 1e-3
    assert forward == pytest.approx(backward, rel=2e-3) and forward > 0.01
    spring = 1.5 * small[0].contact_stiffness() * np.sqrt(small[0].static_overlap())
    root = 1.0 / np.sqrt(small[0].masses())
    matrix = np.diag(spring[:-1] + spring[1:]) - np.diag(spring[1:-1], 1) - np.diag(spring[1:-1], -1)
    modes = np.sqrt(np.linalg.eigvalsh(root[:, None] * matrix * root)) / (2.0 * np.pi)
    ((_, cut_off),) = bands(small[0])
    assert modes[-2] < cut_off < scene("diode").f < modes[-1]


def test_the_diode_lets_the_drive_through_one_way_once_its_orbit_is_unstable() -> None:
    """A pair of its multipliers leaves the unit circle; the strongest line at the wall has the frequency of their
    angle.

    The multipliers are those of the fixed-step method's map, whose kernels are compiled anyway; `granchain branch`
    finds the point itself.
    """
    chain = scene("diode")
    below, above = (settle(chain.evolve(A0=amplitude)) for amplitude in (7.3e-7, 7.7e-7))
    assert below.regime.period == 1 and above.regime.name == "quasi-periodic"
    scaled = scale_chain(below.run.scene)
    x = scaled.beads_of(scaled.from_si(below.state))
    stable = fixed_point(FiniteDifferenceMap(below.run.scene, 1), x)
    unstable = fixed_point(FiniteDifferenceMap(above.run.scene, 1), x)
    assert stable is not None and unstable is not None and stable.modulus < 1.0 < unstable.modulus
    assert np.ptp(above.run.output_force_elastic) > 1e5 * np.ptp(below.run.output_force_elastic)
    assert np.ptp(settle(scene("diode-reverse")).run.output_force_elastic) < 1e-5 * np.ptp(above.run.output_force_elastic)
    lines = spectrum(LiveChain(above.run.scene, samples=64, start=above.state).advance(200 * 64), "output")
    strongest = lines.frequency[1 + int(lines.amplitude[1:].argmax())]
    multipliers = np.linalg.eigvals(unstable.derivative)
    turned = abs(np.angle(multipliers[np.abs(multipliers).argmax()])) / (2.0 * np.pi) * chain.f
    # the record of 200 periods resolves lines 54 Hz apart
    assert strongest == pytest.approx(turned, abs=54.0)
