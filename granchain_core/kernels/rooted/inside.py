"""Quantities inside a step on its dense output: overlaps, the root of one, the time; and the largest forces."""

from __future__ import annotations

from typing import NamedTuple

from ..dop853.force_search import is_monotone
from ..effects.contact import elastic_slope, positive_part
from ..effects.dissipation import dashpot_force, dashpot_slope
from ..effects.driver import driver_acceleration
from ..effects.foundation import add_foundation_force
from ..effects.preload import overlap
from ..forces.largest import cubic_top, reach
from ..forces.peaks import row_of
from ..jit import inline_llvm, internal
from ..rk4.short_chain import chain_values, load_row
from ..simd.vector import at, blank, from_left, from_right, load, with_first
from ..status import EVALUATIONS
from .chain import ROOT, TIME, Point, point_inside, rates_at, time_variable

#: A fraction of the step is found when it changes by less than this; the next change would be far smaller.
_FOUND = 1e-9
#: Golden sections around a maximum of a force, as in dop853/force_search.py, and around a turning point of a distance.
_SECTIONS, _TURN_SECTIONS = 24, 40
#: Factor by which a golden section shrinks the bracket.
_RATIO = 0.6180339887498949
#: Steps whose ends are below the first part of the largest force so far, and maxima below the second, are not searched.
_SEARCHED, _WORTH = 0.3, 0.98


class EndForces(NamedTuple):
    """The three forces at one end of a step, and their slopes in t."""

    values: tuple[float, float, float]
    slopes: tuple[float, float, float]


@internal
def take_distance(slots, work, contact, chosen, sign):
    """Make the overlap of a contact, or q if it is the one that is `chosen`, times a sign, the polynomial."""
    p, begin, dense = work.polynomial, work.begin, work.dense
    if chosen:
        p[7] = sign * begin.clock[0, ROOT]
        for k in range(7):
            p[k] = sign * dense.clock[k, ROOT]
    else:
        p[7] = sign * overlap(slots.preload, begin.u[0], contact)
        for k in range(7):
            p[k] = sign * (dense.u[k, contact] - dense.u[k, contact + 1])


@internal
def take_time(work, instant):
    """Make the time since an instant the polynomial."""
    work.polynomial[7] = work.begin.clock[0, TIME] - instant
    for k in range(7):
        work.polynomial[k] = work.dense.clock[k, TIME]


@internal
def polynomial_at(p, x):
    """The polynomial (8,) at fraction x of the step: the seven rows of a dense output, then the value at the start."""
    back = 1.0 - x
    value = (p[6] * x + p[5]) * back
    value = (value + p[4]) * x
    value = (value + p[3]) * back
    value = (value + p[2]) * x
    value = (value + p[1]) * back
    return p[7] + (value + p[0]) * x


@internal
def zero_between(p, low, high):
    """Where the polynomial passes from negative to positive: secants within a bracket, else its middle."""
    last, x, f_last, f = low, high, polynomial_at(p, low), polynomial_at(p, high)
    for _ in range(60):
        nearer = x - f * (x - last) / (f - f_last)
        if not low <= nearer <= high:
            nearer = 0.5 * (low + high)
        last, f_last, x = x, f, nearer
        f = polynomial_at(p, x)
        if f > 0.0:
            high = x
        else:
            low = x
        if f == f_last or abs(x - last) < _FOUND:
            break
    return x


@internal
def turn_of(p, sign):
    """(fraction, value) where the polynomial times `sign` is largest, if it has one maximum in the step."""
    low, high = 0.0, 1.0
    a, b = 1.0 - _RATIO, _RATIO
    fa, fb = sign * polynomial_at(p, a), sign * polynomial_at(p, b)
    for _ in range(_TURN_SECTIONS):
        if fa > fb:
            high, b, fb = b, a, fa
            a = high - _RATIO * (high - low)
            fa = sign * polynomial_at(p, a)
        else:
            low, a, fa = a, b, fb
            b = low + _RATIO * (high - low)
            fb = sign * polynomial_at(p, b)
    return 0.5 * (low + high), max(fa, fb)


@internal
def time_inside(work, x):
    """The time at fraction x of the step."""
    take_time(work, 0.0)
    return polynomial_at(work.polynomial, x)


@internal
def fraction_at(work, instant, high):
    """Fraction of the step, up to `high`, at which it is `instant`."""
    take_time(work, instant)
    if polynomial_at(work.polynomial, 0.0) >= 0.0:
        return 0.0
    if polynomial_at(work.polynomial, high) <= 0.0:
        return high
    return zero_between(work.polynomial, 0.0, high)


@internal
def change_before(p, falls, high):
    """Fraction up to `high` at which a distance becomes positive; 0 where it is so at the start, unless it `falls`.

    A contact that has just changed falls, and may be positive at the start by rounding.
    """
    low, before = 0.0, p[7]
    if before >= 0.0 and falls:
        low, lowest = turn_of(p, -1.0)
        before = -lowest
    if before >= 0.0 or low >= high:
        return 0.0
    return zero_between(p, low, high)


@inline_llvm
def forces_at_ends(dissipation, rates, last):
    """Input, output and elastic output force."""
    elastic = at(rates.elastic, last)
    return (at(rates.elastic, 0) + dashpot_force(dissipation, at(rates.overlap, 0), at(rates.rate, 0)),
            elastic + dashpot_force(dissipation, at(rates.overlap, last), at(rates.rate, last)), elastic)


@inline_llvm
def end_forces(values, driver, point, rates, last):
    """The three forces at a point, and their slopes."""
    law, d = values.dissipation, positive_part(rates.overlap)
    force = rates.elastic + dashpot_force(law, rates.overlap, rates.rate)
    net_force = add_foundation_force(values.foundation, from_left(blank(force), force) - force, point.u)
    acceleration = with_first(values.inverse_mass * net_force, driver_acceleration(driver, at(point.u, 0)))
    elastic_rises = elastic_slope(values.stiffness, d) * rates.rate
    rises = elastic_rises + dashpot_slope(law, d, rates.rate,
                                          acceleration - from_right(acceleration, blank(acceleration)))
    return EndForces((at(force, 0), at(force, last), at(rates.elastic, last)),
                     (at(rises, 0), at(rises, last), at(elastic_rises, last)))


@inline_llvm
def in_x(forces, pace):
    """Forces with their slopes in x, in which time passes at `pace`."""
    a, b, c = forces.slopes
    return EndForces(forces.values, (pace * a, pace * b, pace * c))


@internal
def forces_inside(slots, work, x, counts):
    """The three forces at fraction x of the step."""
    values, begin, width = chain_values(work.chain, slots), work.begin, work.chain.width
    start = Point(load_row(width, begin.u, 0), load_row(width, begin.w, 0), load(begin.clock, 0))
    rates = rates_at(values, slots.driver, time_variable(values, load_row(width, work.closed, 0)),
                     point_inside(work, start, x))
    counts[EVALUATIONS] += 1
    return forces_at_ends(slots.dissipation, rates, slots.chain.stiffness.size - 1)


@internal
def highest(slots, work, number, until, counts):
    """The largest value of force `number` in the step up to the fraction `until`, if it has one maximum there."""
    low, high = 0.0, until
    a, b = (1.0 - _RATIO) * until, _RATIO * until
    fa, fb = forces_inside(slots, work, a, counts)[number], forces_inside(slots, work, b, counts)[number]
    for _ in range(_SECTIONS):
        left = fa > fb
        if left:
            high, b, fb = b, a, fa
        else:
            low, a, fa = a, b, fb
        x = high - _RATIO * (high - low) if left else low + _RATIO * (high - low)
        value = forces_inside(slots, work, x, counts)[number]
        if left:
            a, fa = x, value
        else:
            b, fb = x, value
    return max(fa, fb)


@inline_llvm
def may_exceed(start, end, h, peaks):
    """Raise the largest forces to those at the two ends of h in x; whether a larger one may lie in between."""
    exceeds = False
    for q in range(3):
        reach(peaks, row_of(q), max(start.values[q], end.values[q]))
        exceeds = exceeds or (max(start.values[q], end.values[q]) > _SEARCHED * peaks[row_of(q)] and not is_monotone(
            start.values[q], start.slopes[q], end.values[q], end.slopes[q], h))
    return exceeds


@internal
def search_forces(slots, work, start, end, until, h, out):
    """Raise the largest forces to those inside the step up to the fraction `until`; h is the size of that part."""
    peaks = out.log.peaks
    middle = forces_inside(slots, work, 0.5 * until, out.counts)
    for q in range(3):
        reach(peaks, row_of(q), middle[q])
        top = max(middle[q], cubic_top(start.values[q], start.slopes[q], end.values[q], end.slopes[q], h))
        rising = start.slopes[q] > 0.0 or middle[q] > start.values[q]
        falling = end.slopes[q] < 0.0 or middle[q] > end.values[q]
        if rising and falling and top > _WORTH * peaks[row_of(q)]:
            reach(peaks, row_of(q), highest(slots, work, q, until, out.counts))
