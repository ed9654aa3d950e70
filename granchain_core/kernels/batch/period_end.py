"""The end of a batch member's drive period: its strobe and largest forces are recorded, and its regime is checked."""

from __future__ import annotations

from ..compiling.by_address import call_at
from ..compiling.jit import inline_llvm
from ..forces.peaks import row_of, row_of_jump, row_of_unresolved
from .record import STROBES_KEPT, append_strobe, is_finite_member


@inline_llvm
def end_period(state, member, check):
    """Record a member's strobe and largest forces, set its phase to exactly 0, and return whether the member is due.

    `check` is the address of `begin_or_check_member` (checks.py).
    """
    motion, schedule, record, search = state.motion, state.schedule, state.record, state.search
    record.periods[member] += 1
    append_strobe(record, motion.y, member)
    write_maxima(motion.peaks, record.maxima[member, record.periods[member] % STROBES_KEPT], member)
    motion.phase[0, member], motion.phase[1, member] = 0.0, 1.0
    schedule.steps_left[member] = schedule.steps[member]
    if not is_finite_member(motion.y, member):
        return True
    if record.periods[member] >= schedule.next_check[member] and call_at(check, (state, member)):
        return True
    pending = search.tested_period[member] > 0 or search.change_before[member] > 0.0
    return record.periods[member] >= schedule.return_at[member] and not pending


@inline_llvm
def write_maxima(peaks, maxima, member):
    """Write a period's largest forces, jumps and unresolved peaks to `maxima` (MAXIMA,), and reset them."""
    for q in range(3):
        maxima[q] = peaks[row_of(q), member]
        peaks[row_of(q), member] = 0.0
    for q in range(2):
        maxima[3 + q] = peaks[row_of_jump(q), member]
        maxima[q] = max(maxima[q], maxima[3 + q])
        peaks[row_of_jump(q), member] = 0.0
        maxima[5 + q] = peaks[row_of_unresolved(q), member]
        peaks[row_of_unresolved(q), member] = 0.0
