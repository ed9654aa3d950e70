"""Kinks of the force in no-tension contacts: the contact stops pushing, or pushes again, while its beads still touch.

At a kink, F = K δ^{3/2} + g(δ) δ̇ = 0, and a step with error control must end there. F has the same sign as
F/g = K δ^{3/2}/g(δ) + δ̇, which, unlike F, passes through zero nowhere else, not even at δ = 0.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..compiling.dispatch import by_slot
from ..effects.dissipation import LAWS, power
from ..effects.energy_account import add_to_account, ends_of
from ..effects.preload import overlap
from ..effects.tension import TensionCut, hold_force_free
from ..equations.motion import write_w
from ..simd.functions import gate, positive_part, root
from ..status import EVALUATIONS
from .bracket import Bracket, root_inside, value_at
from .step import evaluate, prepare_dense, stages, write_dense_state

#: Outcomes of `first_kink`.
NO_KINK, KINK, WRONG_SIDE = range(3)
#: A kink closer to an end of the step than this changes the motion by less than rounding: by the square of the
#: distance.
_LEAST_DISTANCE = 1e-8
#: A contact with F/g below this part of the largest velocity is at rest ahead of a wave: the sign is rounding.
_REST_VELOCITY = 1e-15


class ScaledForce(NamedTuple):
    """F/g of a contact inside a step; evaluations are counted."""

    contact: int
    counts: np.ndarray


@by_slot
def scaled_force(law, stiffness, d, rate):
    """F/g for d = [δ]_+ and δ̇ = rate. Effect absent: positive, since an elastic contact never pulls."""
    return 1.0


@scaled_force.of(*LAWS)
def _(law, stiffness, d, rate):
    r = root(d)
    return gate(d, stiffness * d * (r / power(law, d, r)) / law.coefficient) + rate


@value_at.of(ScaledForce)
def _(quantity, step, x):
    slots, drive, _, workspace = step.trajectory
    c = quantity.contact
    write_dense_state(step, x)
    evaluate(slots, drive.beta, step.t + x * step.h, workspace.probe, workspace.slope, workspace.forces)
    quantity.counts[EVALUATIONS] += 1
    d = positive_part(overlap(slots.preload, workspace.probe, c))
    return scaled_force(slots.dissipation, slots.chain.stiffness[c], d, workspace.slope[c] - workspace.slope[c + 1])


@by_slot
def enter_force_free(tension, trajectory, t):
    """Mark the contacts that are force-free at the start of a step and evaluate the slope again.

    Effect absent: nothing.
    """


@enter_force_free.of(TensionCut)
def _(tension, trajectory, t):
    slots, drive, y, workspace = trajectory
    any_force_free = False
    for c in range(tension.force_free.size):
        d, rate = overlap(slots.preload, y, c), workspace.k[0, c] - workspace.k[0, c + 1]
        stiffness, still = slots.chain.stiffness[c], _REST_VELOCITY * workspace.scale[1]
        if d > 0.0 and scaled_force(slots.dissipation, stiffness, d, rate) < -still:
            hold_force_free(tension, slots, y, c)
            any_force_free = True
    if any_force_free:
        evaluate(slots, drive.beta, t, y, workspace.k[0], workspace.forces)


@by_slot
def leave_force_free(tension, trajectory):
    """End the force-free state of contacts: velocities stay, and w and the account use the law's own G again.

    Returns whether anything, and therefore the slope, has changed. Effect absent: no contact is force-free.
    """
    return False


@leave_force_free.of(TensionCut)
def _(tension, trajectory):
    slots, _, y, workspace = trajectory
    dy, any_force_free = workspace.k[0], False
    for c in range(tension.force_free.size):
        any_force_free = any_force_free or tension.force_free[c] != 0
    if any_force_free:
        energy_in, lost = ends_of(slots.account, slots, y, dy)
        for c in range(tension.force_free.size):
            tension.force_free[c] = 0
        write_w(slots, y, dy, workspace.forces)
        own_energy_in, own_lost = ends_of(slots.account, slots, y, dy)
        add_to_account(slots.account, y, energy_in - own_energy_in, lost - own_lost)
    return any_force_free


@by_slot
def first_kink(tension, step, until, counts, skip_wrong_side):
    """Find the first point of the accepted step, up to `until`, at which the force of a contact reaches F = 0.

    Returns (outcome, fraction):
        NO_KINK        there is none. Effect absent: always
        KINK           a contact stops pushing, or pushes again, at the fraction
        WRONG_SIDE     rounding put a contact on the wrong side of F = 0 at the start. All such contacts have changed
                       sides together, to keep a symmetric motion symmetric, and the step must be repeated; at most once
                       per step (`skip_wrong_side`), because where F is only rounding, either choice is right
    """
    return NO_KINK, 1.0


@first_kink.of(TensionCut)
def _(tension, step, until, counts, skip_wrong_side):
    slots, drive, y, workspace = step.trajectory
    first, ready, turned, k, still = 1.0, False, False, workspace.k, _REST_VELOCITY * workspace.scale[1]
    end = k[stages(workspace)]
    for c in range(slots.chain.stiffness.size):
        d0 = overlap(slots.preload, y, c)
        if not d0 > 0.0:
            continue
        free, stiffness = tension.force_free[c] != 0, slots.chain.stiffness[c]
        d1 = positive_part(overlap(slots.preload, workspace.end, c))
        f0 = scaled_force(slots.dissipation, stiffness, d0, k[0, c] - k[0, c + 1])
        f1 = scaled_force(slots.dissipation, stiffness, d1, end[c] - end[c + 1])
        if max(abs(f0), abs(f1)) < still or (until == 1.0 and free != (f1 > 0.0)):
            continue
        if not ready:
            counts[EVALUATIONS] += prepare_dense(workspace, step)
            ready = True
        force = ScaledForce(c, counts)
        if until < 1.0:
            f1 = value_at(force, step, until)
            if abs(f1) < still or free != (f1 > 0.0):
                continue
        x = 0.0
        if f0 * f1 < 0.0:  # otherwise F is rounding at the start
            x = root_inside(force, step, Bracket(0.0, until, f0, f1, 0), 0.1 * _LEAST_DISTANCE)
        if x * step.h > _LEAST_DISTANCE:
            if x < first and x * step.h < until * step.h - _LEAST_DISTANCE:
                first = x
        elif not skip_wrong_side:
            if free:
                tension.force_free[c] = 0
            else:
                hold_force_free(tension, slots, y, c)
            turned = True
    if turned:
        evaluate(slots, drive.beta, step.t, y, k[0], workspace.forces)
        return WRONG_SIDE, 0.0
    return (KINK if first < 1.0 else NO_KINK), first
