"""The three forces at the ends of a step and inside it, and their largest values."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..compiling.jit import inline_llvm, internal
from ..effects.contact import elastic_slope
from ..effects.dissipation import dashpot_force, dashpot_slope
from ..effects.driver import driver_acceleration
from ..equations.body_forces import force_on_bead
from ..equations.chain_in_vector import chain_values, load_row
from ..error_control.bracket import maximum_inside, value_at
from ..error_control.force_search import FORCE_SECTIONS, SEARCHED, WORTH, is_monotone, may_hold_maximum
from ..forces.largest import cubic_top, update_largest
from ..forces.peaks import row_of
from ..simd.functions import positive_part
from ..simd.vector import at, blank, from_left, from_right, load8, with_first
from ..status import EVALUATIONS
from .chain import Point, no_transform, rates_at
from .step import point_inside


class EndForces(NamedTuple):
    """The three forces at one end of a step, and their slopes."""

    values: tuple[float, float, float]
    slopes: tuple[float, float, float]


class PreparedStep(NamedTuple):
    """A step whose dense output is in the workspace."""

    slots: Any
    work: Any


class ForceInside(NamedTuple):
    """Input, output or elastic output force (0, 1, 2) inside a step; evaluations are counted."""

    number: int
    counts: np.ndarray


@inline_llvm
def forces_at_ends(dissipation, rates, last):
    """Input, output and elastic output force."""
    elastic = at(rates.elastic, last)
    return (at(rates.elastic, 0) + dashpot_force(dissipation, at(rates.overlap, 0), at(rates.rate, 0)),
            elastic + dashpot_force(dissipation, at(rates.overlap, last), at(rates.rate, last)), elastic)


@inline_llvm
def end_forces(values, driver, point, rates, last):
    """The three forces at a point, and their slopes in t."""
    law, d = values.slots.dissipation, positive_part(rates.overlap)
    force = rates.elastic + dashpot_force(law, rates.overlap, rates.rate)
    net_force = force_on_bead(values.slots, None, from_left(blank(force), force) - force, point.u, rates.du)
    acceleration = with_first(values.inverse_mass * net_force, driver_acceleration(driver, at(point.u, 0)))
    elastic_rises = elastic_slope(values.stiffness, d) * rates.rate
    rises = elastic_rises + dashpot_slope(law, d, rates.rate,
                                          acceleration - from_right(acceleration, blank(acceleration)))
    return EndForces((at(force, 0), at(force, last), at(rates.elastic, last)),
                     (at(rises, 0), at(rises, last), at(elastic_rises, last)))


@inline_llvm
def in_xi(forces, dt_dxi):
    """The same forces, with slopes in ξ instead of t; dt/dξ is `dt_dxi`."""
    a, b, c = forces.slopes
    return EndForces(forces.values, (dt_dxi * a, dt_dxi * b, dt_dxi * c))


@internal
def forces_inside(slots, work, x, counts):
    """The three forces at fraction x of the step."""
    values, kept, width = chain_values(work.chain, slots), work.start, work.chain.width
    start = Point(load_row(width, kept.u, 0), load_row(width, kept.w, 0), load8(kept.q, 0), load8(kept.t, 0))
    rates = rates_at(values, slots.driver, no_transform(values, load_row(width, work.closed, 0)),
                     point_inside(work, start, x))
    counts[EVALUATIONS] += 1
    return forces_at_ends(slots.dissipation, rates, slots.chain.stiffness.size - 1)


@value_at.of(ForceInside)
def _(quantity, step, x):
    return forces_inside(step.slots, step.work, x, quantity.counts)[quantity.number]


@inline_llvm
def may_exceed(start, end, h, peaks):
    """Raise the largest forces to those at both ends of a step h in ξ; return whether a larger one may lie inside."""
    exceeds = False
    for q in range(3):
        update_largest(peaks, row_of(q), max(start.values[q], end.values[q]))
        exceeds = exceeds or (max(start.values[q], end.values[q]) > SEARCHED * peaks[row_of(q)] and not is_monotone(
            start.values[q], start.slopes[q], end.values[q], end.slopes[q], h))
    return exceeds


@internal
def search_forces(slots, work, start, end, until, h, out):
    """Raise the largest forces to those inside the step up to fraction `until`; h is the size of that part."""
    peaks = out.log.peaks
    middle = forces_inside(slots, work, 0.5 * until, out.counts)
    for q in range(3):
        update_largest(peaks, row_of(q), middle[q])
        guess = max(middle[q], cubic_top(start.values[q], start.slopes[q], end.values[q], end.slopes[q], h))
        turns = may_hold_maximum(start.values[q], start.slopes[q], middle[q], end.values[q], end.slopes[q])
        if turns and guess > WORTH * peaks[row_of(q)]:
            _, top = maximum_inside(ForceInside(q, out.counts), PreparedStep(slots, work), until, FORCE_SECTIONS)
            update_largest(peaks, row_of(q), top)
