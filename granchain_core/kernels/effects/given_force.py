"""A given force instead of the driver's contact: measured and sampled, or that of a chain acting on its observer.

Equation   m_1 ü_1 = F_in − F_1 − k u_1;  observer of a chain: F_in is the total force of the chain's own contact 0
Source     Zhang et al. 2016, eqs. (3) and (4)
Values     Sampled: piece (4,), the force between two samples as a cubic in the time since the first, constant term
           first; rk4/piecewise.py fills it before each piece, and the phase θ is that time.
           ObserverCoupling: the harmonic driver of the first chain, and the contact before the observer's first bead
Terms      put_given_primitive and put_given_force put the force into contact 0 (Sampled) or into the contact that the
           coupling specifies. Elastic force e_0 and G_0 are copied separately, so that in w-variables nothing jumps in
           the observer either
Methods    Sampled: fixed steps, from sample to sample. ObserverCoupling: dop853; the quadrature errors
           that split steps subtract (rk4/step.py) are not copied
Absent     nothing is prescribed
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..compiling.dispatch import by_slot
from .dissipation import copy_primitive
from .driver import (
    BODY_FAR_AWAY,
    Harmonic,
    PrescribedMotion,
    driver_acceleration,
    driver_displacement,
    driver_velocity,
    harmonic_acceleration,
    harmonic_displacement,
    harmonic_velocity,
)


class Sampled(NamedTuple):
    """Slot of a measured force on bead 1; there is no body 0."""

    piece: np.ndarray


class ObserverCoupling(NamedTuple):
    """Slot of the harmonic driver of a chain whose input force also acts on its observer, in contact `contact`."""

    amplitude: float
    beta: float
    contact: int


@driver_displacement.of(Sampled)
def _(driver, theta):
    return -BODY_FAR_AWAY


@driver_velocity.of(Sampled)
def _(driver, theta):
    # A force, not a velocity: there is no body 0, so `motion` carries it in dy[0] to `put_given_force`.
    p = driver.piece
    return p[0] + theta * (p[1] + theta * (p[2] + theta * p[3]))


@driver_acceleration.of(Sampled)
def _(driver, u0):
    return 0.0


driver_displacement.of(ObserverCoupling)(harmonic_displacement)
driver_velocity.of(ObserverCoupling)(harmonic_velocity)
driver_acceleration.of(ObserverCoupling)(harmonic_acceleration)


@by_slot
def put_given_primitive(driver, slots, y, G):
    """Copy the input force's G to the observer's contact. Effect absent: nothing."""


put_given_primitive.absent_for(Harmonic, PrescribedMotion, Sampled)


@put_given_primitive.of(ObserverCoupling)
def _(driver, slots, y, G):
    copy_primitive(slots.dissipation, G, 0, driver.contact)


@by_slot
def put_given_force(driver, dy, e):
    """Put the given force into the contact in which it acts. Effect absent: nothing."""


put_given_force.absent_for(Harmonic, PrescribedMotion)


@put_given_force.of(Sampled)
def _(driver, dy, e):
    e[0] = dy[0]
    dy[0] = 0.0


@put_given_force.of(ObserverCoupling)
def _(driver, dy, e):
    e[driver.contact] = e[0]
