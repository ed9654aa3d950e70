"""Forces that act on single bodies from outside the chain: all of their terms that the equations need.

Equation   m_i ẇ_i = F^el_{i-1} − F^el_i + P_i(u_i, v_i),   P = −k u for a foundation
Terms      P itself; the energy stored in it; the power −P v that it dissipates; its linearisation δP = ∂P/∂u δu + ∂P/∂v
           δv for tangents; and ∂P/∂v for the trace, the growth rate of phase-space volumes, which is negative with
           damping
Each term is given the bead's number i, 1 to N, for values that differ from bead to bead. The SIMD kernels use
`force_on_bead` too, with vectors of all members of a batch, or of all beads of a chain, where i is None.
"""

from __future__ import annotations

from ..compiling.dispatch import by_slot
from ..compiling.jit import inline_llvm, internal
from ..effects.energy_account import LOST_ENERGY, EnergyAccount
from ..effects.foundation import add_foundation_force, add_foundation_slope, foundation_energy


@inline_llvm
def force_on_bead(slots, i, contacts, u, v):
    """Force on bead i at displacement u and velocity v; `contacts` is the net force of its two contacts.

    For numbers and vectors.
    """
    return add_foundation_force(slots.foundation, contacts, u)


@internal
def stored_on_bead(slots, i, u):
    """Potential energy of these forces on bead i at displacement u."""
    return foundation_energy(slots.foundation, u)


@internal
def power_lost_on_bead(slots, i, u, v):
    """Power that these forces dissipate at bead i, at displacement u and velocity v."""
    return 0.0


@inline_llvm
def add_force_slope(slots, i, slope, u, v, du, du_slope, dt_ds):
    """Add bead i's share, δP/m times dt/ds, to a tangent's slope d(δw)/ds; for numbers and vectors.

    The bead is at displacement u with velocity v, and the neighbouring motion is δu = `du` away. `dt_ds` is dt/ds, and
    `du_slope` is d(δu)/ds = δv dt/ds.
    """
    inverse_mass = slots.chain.inverse_mass[i]
    return add_foundation_slope(slots.foundation, slope, du, inverse_mass * dt_ds)


@internal
def add_force_trace(slots, i, trace, u, v, weight):
    """Add ∂P/∂v times `weight` to a sum: bead i's contribution to the trace of the equations' derivative."""
    return trace


@by_slot
def account_for_bodies(account, slots, y, dy):
    """Add the power lost by all beads to the integrand of Q, from the velocities in dy. Effect absent: nothing."""


@account_for_bodies.of(EnergyAccount)
def _(account, slots, y, dy):
    lost = 0.0
    for i in range(1, slots.chain.inverse_mass.size - 1):
        lost += power_lost_on_bead(slots, i, y[i], dy[i])
    dy[LOST_ENERGY] += lost
