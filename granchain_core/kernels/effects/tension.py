"""No tension: the contact force is cut at zero while the contact opens.

Equation   F = max(0, K δ^{3/2} + g(δ) δ̇)   for δ > 0
Source     the alternative to the paper's law, in which the gated dashpot pulls while the contact opens
Values     slack (N+1,): 1 for a contact that touches without force throughout the present step, else 0
Terms      cut_tension adds what is missing to F ≥ 0 to the elastic forces, contact by contact, so that the
           w-equation m ẇ = Σ e stays the one place where forces act
Slack      Of the paper's dashpot G = λδ ends with a kink and what is added, −λδ̇, with a jump at δ = 0, though the force
           is zero before and after. Both are gone on with through δ = 0 in a step that begins slack: the force stays
           zero, and the step has no kink to see.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..jit import term
from .contact import elastic_energy, positive_part
from .dissipation import damping, keep_primitive
from .preload import overlap


class NoTension(NamedTuple):
    """Slot of the cut."""

    slack: np.ndarray


@term
def keep_slack_primitive(tension, slots, y, G):
    """Let G of slack contacts go on below δ = 0. Absent: no contact is slack."""


@keep_slack_primitive.of(NoTension)
def _(tension, slots, y, G):
    for c in range(tension.slack.size):
        if tension.slack[c] != 0:
            keep_primitive(slots.dissipation, G, c, overlap(slots.preload, y, c))


@term
def cut_tension(tension, slots, y, dy, e):
    """Raise e[c] so that e[c] + g δ̇ ≥ 0; needs the velocities in dy. Absent: tension is allowed."""


@cut_tension.of(NoTension)
def _(tension, slots, y, dy, e):
    for c in range(e.size):
        slack = tension.slack[c] != 0
        d = 1.0 if slack else positive_part(overlap(slots.preload, y, c))  # a slack contact's g is no function of δ
        damped = damping(slots.dissipation, d) * (dy[c] - dy[c + 1])
        if slack or e[c] + damped < 0.0:
            e[c] = -damped


@term
def slack_overlap(tension, slots, y, c, d):
    """The overlap that G of contact c belongs to. Absent: [δ]_+, which is d."""
    return d


@slack_overlap.of(NoTension)
def _(tension, slots, y, c, d):
    return overlap(slots.preload, y, c) if tension.slack[c] != 0 else d


@term
def not_yet_lost(tension, c, elastic):
    """The part of contact c's elastic force whose work counts as it is done. Absent: all of it."""
    return elastic


@not_yet_lost.of(NoTension)
def _(tension, c, elastic):
    return 0.0 if tension.slack[c] != 0 else elastic  # what a slack contact loses is known at the step's end: `lost_in`


@term
def lost_in(tension, slots, y, end):
    """Energy that slack contacts lose from y to `end`: their elastic energy, no quadrature. Absent: none is slack."""
    return 0.0


@lost_in.of(NoTension)
def _(tension, slots, y, end):
    lost = 0.0
    for c in range(tension.slack.size):
        if tension.slack[c] != 0:
            stiffness = slots.chain.stiffness[c]
            lost += elastic_energy(stiffness, positive_part(overlap(slots.preload, y, c)))
            lost -= elastic_energy(stiffness, positive_part(overlap(slots.preload, end, c)))
    return lost


@term
def let_go(tension, slots, y):
    """Contacts that are open in state y are not slack but open. Absent: no contact is slack."""


@let_go.of(NoTension)
def _(tension, slots, y):
    for c in range(tension.slack.size):
        if not overlap(slots.preload, y, c) > 0.0:
            tension.slack[c] = 0
