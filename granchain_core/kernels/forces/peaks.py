"""The largest value of a force sampled at equal steps: the top of the quartic through five values around a maximum."""

from __future__ import annotations

import numpy as np

from ..compiling.jit import brief_kernel, inline_llvm, internal
from ..simd.functions import choose_peak, gate, larger
from ..simd.vector import blank, load_batch, positive_mask, store

#: Values stored for one force: the largest so far, then the last four, newest first.
ROWS = 5

#: The quartic's maximum is at most this factor times the largest of the five values, since only smooth peaks are
#: interpolated (`choose_peak`). Of ten million random peaks, the largest factor was 1.055.
HIGHEST = 1.25

#: An array of peaks: for each of the three forces its `ROWS` values, the largest first, ...
INPUT, OUTPUT, OUTPUT_ELASTIC = 0, ROWS, 2 * ROWS
#: ... then the largest jumps of input and output force. The last name is the size of the array.
INPUT_JUMP, OUTPUT_JUMP, PEAKS = 3 * ROWS, 3 * ROWS + 1, 3 * ROWS + 2
#: In a batch, two more rows: the largest peaks of input and output force that are not smooth, so that only their values
#: at the ends of steps are known. The last name is the size of the array.
INPUT_UNRESOLVED, OUTPUT_UNRESOLVED, BATCH_PEAKS = PEAKS, PEAKS + 1, PEAKS + 2


@inline_llvm
def row_of(force):
    """Row of the largest value of a force: 0 input, 1 output, 2 elastic output."""
    return force * ROWS


@inline_llvm
def row_of_jump(force):
    """Row of the largest jump of a force: 0 input, 1 output."""
    return INPUT_JUMP + force


@inline_llvm
def row_of_unresolved(force):
    """Row of the largest peak that is not smooth: 0 input, 1 output."""
    return INPUT_UNRESOLVED + force


@internal
def quartic_top(a, b, c, d, e):
    """Maximum near the middle of the quartic through five equally spaced values, after two Newton steps."""
    first = (a - e + 8.0 * (d - b)) / 12.0
    second = (16.0 * (b + d) - a - e - 30.0 * c) / 12.0
    third = 0.5 * (e - a) + b - d
    fourth = a + e + 6.0 * c - 4.0 * (b + d)
    x = -first / second
    slope = first + x * (second + x * (0.5 * third + x * (fourth / 6.0)))
    x = x - slope / (second + x * (third + x * (0.5 * fourth)))
    return c + x * (first + x * (0.5 * second + x * (third / 6.0 + x * (fourth / 24.0))))


@internal
def update_peak(peaks, row, value):
    """Update the largest value of one force, whose values begin at peaks[row]."""
    d, c, b, a = peaks[row + 1], peaks[row + 2], peaks[row + 3], peaks[row + 4]
    if value > peaks[row]:
        peaks[row] = value
    if b < c and c >= d:
        top = choose_peak(a, b, c, d, value, quartic_top(a, b, c, d, value))
        if top > peaks[row]:
            peaks[row] = top
    peaks[row + 4], peaks[row + 3], peaks[row + 2], peaks[row + 1] = b, c, d, value


def largest_forces(peaks: np.ndarray) -> np.ndarray:
    """Return the largest input, output and elastic output force so far, as a view (3,); for Python."""
    return peaks[:INPUT_JUMP:ROWS]


def largest_jumps(peaks: np.ndarray) -> np.ndarray:
    """Return the largest jumps of input and output force so far, as a view (2,); for Python."""
    return peaks[INPUT_JUMP:]


@inline_llvm
def write_largest_forces(peaks, out):
    """Write the largest input, output and elastic output force so far into `out` (3,)."""
    for q in range(3):
        out[q] = peaks[row_of(q)]


@brief_kernel
def reset_peaks(peaks):
    """Reset the largest value and the last values."""
    for i in range(INPUT_JUMP):
        peaks[i] = -np.inf if i % ROWS == 0 else 0.0
    peaks[INPUT_JUMP], peaks[OUTPUT_JUMP] = 0.0, 0.0


@brief_kernel
def next_period(peaks):
    """Reset the largest value but keep the last values: a maximum may span the end of a period."""
    for row in range(0, INPUT_JUMP, ROWS):
        peaks[row] = -np.inf
    peaks[INPUT_JUMP], peaks[OUTPUT_JUMP] = 0.0, 0.0


@inline_llvm
def update_batch_peak(peaks, row, value, unresolved):
    """Update the largest value of one force in all members; its values begin at row `row` of a (rows, lanes) array.

    A peak that is not smooth, as next to a closing or in a touch of a few steps, goes into the row `unresolved`.
    """
    d, c = load_batch(peaks, row + 1), load_batch(peaks, row + 2)
    b, a = load_batch(peaks, row + 3), load_batch(peaks, row + 4)
    largest = larger(load_batch(peaks, row), value)
    if positive_mask(HIGHEST * c - largest) & positive_mask(c - b) & ~positive_mask(d - c) != 0:
        rough = gate(HIGHEST * c - largest, gate(c - b, choose_peak(a, b, c, d, value, blank(c))))
        largest = larger(largest, choose_peak(a, b, c, d, value, quartic_top(a, b, c, d, value)))
        store(peaks, unresolved, larger(load_batch(peaks, unresolved), rough - gate(d - c, rough)))
    store(peaks, row, largest)
    store(peaks, row + 4, b)
    store(peaks, row + 3, c)
    store(peaks, row + 2, d)
    store(peaks, row + 1, value)
