"""Periodicity of stroboscopic states: their changes, the factor by which these shrink, the shortest period.

These functions are called thousands of times for a curve.

States are rows (P, 2, N) of displacement and velocity, or of displacement and w, one per drive period. Changes of
displacements are relative to the largest displacement in the record, changes of velocities (or w) to the largest
velocity (or w).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..compiling.jit import inline_llvm, internal, kernel

#: [period n, followed, quasi-periodic] Longest period for which a batch tests, in drive periods, and longest period of
#: an orbit searched for near a motion, in a batch or alone. Chains with a longer period are settled alone.
LONGEST_PERIOD = 16
#: [period n] Fewest changes from which a contraction factor is computed.
LEAST_WINDOW = 8
#: [period n] A state is on its orbit if the bound on its distance, relative to the largest displacement and velocity,
#: is at most this.
SETTLED_DISTANCE = 1e-6
#: [period n] Changes of a fixed-step map at most this large count as rounding.
ROUNDING = 1e-12
#: [period n] A state is not settled if its last change over n periods is larger. Nothing decays a thousandfold in one
#: period.
_LARGEST_SETTLED_CHANGE = 1e-3
#: [period n] If the bound on the distance is below this part of the required bound, the contraction need not be steady.
#: A hidden slow mode would have to decay a hundred times more slowly than the observed changes.
_UNEVEN_PART = 1e-2
#: [period n] A contraction factor is steady if those of both halves of its window agree to this part of the larger one.
_STEADY_PART = 0.2
#: [period n] Where the last changes are rounding, the contraction factor is computed from changes above this many times
#: rounding.
_ABOVE_ROUNDING = 1e3
#: [period n] A divisor q of n is the period if changes over q are at most this factor times the bound on the distance …
_DISTANCES_OVER_DIVISOR = 10.0
#: [period n] … or at most this factor times the required bound.
_SETTLED_OVER_DIVISOR = 3.0
#: [period n] Changes over q periods that decay more slowly than this, per q periods, may be those of a longer orbit.
#: Faster ones vanish.
_SLOWEST_APPROACH = 0.97
#: [period n] A period is tested for, and in a batch extrapolated to, once the change over it is below this.
_LARGEST_EXTRAPOLATED_CHANGE = 1e-2

#: [all] Without |μ|, a distance is assumed to shrink by the observed contraction factor, but at most by this: the
#: largest factor that a batch reports. A larger one would make stated errors larger still.
LARGEST_TRUSTED_CONTRACTION = 0.9999
#: [all] Where no contraction was observed, a distance is assumed to shrink by this factor.
CONTRACTION_NOT_SEEN = 0.5


@internal
def assumed_contraction(observed):
    """Factor by which a distance is assumed to shrink per orbit, from the observed factor, ≤ 0 if none was seen."""
    return min(LARGEST_TRUSTED_CONTRACTION, observed) if observed > 0.0 else CONTRACTION_NOT_SEEN


class Detected(NamedTuple):
    """The evidence in a record of strobes: an orbit, or the approach to one.

    If `period` > 0, the motion has that period: `contraction` is the factor by which changes shrink per orbit, −1 if
    none was seen, and `distance` bounds the remaining distance to the orbit. Otherwise `period` is 0, `approached` is
    the first period over which changes shrink (0 for none), `approach_contraction` is their factor per `approached`
    drive periods, and `approach_change` is the latest change.
    """

    period: int
    contraction: float
    distance: float
    approached: int
    approach_contraction: float
    approach_change: float


@internal
def largest_in(strobes, q):
    """Largest displacement or velocity (q) of a record."""
    a, b = 0.0, 0.0  # two, so that neither waits for the previous one
    for p in range(strobes.shape[0]):
        row = strobes[p, q]
        for i in range(0, row.size - 1, 2):
            a, b = max(a, abs(row[i])), max(b, abs(row[i + 1]))
        a = max(a, abs(row[row.size - 1]))
    return max(a, b)


@internal
def write_scale(strobes, scale):
    """Write the largest displacement and velocity of a record into `scale` (2,); 1 where they are zero."""
    for q in range(2):
        largest = largest_in(strobes, q)
        scale[q] = largest if largest > 0.0 else 1.0


@inline_llvm
def change_in(strobes, q, now, then):
    """Largest change of displacements or velocities (q) from state `then` to state `now`."""
    a, b, c, d = 0.0, 0.0, 0.0, 0.0  # four, so that none waits for the previous one
    beads = strobes.shape[2]
    for i in range(0, beads - 3, 4):
        a = max(a, abs(strobes[now, q, i] - strobes[then, q, i]))
        b = max(b, abs(strobes[now, q, i + 1] - strobes[then, q, i + 1]))
        c = max(c, abs(strobes[now, q, i + 2] - strobes[then, q, i + 2]))
        d = max(d, abs(strobes[now, q, i + 3] - strobes[then, q, i + 3]))
    for i in range(beads - beads % 4, beads):
        a = max(a, abs(strobes[now, q, i] - strobes[then, q, i]))
    return max(max(a, b), max(c, d))


@internal
def change_between(strobes, scale, now, then):
    """Largest relative change from state `then` to state `now`."""
    return max(change_in(strobes, 0, now, then) / scale[0], change_in(strobes, 1, now, then) / scale[1])


@internal
def changes_before(strobes, scale, n, end, out):
    """Write the last out.size changes over n periods up to state `end` into `out`, oldest first."""
    for k in range(out.size):
        now = end - out.size + 1 + k
        out[k] = change_between(strobes, scale, now, now - n)


@internal
def largest_change(change, first, count):
    """Largest of `count` changes from `first` on."""
    largest = 0.0
    for k in range(first, first + count):
        largest = max(largest, change[k])
    return largest


@internal
def contraction_in(change, count, n):
    """Return the factor per n drive periods by which `count` changes shrink, and whether both halves of them agree.

    The largest changes over one orbit at the window's start, middle and end are compared, so that the rotation of
    complex multipliers does not look like decay or growth. The slower half counts.
    """
    first = largest_change(change, 0, n)
    middle = largest_change(change, (count - n) // 2, n)
    last = largest_change(change, count - n, n)
    if min(first, middle, last) <= 0.0:
        return 0.0, True
    power = 2.0 * n / (count - n)
    early, late = (middle / first) ** power, (last / middle) ** power
    contraction = max(early, late)
    return contraction, abs(early - late) < _STEADY_PART * contraction


@internal
def window_of(n):
    """Number of changes from which a contraction factor over n periods is computed."""
    return max(LEAST_WINDOW, 3 * n)


@internal
def shortest(strobes, scale, n, distance, settled):
    """The shortest divisor of n over which these states hardly change; `distance` bounds theirs from the orbit."""
    run, negligible = strobes.shape[0] - 1, max(_DISTANCES_OVER_DIVISOR * distance, _SETTLED_OVER_DIVISOR * settled)
    for q in range(1, n):
        if n % q != 0:
            continue
        largest = 0.0
        for k in range(n):
            largest = max(largest, change_between(strobes, scale, run - k, run - k - q))
        if largest <= negligible:
            return q
    return n


@internal
def earlier_contraction(strobes, scale, n, rounding, change):
    """The contraction factor over n periods from the record's last part well above rounding; −1 if there is none."""
    end, count = strobes.shape[0] - 1, window_of(n)
    while end >= n and change_between(strobes, scale, end, end - n) <= _ABOVE_ROUNDING * rounding:
        end -= 1
    if end < count + n - 1:
        return -1.0
    changes_before(strobes, scale, n, end, change[:count])
    contraction, _ = contraction_in(change, count, n)
    return contraction if 0.0 < contraction < 1.0 else -1.0


@kernel
def detect_period(strobes, longest, rounding, settled, slowest, scale, change):
    """Find the shortest period of a record of strobes and the contraction towards it, as `Detected`.

    It is the smallest period with a distance bound change·c/(1 − c) of at most `settled`, where c is the contraction
    factor; changes below `rounding` count as zero. `slowest` is a contraction factor per drive period that is known to
    occur, whether or not these states show it. `scale` (2,) and `change` (`window_of(longest)` or more,) are
    workspaces.
    """
    run = strobes.shape[0] - 1
    write_scale(strobes, scale)
    approaching, approached, approach_contraction, approach_change = 0, 0, 0.0, 0.0
    for n in range(1, longest + 1):
        count = window_of(n)
        if run < count + n:
            break
        nearer = False
        for q in range(1, n):
            nearer = nearer or (approaching >> q & 1 == 1 and n % q == 0)
        now = change_between(strobes, scale, run, run - n)
        if nearer:
            continue  # the change over n is small because a shorter period is being approached
        if now > _LARGEST_EXTRAPOLATED_CHANGE:
            continue  # still far from an orbit of n periods: the contraction is meaningless
        changes_before(strobes, scale, n, run, change[:count])
        if largest_change(change, 0, count) <= rounding:
            q = shortest(strobes, scale, n, rounding, settled)
            return Detected(q, earlier_contraction(strobes, scale, q, rounding, change), rounding, 0, 0.0, 0.0)
        contraction, even = contraction_in(change, count, n)
        recent = largest_change(change, count - n, n)
        if contraction >= 1.0:
            continue
        if approached == 0:
            approached, approach_contraction, approach_change = n, contraction, recent
        if now > _LARGEST_SETTLED_CHANGE:
            continue
        if contraction < _SLOWEST_APPROACH:
            approaching |= 1 << n
        contraction = max(contraction, slowest**n)
        distance = recent * contraction / (1.0 - contraction)
        if distance <= settled and (even or recent <= _UNEVEN_PART * settled):
            q = shortest(strobes, scale, n, distance, settled)
            return Detected(q, contraction ** (q / n), distance, 0, 0.0, 0.0)
    return Detected(0, 0.0, 0.0, approached, approach_contraction, approach_change)


@internal
def first_above(strobes, order, value):
    """Index into `order` of the first state whose first bead is displaced by more than `value`."""
    low, high = 0, order.size
    while low < high:
        middle = (low + high) // 2
        if strobes[order[middle], 0, 0] > value:
            high = middle
        else:
            low = middle + 1
    return low


@kernel
def nearest_neighbours(strobes, order, scale, nearest):
    """Compute the distance of every state in the later half of a record from the nearest state in the earlier half.

    `order` lists the states of the earlier half by the displacement of their first bead. The search goes in both
    directions from the state's own place in this order, until this displacement alone differs by more than the distance
    found.
    """
    write_scale(strobes, scale)
    half = order.size
    for p in range(nearest.size):
        nearest[p], own = np.inf, strobes[half + p, 0, 0]
        place = first_above(strobes, order, own)
        for step in (-1, 1):
            k = place - 1 if step < 0 else place
            while 0 <= k < half and abs(strobes[order[k], 0, 0] - own) < nearest[p] * scale[0]:
                distance = change_in(strobes, 0, half + p, order[k]) / scale[0]
                if distance < nearest[p]:  # otherwise the velocities do not matter
                    nearest[p] = min(nearest[p], max(distance, change_in(strobes, 1, half + p, order[k]) / scale[1]))
                k += step


@kernel
def record_changes(strobes, n, scale, out):
    """Write the last out.size changes over n periods of a record into `out`, oldest first."""
    write_scale(strobes, scale)
    changes_before(strobes, scale, n, strobes.shape[0] - 1, out)


@internal
def raise_changes(largest, now, then):
    """Raise the first elements of `largest` to the changes from `then` to `now`, which have the same length."""
    for j in range(now.size):
        change = abs(now[j] - then[j])
        largest[j] = change if change > largest[j] else largest[j]


@kernel
def window_changes(strobes, window, scale, largest, out):
    """Write the largest changes over 1, 2, … periods in the last W windows of `window` states to `out` (periods, W).

    The oldest window comes first. `scale` (2,) and `largest` (S, 2, N) are workspaces: S states are compared at a time,
    so that the loop over them is long enough to be vectorised.
    """
    write_scale(strobes, scale)
    flat, most, numbers = strobes.reshape(-1), largest.reshape(-1), strobes.shape[1] * strobes.shape[2]
    states, last, windows = largest.shape[0], strobes.shape[0] - 1, out.shape[1]
    for n in range(1, out.shape[0] + 1):
        for k in range(windows):
            first = last - (windows - k) * window + 1
            most[:] = 0.0
            for now in range(first, first + window, states):
                begin, end = now * numbers, min(now + states, first + window) * numbers
                raise_changes(most, flat[begin:end], flat[begin - n * numbers : end - n * numbers])
            change = 0.0
            for q in range(2):
                change = max(change, largest_in(largest, q) / scale[q])
            out[n - 1, k] = change
