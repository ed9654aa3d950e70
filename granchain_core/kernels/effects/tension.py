"""The tension cut: the contact force is cut at zero while the contact opens.

Equation   F = max(0, K δ^{3/2} + g(δ) δ̇)   for δ > 0
Source     an alternative to the paper's law, in which the gated dashpot pulls while the contact opens
Values     force_free (N+1,): 1 for a contact that touches without force throughout the present step, otherwise 0; its G
           is then offset + slope·δ, both (N+1,)
Terms      cut_tension raises an elastic force just enough to make a negative total zero, so that forces still enter in
           one place, m ẇ = Σ e
Force-free With the linear law, the added force −g(δ)δ̇ is finite just before δ = 0 and zero just after; with Tsuji's,
           its slope is infinite there. So for one step, G is replaced by its tangent at the step's start, which is
           smooth at δ = 0. At the step's end, w is recomputed with the law's own G (`leave_force_free`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..compiling.dispatch import by_slot
from ..compiling.jit import internal
from ..simd.functions import positive_part
from .contact import elastic_energy
from .dissipation import damping, dashpot_force, primitive, put_primitive
from .preload import overlap


class TensionCut(NamedTuple):
    """Slot of the cut; its arrays describe the force-free contacts."""

    force_free: np.ndarray
    slope: np.ndarray
    offset: np.ndarray


def new_tension_cut(contacts: int) -> TensionCut:
    """Return the slot for this number of contacts, none of them force-free."""
    return TensionCut(np.zeros(contacts, dtype=np.uint8), np.zeros(contacts), np.zeros(contacts))


@internal
def hold_force_free(tension, slots, y, c):
    """Mark contact c, which touches without force in state y, as force-free for one step."""
    d = positive_part(overlap(slots.preload, y, c))
    tension.force_free[c] = 1
    tension.slope[c] = damping(slots.dissipation, d)
    tension.offset[c] = primitive(slots.dissipation, d) - tension.slope[c] * d


@by_slot
def contact_primitive(tension, slots, y, c, d):
    """G of contact c, whose overlap is d while it touches. Effect absent: the law's own G."""
    return primitive(slots.dissipation, d)


@contact_primitive.of(TensionCut)
def _(tension, slots, y, c, d):
    if tension.force_free[c] != 0:
        return tension.offset[c] + tension.slope[c] * overlap(slots.preload, y, c)
    return primitive(slots.dissipation, d)


@by_slot
def write_force_free_primitive(tension, slots, y, G):
    """Continue G of force-free contacts linearly, also below δ = 0. Effect absent: no contact is force-free."""


@write_force_free_primitive.of(TensionCut)
def _(tension, slots, y, G):
    for c in range(tension.force_free.size):
        if tension.force_free[c] != 0:
            put_primitive(slots.dissipation, G, c, contact_primitive(tension, slots, y, c, 0.0))


@by_slot
def cut_tension(tension, slots, y, dy, e):
    """Raise e[c] so that e[c] + g δ̇ ≥ 0; needs the velocities in dy. Effect absent: tension is allowed."""


@cut_tension.of(TensionCut)
def _(tension, slots, y, dy, e):
    for c in range(e.size):
        rate = dy[c] - dy[c + 1]
        if tension.force_free[c] != 0:
            e[c] = -tension.slope[c] * rate
        else:
            damped = dashpot_force(slots.dissipation, overlap(slots.preload, y, c), rate)
            if e[c] + damped < 0.0:
                e[c] = -damped


@by_slot
def cut_at_zero(tension, force):
    """A contact's force, cut at zero. Effect absent: the force unchanged, since tension is allowed."""
    return force


@cut_at_zero.of(TensionCut)
def _(tension, force):
    return max(force, 0.0)


@by_slot
def unless_force_free(tension, c, force):
    """The force of contact c, or 0 where it is force-free. Effect absent: no contact is force-free."""
    return force


@unless_force_free.of(TensionCut)
def _(tension, c, force):
    return 0.0 if tension.force_free[c] != 0 else force


@by_slot
def lost_in(tension, slots, y, end):
    """Elastic energy that force-free contacts lose from y to `end`, without quadrature. Effect absent: 0."""
    return 0.0


@lost_in.of(TensionCut)
def _(tension, slots, y, end):
    lost = 0.0
    for c in range(tension.force_free.size):
        if tension.force_free[c] != 0:
            stiffness = slots.chain.stiffness[c]
            lost += elastic_energy(stiffness, positive_part(overlap(slots.preload, y, c)))
            lost -= elastic_energy(stiffness, positive_part(overlap(slots.preload, end, c)))
    return lost
