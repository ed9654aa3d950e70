"""The driver, body 0, with a prescribed motion.

Equation   Harmonic: u_0 = A sin θ,  θ = 2πft;  v_0 = β A cos θ
           PrescribedMotion: u_0 = p_0 + p_1 θ + p_2 θ² between two knots, where θ is the time since the first
Source     Zhang et al. 2016, eqs. (1) and (2); chirps, tones, noise, measured motion: prescribed_drive/signal.py
Values     Harmonic: amplitude: 1 in scaled units, 0 for a driver at rest; beta = 2πf/φ
           PrescribedMotion: piece (3,), which rk4/piecewise.py fills before each piece. The velocity is linear in time,
           so that the acceleration, which the energy account needs, is constant within a piece
Absent     bead 1 has no neighbour on its left: body 0 is BODY_FAR_AWAY away and its contact never closes
"""

from __future__ import annotations

from math import cos, sin
from typing import NamedTuple

import numpy as np

from ..compiling.dispatch import by_slot
from .registry import in_simd_kernels

#: Distance of an absent driver or wall, in length units: far enough never to touch, near enough not to overflow.
BODY_FAR_AWAY = 1e30


@in_simd_kernels("rk4", "batch", "dop853_root")
class Harmonic(NamedTuple):
    """Slot of the harmonic driver."""

    amplitude: float
    beta: float


class PrescribedMotion(NamedTuple):
    """Slot of a driver with a given motion."""

    piece: np.ndarray


@by_slot
def driver_displacement(driver, theta):
    """u_0 at drive phase θ."""
    return -BODY_FAR_AWAY


@driver_displacement.of(Harmonic)
def harmonic_displacement(driver, theta):
    """A sin θ."""
    return driver.amplitude * sin(theta)


@driver_displacement.of(PrescribedMotion)
def _(driver, theta):
    p = driver.piece
    return p[0] + theta * (p[1] + theta * p[2])


@by_slot
def driver_velocity(driver, theta):
    """v_0 at drive phase θ. For a measured force (`Sampled` in given_force.py) it is the force: there is no body 0."""
    return 0.0


@driver_velocity.of(Harmonic)
def harmonic_velocity(driver, theta):
    """β A cos θ."""
    return driver.amplitude * driver.beta * cos(theta)


@driver_velocity.of(PrescribedMotion)
def _(driver, theta):
    return driver.piece[1] + 2.0 * theta * driver.piece[2]


@by_slot
def driver_acceleration(driver, u0):
    """v̇_0 of a driver at displacement u_0."""
    return 0.0


@driver_acceleration.of(Harmonic)
def harmonic_acceleration(driver, u0):
    """−β² u_0."""
    return -driver.beta * driver.beta * u0


@driver_acceleration.of(PrescribedMotion)
def _(driver, u0):
    return 2.0 * driver.piece[2]
