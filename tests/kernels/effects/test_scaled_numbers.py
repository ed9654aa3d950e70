"""Conversion from SI units to scaled units, for unequal beads and for damping at other drive amplitudes."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from granchain_core import Scene, scene
from granchain_core.integrate.scaling import scale_chain
from granchain_core.kernels.effects.dissipation import damping
from granchain_core.kernels.equations.motion import contact_force, motion, stored_energy
from granchain_core.scene import Bead


def dimer(law: str) -> Scene:
    """Return six precompressed beads on a foundation: alternately steel and a lighter bead, with bead 3 heavy and soft.
    """
    base = scene("sec2").evolve(N=6, kappa=0.002, F0=3.0, wall="rigid", f=400.0, dissipation=law)
    steel = base.bead(1)
    light = Bead(0.3 * steel.mass, 1.4 * steel.radius, 0.5 * steel.young, 0.2)
    heavy = Bead(5.0 * steel.mass, 0.6 * steel.radius, 0.1 * steel.young, 0.35)
    return replace(base, pattern=(steel, light), impurities=((3, heavy),))


def stiffness(a: Bead, b: Bead) -> float:
    """Return (4/3) E* √R* of two spheres."""
    modulus = 1.0 / ((1.0 - a.poisson**2) / a.young + (1.0 - b.poisson**2) / b.young)
    return 4.0 / 3.0 * modulus * math.sqrt(a.radius * b.radius / (a.radius + b.radius))


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("law", ["none", "linear"])
def test_unequal_beads_move_as_the_equations_say(law: str, seed: int) -> None:
    """Forces, du/dt = v, m ẇ = F_left − F_right − k u and the stored energy agree with formulas in SI units; the
    kernels run uncompiled.
    """
    chosen = dimer(law)
    beads = [chosen.bead(i) for i in range(1, 7)]
    K = np.array([stiffness(a, b) for a, b in zip([beads[0], *beads[:-1]], beads, strict=True)]
                 + [2.0 * math.sqrt(2.0) * stiffness(beads[-1], beads[-1])])
    masses = np.array([bead.mass for bead in beads])
    rng, length = np.random.default_rng(seed), 2.0 * chosen.A0 + float(chosen.static_overlap().max())
    u, v = rng.uniform(-1.0, 1.0, 6) * length, rng.uniform(-1.0, 1.0, 6) * 0.02
    theta = 0.7
    u0, v0 = chosen.A0 * math.sin(theta), 2 * math.pi * chosen.f * chosen.A0 * math.cos(theta)
    bodies, speeds = np.array([u0, *u, 0.0]), np.array([v0, *v, 0.0])
    overlap = np.maximum(bodies[:-1] - bodies[1:] + (chosen.F0 / K) ** (2 / 3), 0.0)
    elastic, damping = K * overlap**1.5, 0.0 if law == "none" else chosen.D
    total = elastic + damping * (overlap > 0.0) * (speeds[:-1] - speeds[1:])
    w = v - damping * (overlap[:-1] - overlap[1:]) / masses
    scaled = scale_chain(chosen)
    row, scales, slots = scaled.bodies, scaled.scales, scaled.slots
    y, dy, space = np.zeros(2 * row), np.zeros(2 * row), scaled.forces()
    y[1 : row - 1], y[row + 1 : -1] = u / scales.length, w / scales.velocity
    motion.py_func(slots, u0 / scales.length, v0 / scales.velocity, y, dy, space)
    near = {"rtol": 1e-11, "atol": 1e-11 * np.abs(total).max()}  # differences of displacements lose a digit or two
    found = [contact_force.py_func(slots, y, dy, space.e, c) for c in range(row - 1)]
    np.testing.assert_allclose(np.array(found) * scales.force, total, **near)
    np.testing.assert_allclose(dy[1 : row - 1] * scales.velocity, v, atol=1e-12 * np.abs(v).max())
    np.testing.assert_allclose(masses * dy[row + 1 : -1] * scales.velocity * scales.phi,
                               elastic[:-1] - elastic[1:] - chosen.k * u, **near)
    energy = (0.4 * K * overlap**2.5).sum() + (0.5 * masses * v**2).sum() + (0.5 * chosen.k * u**2).sum()
    assert stored_energy.py_func(slots, y, dy) * scales.energy == pytest.approx(energy, rel=1e-12)


@pytest.mark.parametrize(("law", "power"), [("tsuji", 0.25), ("kuwabara-kono", 0.5)])
@pytest.mark.parametrize("A0", [5e-8, 5e-7, 7e-6])
def test_the_damping_named_by_the_knob_is_that_at_the_reference_overlap(law: str, power: float, A0: float) -> None:
    """g = D (δ/δ_ref)^p [N s/m] at every drive amplitude, whatever the unit of length."""
    chosen = scene("sec2").evolve(dissipation=law, A0=A0, D=31.0)
    scaled = scale_chain(chosen)
    unit = chosen.bead(1).mass * scaled.scales.phi  # unit of damping
    for overlap in (1e-8, 3e-6):
        found = damping(scaled.slots.dissipation, overlap / scaled.scales.length) * unit
        assert found == pytest.approx(31.0 * (overlap / chosen.reference_overlap) ** power, rel=1e-12)
