"""The driver, body 0, with a prescribed motion.

Equation   u_0 = A sin θ,  θ = 2πft;  v_0 = β A cos θ
Source     Zhang et al. 2016, eqs. (1) and (2)
Values     amplitude: 1 in scaled units, 0 for a driver at rest; beta = 2πf/φ
Absent     bead 1 has nothing on its left: body 0 stands BODY_FAR_AWAY away and its contact never closes
"""

from __future__ import annotations

from math import cos, sin
from typing import NamedTuple

from ..jit import by_slot, in_simd_kernels

#: Where an absent driver or wall stands, in length units: too far to touch, near enough not to overflow.
BODY_FAR_AWAY = 1e30


@in_simd_kernels
class Harmonic(NamedTuple):
    """Slot of the harmonic driver."""

    amplitude: float
    beta: float


@by_slot
def driver_displacement(driver, theta):
    """u_0 at drive phase θ."""
    return -BODY_FAR_AWAY


@driver_displacement.of(Harmonic)
def harmonic_displacement(driver, theta):
    """A sin θ."""
    return driver.amplitude * sin(theta)


@by_slot
def driver_velocity(driver, theta):
    """v_0 at drive phase θ."""
    return 0.0


@driver_velocity.of(Harmonic)
def harmonic_velocity(driver, theta):
    """β A cos θ."""
    return driver.amplitude * driver.beta * cos(theta)


@by_slot
def driver_acceleration(driver, u0):
    """v̇_0 where the driver is at u_0."""
    return 0.0


@driver_acceleration.of(Harmonic)
def harmonic_acceleration(driver, u0):
    """−β² u_0."""
    return -driver.beta * driver.beta * u0
