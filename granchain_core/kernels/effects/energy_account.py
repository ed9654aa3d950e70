"""The energy account: the work of the driver and the energy that the chain loses, integrated with the motion.

Equation   Ẇ = F_{c=0} v_0,   Q̇ = Σ_c (F_c − F^el_c) δ̇_c;   W − Q − ΔE = 0
           Q is lost in the contacts and to forces from outside the chain; equations/body_forces.py adds the latter.
Method     Both integrands jump with the dashpot force. Integrated by parts, with dG = g δ̇ dt, they do not:
             W = ∫ (e_0 v_0 − G_0 v̇_0) dt + G_0 v_0
             Q = −∫ Σ_c G_c (ẇ_c − ẇ_{c+1}) dt + Σ_c G_c (δ̇_c − γ_c/2),   γ_c = δ̇_c − (w_c − w_{c+1}),
           Body 0 has w_0 = v_0. γ = −L G with a symmetric matrix L, by w = v − (G_{i−1} − G_i)/m, so that
           Σ γ_c dG_c = d(½ Σ γ_c G_c): hence the factor ½.
           The force x_c added by the tension cut does its own work, x_c δ̇_c, which is added to Q̇.
Absent     nothing is integrated: curves and settling do not need the account
"""

from __future__ import annotations

from typing import NamedTuple

from ..compiling.dispatch import by_slot
from ..compiling.jit import internal
from ..simd.functions import positive_part
from .contact import elastic_force
from .dissipation import times_primitive
from .driver import driver_acceleration
from .preload import overlap
from .tension import contact_primitive, lost_in, unless_force_free

#: Places of W and Q in the state, which they end, and of their rates in its slope.
DRIVER_WORK, LOST_ENERGY = -2, -1


class EnergyAccount(NamedTuple):
    """Slot of the energy account; its one value is always 1, since the compiler has no type for an empty tuple."""

    present: int


@by_slot
def account_rates(account, slots, y, dy, e):
    """Append the integrands of W and Q to the motion in dy, from the velocities in dy and the forces in e."""


@account_rates.of(EnergyAccount)
def _(account, slots, y, dy, e):
    bodies = slots.chain.inverse_mass.size
    acceleration = driver_acceleration(slots.driver, y[0])
    dy[bodies] = acceleration
    lost, work = 0.0, 0.0
    for c in range(e.size):
        d = positive_part(overlap(slots.preload, y, c))
        G = contact_primitive(slots.tension, slots, y, c, d)
        # the elastic energy lost by a force-free contact is added at the step's end: `lost_in`
        cut = e[c] - unless_force_free(slots.tension, c, elastic_force(slots.chain.stiffness[c], d))
        lost += cut * (dy[c] - dy[c + 1]) - times_primitive(slots.dissipation, G, dy[bodies + c] - dy[bodies + c + 1])
        if c == 0:
            work = e[0] * dy[0] - times_primitive(slots.dissipation, G, acceleration)
    dy[bodies] = 0.0
    dy[DRIVER_WORK] = work
    dy[LOST_ENERGY] = lost


@by_slot
def force_free_loss(account, slots, y, end):
    """Energy that force-free contacts lose from y to `end`. Effect absent: 0."""
    return 0.0


@force_free_loss.of(EnergyAccount)
def _(account, slots, y, end):
    return lost_in(slots.tension, slots, y, end)


@by_slot
def add_to_account(account, y, work, lost):
    """Add to the driver's work and to the lost energy in y. Effect absent: nothing."""


@add_to_account.of(EnergyAccount)
def _(account, y, work, lost):
    y[DRIVER_WORK] += work
    y[LOST_ENERGY] += lost


@internal
def account_ends(slots, y, dy):
    """Boundary terms of the integration by parts at a state, to be added to the integrals for W and Q."""
    bodies = slots.chain.inverse_mass.size
    lost, work = 0.0, 0.0
    for c in range(bodies - 1):
        G = contact_primitive(slots.tension, slots, y, c, positive_part(overlap(slots.preload, y, c)))
        left = dy[0] if c == 0 else y[bodies + c]
        approach = dy[c] - dy[c + 1]
        gamma = approach - (left - y[bodies + c + 1])
        lost += times_primitive(slots.dissipation, G, approach - 0.5 * gamma)
        if c == 0:
            work = times_primitive(slots.dissipation, G, dy[0])
    return work, lost


@by_slot
def ends_of(account, slots, y, dy):
    """`account_ends` if there is an account. Effect absent: zeros."""
    return 0.0, 0.0


@ends_of.of(EnergyAccount)
def _(account, slots, y, dy):
    return account_ends(slots, y, dy)
