"""No tension: the contact force is cut at zero while the contact opens.

Equation   F = max(0, K δ^{3/2} + g(δ) δ̇)   for δ > 0
Source     the alternative to the paper's law, in which the gated dashpot pulls while the contact opens
Terms      cut_tension adds what is missing to F ≥ 0 to the elastic forces, contact by contact, so that the
           w-equation m ẇ = Σ e stays the one place where forces act
"""

from __future__ import annotations

from typing import NamedTuple

from ..jit import term
from .contact import positive_part
from .dissipation import damping
from .preload import overlap


class NoTension(NamedTuple):
    """Slot of the cut; it has no values."""

    present: int


@term
def cut_tension(tension, slots, y, dy, e):
    """Raise e[c] so that e[c] + g δ̇ ≥ 0; needs the velocities in dy. Absent: tension is allowed."""


@cut_tension.of(NoTension)
def _(tension, slots, y, dy, e):
    for c in range(e.size):
        d = positive_part(overlap(slots.preload, y, c))
        force = e[c] + damping(slots.dissipation, d) * (dy[c] - dy[c + 1])
        if force < 0.0:
            e[c] -= force
