"""The impact of one bead on a wall agrees with the closed forms of Hertz, of Tsuji and for the linear dashpot."""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core import scene
from granchain_core.hard_cases.chains import Bench
from granchain_core.integrate.scaling import scale_chain
from granchain_core.kernels.effects.dissipation import LinearDashpot, Tsuji

pytestmark = pytest.mark.quick

#: Duration 3.2180655 (m*/K)^{2/5} v^{-1/5} and peak force 1.1432626 K^{2/5} m*^{3/5} v^{6/5}; both constants are
#: known to eight digits, which is the tolerance 1e-7 below.
DURATION, PEAK = 3.2180655, 1.1432626


def impact(law, speed: float, stiffness: float = 1.0):
    """Return contact duration, overlap at half the Hertz duration, and speed after over speed before, at the wall."""
    hertz = DURATION * stiffness**-0.4 * speed**-0.2
    chain = Bench(1, 2.0 * hertz, 4, law, ends=(0.0, stiffness))
    chain.throw([speed])
    kept = chain.record()
    after = -kept.velocity[-1, 0]
    # after the impact, the bead flies freely: its distance shows when it left the wall
    duration = chain.time[-1] + kept.displacement[-1, 0] / after
    return duration, kept.displacement[1, 0], after / speed


@pytest.mark.parametrize("stiffness", [1.0, 2.0**0.5, 2.0 * 2.0**0.5])
@pytest.mark.parametrize("speed", [0.01, 1.0, 10.0])
def test_hertz_collision_has_its_duration_peak_force_and_no_loss(speed, stiffness):
    """A lossless impact has the duration and peak force of Hertz's theory, for every wall factor."""
    duration, overlap, restitution = impact(Tsuji(0.0), speed, stiffness)
    assert duration == pytest.approx(DURATION * stiffness**-0.4 * speed**-0.2, rel=1e-7)
    assert stiffness * overlap**1.5 == pytest.approx(PEAK * stiffness**0.4 * speed**1.2, rel=1e-7)
    assert restitution == pytest.approx(1.0, abs=1e-10)  # 1000 times the tolerance per step


@pytest.mark.parametrize("masses", [(1.0, 3.0), (5.0, 0.4)])
def test_two_unequal_beads_part_as_momentum_and_energy_say_after_the_time_of_their_reduced_mass(masses):
    """v₁' = (m₁ − m₂)/(m₁ + m₂) v, v₂' = 2m₁/(m₁ + m₂) v, and Hertz's duration with m* = m₁m₂/(m₁ + m₂)."""
    first, second = masses
    speed, reduced = 0.7, first * second / (first + second)
    hertz = DURATION * reduced**0.4 * speed**-0.2
    chain = Bench(2, 2.0 * hertz, 4, ends=(0.0, 0.0), inverse_mass=[1.0 / first, 1.0 / second])
    chain.throw([speed, 0.0])
    kept = chain.record()
    after = kept.velocity[-1]
    assert after[0] == pytest.approx((first - second) / (first + second) * speed, abs=1e-10)
    assert after[1] == pytest.approx(2.0 * first / (first + second) * speed, abs=1e-10)
    # both fly freely since they parted: their distance shows when that was
    parted = chain.time[-1] - (kept.displacement[-1, 1] - kept.displacement[-1, 0]) / (after[1] - after[0])
    assert parted == pytest.approx(hertz, rel=1e-7)


@pytest.mark.parametrize("restitution", [0.95, 0.7, 0.3])
@pytest.mark.parametrize("speed", [0.1, 3.0])
def test_tsuji_restitution_is_exact_and_independent_of_speed(speed, restitution):
    """α = √5·(−ln e)/√(π² + ln² e) gives the restitution e at every speed (contact ends at zero overlap)."""
    loss = -np.log(restitution)
    alpha = np.sqrt(5.0) * loss / np.hypot(np.pi, loss)
    _, _, found = impact(Tsuji(alpha), speed)
    assert found == pytest.approx(restitution, rel=1e-9)  # exact formula; 1e4 times the tolerance per step


@pytest.mark.parametrize("wall", ["bead", "rigid"])
def test_the_damping_coefficient_of_the_page_gives_the_restitution(wall):
    """docs/model.md gives D = α √(m_eff K) δ_r^{1/4} in SI units, here at the wall, where m_eff is the bead's mass."""
    loss = -np.log(0.6)
    shown = scene("rig").evolve(A0=3e-6, dissipation="tsuji", wall=wall)  # A0 is not the reference overlap
    stiffness = shown.contact_stiffness()[-1]
    alpha = np.sqrt(5.0) * loss / np.hypot(np.pi, loss)
    damping = alpha * np.sqrt(shown.bead(1).mass * stiffness) * shown.reference_overlap**0.25
    slot = scale_chain(shown.evolve(D=damping)).slots.dissipation
    assert impact(slot, 1.0, stiffness / shown.K)[2] == pytest.approx(0.6, rel=1e-9)  # as above


def test_linear_dashpot_restitution_depends_on_one_number_to_first_order():
    """e = 1 − 1.78783 L + O(L²) with L = D/(m^{3/5} K^{2/5} v^{1/5}): the slope at L → 0."""
    small = np.array([1e-3, 2e-3])
    lost = np.array([1.0 - impact(LinearDashpot(x), 1.0)[2] for x in small])
    slope = 2.0 * lost[0] / small[0] - lost[1] / small[1]  # Richardson extrapolation removes the O(L) of the slope
    assert slope == pytest.approx(1.78783, rel=1e-5)  # the constant has six digits; O(L²) = 1e-6
    same = [impact(LinearDashpot(0.1 * v**0.2), v)[2] for v in (0.01, 1.0, 5.0)]
    assert np.ptp(same) < 1e-9  # the same L at every speed; solver tolerance 1e-13


@pytest.mark.parametrize("speed", [0.2, 1.0, 4.0])
def test_bead_between_two_contacts_swings_as_the_pure_three_halves_oscillator(speed):
    """x'' = −|x|^{3/2} sgn x has ω = 0.9546936 A^{1/4}: after one period the bead is where it began."""
    amplitude = (1.25 * speed**2) ** 0.4  # v²/2 = (2/5) A^{5/2}
    period = 2.0 * np.pi / (0.9546936 * amplitude**0.25)
    chain = Bench(1, period, 4)
    chain.throw([speed])
    kept = chain.record()
    expected = amplitude * np.array([0.0, 1.0, 0.0, -1.0, 0.0])
    # ω has seven digits: in one period, the error is at most 2π·1e-7 of the amplitude, and the solver's is negligible
    np.testing.assert_allclose(kept.displacement[:, 0], expected, atol=1e-6 * amplitude)
