"""The end of a batch member's drive period: its strobe and its largest forces are kept, and its regime is checked."""

from __future__ import annotations

from ..compiling.by_address import call_at
from ..compiling.jit import inline_llvm
from ..forces.peaks import row_of, row_of_jump, row_of_unresolved
from .record import STROBES_KEPT, append_strobe, is_finite_member


@inline_llvm
def end_period(state, member, check):
    """Record a member's strobe and largest forces, set its phase to 0 exactly; returns whether the member is due.

    `check` is the address of `check_member` (checks.py).
    """
    state.periods[member] += 1
    periods = state.periods[member]
    append_strobe(state.strobes, state.strobe_count, state.first_strobe, state.y, member)
    maxima = state.maxima[member, periods % STROBES_KEPT]
    for q in range(3):
        maxima[q] = state.peaks[row_of(q), member]
        state.peaks[row_of(q), member] = 0.0
    for q in range(2):
        maxima[3 + q] = state.peaks[row_of_jump(q), member]
        maxima[q] = max(maxima[q], maxima[3 + q])
        state.peaks[row_of_jump(q), member] = 0.0
        maxima[5 + q] = state.peaks[row_of_unresolved(q), member]
        state.peaks[row_of_unresolved(q), member] = 0.0
    state.phase[0, member], state.phase[1, member] = 0.0, 1.0
    state.steps_left[member] = state.steps[member]
    if not is_finite_member(state.y, member):
        return True
    if periods >= state.next_check[member] and call_at(check, (state, member)):
        return True
    pending = state.tested_period[member] > 0 or state.change_before_extrapolation[member] > 0.0
    return state.periods[member] >= state.return_at[member] and not pending
