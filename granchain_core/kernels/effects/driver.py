"""The driver, body 0, with a prescribed motion.

Equation   u_0 = A sin θ,  θ = 2πft;  v_0 = β A cos θ
Source     Zhang et al. 2016, eqs. (1) and (2)
Values     amplitude (1 in scaled units, kept so that a resting driver is the same code), beta = 2πf/φ
Absent     bead 1 has nothing on its left: body 0 stands FAR away and its contact never closes
"""

from __future__ import annotations

from math import cos, sin
from typing import NamedTuple

from ..jit import by_slot, in_simd_kernels

#: Where an absent driver or wall stands, in length units: too far to touch, near enough not to overflow.
FAR = 1e30


@in_simd_kernels
class Harmonic(NamedTuple):
    """Slot of the harmonic driver."""

    amplitude: float
    beta: float


@by_slot
def driver_displacement(driver, theta):
    """u_0 at drive phase θ."""
    return -FAR


@driver_displacement.of(Harmonic)
def _(driver, theta):
    return driver.amplitude * sin(theta)


@by_slot
def driver_velocity(driver, theta):
    """v_0 at drive phase θ."""
    return 0.0


@driver_velocity.of(Harmonic)
def _(driver, theta):
    return driver.amplitude * driver.beta * cos(theta)


@by_slot
def driver_acceleration(driver, u0):
    """v̇_0 where the driver is at u_0."""
    return 0.0


@driver_acceleration.of(Harmonic)
def _(driver, u0):
    return -driver.beta * driver.beta * u0
