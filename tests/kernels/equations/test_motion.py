"""The right-hand side in w is equivalent to the paper's (u, v) equations for every law, tension, foundation, preload
and wall.
"""

from __future__ import annotations

import itertools

import numpy as np
import pytest
import uv_equations as equations
from chains import LAWS

from granchain_core import scene
from granchain_core.integrate.scaling import scale_chain
from granchain_core.kernels.compiling.jit import kernel
from granchain_core.kernels.equations.motion import contact_force, evaluate_at_phase, motion

#: law, tension, kappa, preload, wall: all structures, with every wall several times
CASES = [(law, tension, kappa, preload, wall)
         for (law, tension, kappa, preload), wall in zip(
             itertools.product(LAWS, ("allowed", "cut"), (0.0, 0.002), (0.0, 3.0)),
             itertools.cycle(("rigid", "bead", "same-material", 0.3)), strict=False)]


@kernel
def compiled_motion(slots, u0, v0, y, dy, forces):
    """Evaluate the motion, compiled as in kernels."""
    motion(slots, u0, v0, y, dy, forces)


@kernel
def compiled_force(slots, y, dy, e, c):
    """Evaluate a contact's force, compiled as in kernels."""
    return contact_force(slots, y, dy, e, c)


def evaluated(chosen, u, v, time, compiled=True):
    """Return the kernel's (scaled chain, θ, state, slope, total forces), in scaled units, for displacements and
    velocities (N,) in SI units.

    With `compiled=False`, Python runs the same source: dozens of structures would take a minute to compile.
    """
    slope_of, force = (compiled_motion, compiled_force) if compiled else (motion, contact_force)
    scaled = scale_chain(chosen)
    row, scales, slots = scaled.bodies, scaled.scales, scaled.slots
    y, dy, space = np.zeros(2 * row), np.zeros(2 * row), scaled.forces()
    y[1 : row - 1], y[row + 1 : -1] = u / scales.length, v / scales.velocity
    theta = 2 * np.pi * chosen.f * time
    drive = np.sin(theta), scaled.beta * np.cos(theta)
    slope_of(slots, *drive, y, dy, space)
    if space.G is not None:  # w = v − (G_left − G_right)/m
        y[row + 1 : -1] -= slots.chain.inverse_mass[1:-1] * (space.G[:-1] - space.G[1:])
    slope_of(slots, *drive, y, dy, space)
    return scaled, theta, y, dy, np.array([force(slots, y, dy, space.e, c) for c in range(row - 1)])


def random_state(chosen, seed: int):
    """Return displacements and velocities with which some contacts are open and others closed."""
    rng = np.random.default_rng(seed)
    length = 2 * chosen.A0 + float(chosen.static_overlap().max())
    speed = 3e-2 * np.sqrt(length / 1e-6)  # fast enough for a dashpot to pull
    return rng.uniform(-1, 1, chosen.N) * length, rng.uniform(-1, 1, chosen.N) * speed


@pytest.mark.parametrize(("law", "tension", "kappa", "preload", "wall"), CASES)
def test_forces_velocities_and_accelerations_are_those_of_the_paper(law, tension, kappa, preload, wall):
    """Contact forces, du/dt = v and d²u/dt² are those of the (u, v) equations; the slope of w contains only elastic
    forces.
    """
    chosen = scene("sec2").evolve(N=5, dissipation=law, tension=tension, kappa=kappa, F0=preload, wall=wall, f=400.0)
    for seed in range(6):
        u, v = random_state(chosen, seed)
        time = 0.13 / chosen.f
        compiled = tension == "allowed" and kappa == 0.0
        scaled, theta, y, dy, total = evaluated(chosen, u, v, time, compiled)
        scales = scaled.scales
        expected, elastic = equations.forces(chosen, u, v, time)
        # both formulas are in double precision; differences of displacements lose a digit or two
        near = {"rtol": 1e-11, "atol": 1e-11 * max(np.abs(expected))}
        np.testing.assert_allclose(total * scales.force, expected, **near)
        np.testing.assert_allclose(dy[1 : chosen.N + 1] * scales.velocity, v, rtol=1e-12, atol=1e-12 * np.abs(v).max())
        m = chosen.bead(1).mass
        slope = dy[chosen.N + 3 : -1] * scales.length * scales.phi**2
        if tension == "allowed":
            only_elastic = [(elastic[i] - elastic[i + 1] - chosen.k * u[i]) / m for i in range(chosen.N)]
            np.testing.assert_allclose(slope, only_elastic, rtol=1e-11, atol=1e-11 * np.abs(only_elastic).max())
        assert acceleration_from_w(scaled, theta, y, compiled) * scales.length * scales.phi**2 == pytest.approx(
            equations.acceleration(chosen, u, v, time), rel=2e-9, abs=2e-9 * max(np.abs(expected)) / m)


def acceleration_from_w(scaled, theta, y, compiled, step=1e-6):
    """Return d²u/dτ² as the change of du/dτ along the flow: a central difference of the kernel's own velocities.

    Its errors are of order (step·rate)² and rounding/step, since the contacts' kinks are further away than the step: up
    to 2e-10 of the largest acceleration here.
    """
    row, space = scaled.bodies, scaled.forces()
    slope = np.zeros_like(y)
    slope_of = compiled_motion if compiled else motion
    slope_of(scaled.slots, y[0], scaled.slots.driver.beta * np.cos(theta), y.copy(), slope, space)
    velocities = []
    for sign in (1.0, -1.0):
        moved, there = y + sign * step * slope, np.zeros_like(y)
        angle = theta + sign * step * scaled.slots.driver.beta
        slope_of(scaled.slots, np.sin(angle), scaled.slots.driver.beta * np.cos(angle), moved, there, space)
        velocities.append(there[1 : row - 1])
    return (velocities[0] - velocities[1]) / (2 * step)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("preload", [0.0, 3.0])
@pytest.mark.parametrize("where", [1, 3, 5])
def test_a_nan_in_a_bead_reaches_both_its_contacts(law, preload, where):
    """A NaN displacement gives NaN forces and slopes next to it: it never acts as a mere gap in the chain."""
    chosen = scene("sec2").evolve(N=5, dissipation=law, F0=preload)
    u, v = random_state(chosen, 0)
    u[where - 1] = np.nan
    _, _, _, dy, total = evaluated(chosen, u, v, 0.1 / chosen.f)
    assert np.isnan(total[where - 1])
    assert np.isnan(total[where])
    assert np.isnan(dy[chosen.N + 2 + where])


def test_rest_without_overlap_is_an_equilibrium_and_preload_keeps_it_one():
    """With the driver in its middle position, nothing moves. Without preload there is no force, with it F0 everywhere.
    """
    for preload in (0.0, 7.0):
        chosen = scene("sec2").evolve(F0=preload, D=0.0, wall="rigid")
        scaled, _, _, dy, total = evaluated(chosen, np.zeros(11), np.zeros(11), 0.0)
        np.testing.assert_allclose(total * scaled.scales.force, preload, rtol=1e-14)  # rounding of (F0/K)^{2/3·3/2}
        np.testing.assert_allclose(dy[scaled.bodies + 1 : -1], 0.0, atol=1e-13)  # relative to forces of order one


@pytest.mark.parametrize("law", LAWS)
def test_a_velocity_is_converted_to_w_and_back(law):
    """`evaluate_at_phase` converts v into w = v − (G_left − G_right)/m, and the first half of the slope is v again."""
    chosen = scene("sec2").evolve(N=5, dissipation=law)
    u, v = random_state(chosen, 1)
    scaled, theta, expected, _, _ = evaluated(chosen, u, v, 0.2 / chosen.f)
    y, dy = expected.copy(), np.zeros_like(expected)
    y[scaled.bodies + 1 : -1] = v / scaled.scales.velocity
    evaluate_at_phase(scaled.slots, theta, y, dy, scaled.forces(), True)
    np.testing.assert_allclose(y, expected, atol=1e-14 * np.abs(expected).max())  # the same sums, rounded
    np.testing.assert_allclose(dy[1:6], v / scaled.scales.velocity, atol=1e-14 * np.abs(expected).max())
