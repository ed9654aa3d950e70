"""The rotation number of stroboscopic states, from the angle with which they go round a closed curve.

Equation   ρ = ⟨ψ_{k+1} − ψ_k⟩ with ψ = arg(z) / 2π, z_k = X̂* C⁺ X_k and ⟨⟩ the weighted Birkhoff average. X_k is the
           pair (x_k, x_{k+1}), C its covariance and X̂ its Fourier coefficient at one line of the spectrum
Source     Das, Saiki, Sander & Yorke 2016, 2017; Sander & Meiss 2020 for the average as a test of chaos
Note       C⁺ X̂ is the projection in which this line is strongest relative to everything else (a matched filter), so
           that z goes round zero once in each turn of the line, even if the curve is folded in every plane of two
           coordinates. The angle is well defined if z, turned back by ν k, stays in one half plane. For a line at mρ,
           the angle advances by mρ per period.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from ..steady.regime_criteria import LONGEST_LOCKED_PERIOD
from .birkhoff import average, fourier_coefficient, turns
from .strobe_lines import AT_MULTIPLE, Basic, basic_frequency, curves_of, fraction_at, lines_of

#: [rotation] Minimum number of states on one curve from which a rotation number is computed.
FEWEST_STATES = 200
#: [rotation] Directions whose variance is below this fraction of the largest are left out of a projection.
_LEAST_VARIANCE = 1e-8
#: [rotation] States whose changes are below this fraction of the largest state do not move.
_AT_REST = 1e-9
#: [rotation] Number of lines whose angles are averaged.
_PROJECTED_LINES = 3
#: [rotation] Largest denominator of a fraction with which a rotation number is compared: the longest period that a
#: regime may have.
LARGEST_DENOMINATOR = LONGEST_LOCKED_PERIOD
#: [rotation] Minimum number of passes, P |qρ − j|, of the states near a fraction from one of the places of a locked
#: motion to the next.
_FEWEST_PASSES = 4.0
#: [rotation] Minimum number of passes near a fraction whose denominator is at most `_SMALL`. It is two widths of a line
#: (`_WIDTH` in strobe_lines.py). With fewer passes, the line of one turn may lie within the width of a stronger
#: multiple of it, or be discarded as a drift; only multiples of 2ρ are then left. Of 240 curves with 0.5 to 30 passes,
#: limits of 4, 8, 12 and 16 left 12, 11, 3 and 0 wrong.
_FEWEST_PASSES_IF_SMALL = 16.0
#: [rotation] Largest denominator of a fraction that needs more passes.
_SMALL = 5
#: [rotation] Stated error of the average over the largest difference between averages. A few differences may all be
#: small by chance.
_STATED = 3.0
#: [rotation] Smallest stated error of the average: rounding.
_ROUNDING = 1e-15
#: Parts of a record whose averages are compared, as fractions of its length.
_PARTS = ((0.0, 0.5), (0.25, 0.75), (0.5, 1.0))
#: [rotation] Number of record lengths for which the convergence is given, each half of the next.
LENGTHS = 4


@dataclass(frozen=True)
class Winding:
    """The rotation number of states, or the reason why there is none.

    `value` is in [0, ½] and is that of the `curves`-th iterate of the map. `error` is `_STATED` times the largest
    difference between the first, middle and last half of the record, between `projections` projections, or from the
    spectral line. `convergence` (4, 3) has a row for each record length: number of states on one curve, their rotation
    number, and the largest difference between their halves. If `value` is None, `reason` says why.
    """

    value: float | None
    error: float | None
    curves: int
    reason: str = ""
    projections: int = 0
    convergence: np.ndarray | None = None


def folded(value: float) -> float:
    """A rotation number folded into [0, ½], since it is known only up to its sign and a whole number."""
    return abs(value - round(value))


def winding_of(states: np.ndarray) -> Winding:
    """Compute the rotation number of stroboscopic states (P, 2, N), one per drive period: displacements, and v or w."""
    embedded = _embedded(states)
    if len(embedded) < FEWEST_STATES:
        return _none(1, f"there are fewer than {FEWEST_STATES} states on one curve")
    if np.ptp(states, axis=0).max() <= _AT_REST * np.abs(states).max():
        return _none(1, "the states are all the same")
    lines = lines_of(embedded)
    curves = curves_of(lines, len(embedded))
    if curves == 1:
        return _on_one_curve(embedded, lines, 1)
    embedded = _embedded(states[: len(states) // curves * curves : curves])
    if len(embedded) < FEWEST_STATES:
        return _none(curves, f"there are fewer than {FEWEST_STATES} states on each of {curves} curves")
    if np.abs(embedded).max() <= _AT_REST:
        return _none(curves, f"the states repeat after {curves} periods")
    return _on_one_curve(embedded, lines_of(embedded), curves)


def _none(curves: int, reason: str) -> Winding:
    return Winding(None, error=None, curves=curves, reason=reason)


def _embedded(states: np.ndarray) -> np.ndarray:
    """Pairs of successive states (P − 1, 4N) without their mean, each kind of coordinate relative to its largest."""
    largest = np.maximum(np.abs(states).max(axis=(0, 2), keepdims=True), np.finfo(float).tiny)
    flat = (states / largest).reshape(len(states), -1)
    flat = flat - average(flat)
    return np.concatenate([flat[:-1], flat[1:]], axis=1)


def _on_one_curve(embedded: np.ndarray, lines: np.ndarray, curves: int) -> Winding:
    count = len(embedded)
    if len(lines) == 0:
        return _none(curves, "their spectrum has no line")
    if any(fraction_at(float(line), count) for line in lines):
        return _none(curves, "the states repeat, or there are more curves than can be detected")
    basic = basic_frequency(lines, count)
    if basic is None:
        strongest = ", ".join(f"{line:.6f}" for line in lines[:_PROJECTED_LINES])
        return _none(curves, f"the strongest lines of their spectrum ({strongest} per period) and the others are not "
                             "multiples of one frequency: there is a third frequency, the motion is chaotic, or it is "
                             "locked to a long period")
    increments = [(steps, multiple) for steps, multiple in _projections(embedded, lines, basic) if steps is not None]
    if len(increments) < 2:
        return _none(curves, "no two projections were found in which they go round a closed curve")
    rotations = [_rotation(steps, multiple, basic.frequency) for steps, multiple in increments]
    few = _passes(rotations[0], count)
    if few is not None:
        return _none(curves, f"the rotation number is within {abs(folded(rotations[0]) - few):.1e} of {few}, and the "
                             "record is too short to show that the motion is not locked there")
    errors = [abs(other - rotations[0]) for other in (*rotations[1:], basic.frequency)]
    steps, multiple = increments[0]
    convergence = np.array([_at_length(steps[: count >> k], multiple, basic.frequency) for k in range(LENGTHS)][::-1])
    error = max(_STATED * max(*errors, convergence[-1, 2]), _ROUNDING)
    return Winding(folded(rotations[0]), error=float(error), curves=curves, reason="", projections=len(rotations),
                   convergence=convergence)


def _projections(embedded: np.ndarray, lines: np.ndarray, basic: Basic) -> list[tuple[np.ndarray | None, int]]:
    """Increments of the angle in several projections, and how often each goes round in one turn of the curve.

    All coordinates are projected with each of the strongest lines; displacements alone and velocities alone are
    projected with the strongest line.
    """
    half = np.arange(embedded.shape[1]) % (embedded.shape[1] // 2) < embedded.shape[1] // 4
    strongest = zip(lines[:_PROJECTED_LINES], basic.multiples, strict=False)
    return [*((_increments(embedded, float(line)), multiple) for line, multiple in strongest),
            *((_increments(embedded[:, part], float(lines[0])), basic.multiples[0]) for part in (half, ~half))]


def _increments(states: np.ndarray, line: float) -> np.ndarray | None:
    """Advance (P − 1,) of the angle in turns from state to state, in the projection with one line; None if undefined.

    If there are too few coordinates to separate the line from a stronger one, z follows the stronger one.
    """
    variances, directions = np.linalg.eigh(states.T @ states / len(states))
    kept = variances > _LEAST_VARIANCE * variances.max()
    directions = directions[:, kept]
    projection = directions @ ((directions.T @ fourier_coefficient(states, line)) / variances[kept])
    z = states @ projection.real - 1j * (states @ projection.imag)
    back = z * turns(line, len(z))
    turned = np.angle(back[1:] / back[:-1]) / (2.0 * np.pi)
    excess = float(average(turned))
    still = back * turns(excess, len(back))
    if abs(excess) > AT_MULTIPLE / len(states) or (still / still.mean()).real.min() <= 0.0:
        return None
    return np.asarray(line + turned)


def _rotation(steps: np.ndarray, multiple: int, near: float) -> float:
    """The rotation number near `near`, from an angle that goes round `multiple` times in one turn of the curve."""
    advance = float(average(steps))
    return (advance + round(multiple * near - advance)) / multiple


def _at_length(steps: np.ndarray, multiple: int, near: float) -> tuple[float, float, float]:
    """Number of states, rotation number, and the largest difference between the first, middle and last half."""
    count = len(steps)
    halves = [_rotation(steps[int(a * count) : int(b * count)], multiple, near) for a, b in _PARTS]
    full = _rotation(steps, multiple, near)
    return count, folded(full), max(max(halves) - min(halves), *(abs(half - full) for half in halves))


def _passes(rotation: float, states: int) -> Fraction | None:
    """The fraction near which `states` states do not fill a curve; None if there is no such fraction.

    Near j/q, the states stay close to q places, and in q periods they move by q|ρ − j/q| of the distance between these.
    """
    for q in range(1, LARGEST_DENOMINATOR + 1):
        fewest = _FEWEST_PASSES_IF_SMALL if q <= _SMALL else _FEWEST_PASSES
        if abs(q * folded(rotation) - round(q * folded(rotation))) * states < fewest:
            return Fraction(round(q * folded(rotation)), q)
    return None
