"""The record of a batch member: its strobes, and its moves to another state, where the record starts again."""

from __future__ import annotations

import numpy as np

from ..compiling.jit import internal
from ..equations.motion import copy

#: At least this many of a member's last strobes are kept, once there are that many.
STROBES_KEPT = 432
#: Numbers recorded per period: three largest forces, and the largest jump and unresolved peak of input and output
#: force.
MAXIMA = 7


@internal
def is_finite_member(y, member):
    """Whether every number of a member's state is finite."""
    finite = True
    for i in range(y.shape[0]):
        finite = finite and np.isfinite(y[i, member])
    return finite


@internal
def append_strobe(record, y, member):
    """Append the state to the strobes, dropping their older half if they are full."""
    strobes, bodies = record.strobes, y.shape[0] // 2
    if record.strobe_count[member] == strobes.shape[1]:
        half = strobes.shape[1] // 2
        for p in range(half):
            copy(strobes[member, half + p, 0], strobes[member, p, 0])
            copy(strobes[member, half + p, 1], strobes[member, p, 1])
        record.strobe_count[member] = half
        for q in range(2):
            record.first_strobe[q, member] = max(0, record.first_strobe[q, member] - half)
    row = record.strobe_count[member]
    for i in range(bodies):
        strobes[member, row, 0, i], strobes[member, row, 1, i] = y[i, member], y[bodies + i, member]
    record.strobe_count[member] += 1


@internal
def set_state(motion, member, target):
    """Set the state of a member at phase 0 to `target` (2, bodies)."""
    y, bodies = motion.y, target.shape[1]
    for i in range(1, bodies - 1):
        y[i, member], y[bodies + i, member] = target[0, i], target[1, i]
    forget_last_step(motion, member)


@internal
def forget_last_step(motion, member):
    """Discard data of the previous step: a member continues from another state, at phase 0, with the driver at 0."""
    for c in range(motion.overlaps.shape[0]):
        left = 0.0 if c == 0 else motion.y[c, member]
        motion.overlaps[c, member] = left - motion.y[c + 1, member] + motion.static_overlap[c, member]
    for row in range(4):
        motion.end_contacts[row, member] = 1.0  # counts as closed, so that no closing is recorded here


@internal
def largest_force(record, member, n, q):
    """The largest force of kind q in a member's last n periods."""
    largest = 0.0
    for p in range(n):
        largest = max(largest, record.maxima[member, (record.periods[member] - p) % STROBES_KEPT, q])
    return largest


@internal
def move_member(state, member, target):
    """Move a member to the state `target` (2, bodies), where its record starts again."""
    record = state.record
    set_state(state.motion, member, target)
    record.first_strobe[1, member] = record.first_strobe[0, member]
    record.first_strobe[0, member] = record.strobe_count[member]
    append_strobe(record, state.motion.y, member)


@internal
def undo_extrapolation(state, member):
    """Move a member back to its state before the last extrapolation, from where its record and periods continue."""
    record = state.record
    set_state(state.motion, member, state.search.state_before[member])
    record.periods[member] -= record.strobe_count[member] - record.first_strobe[0, member] - 1
    record.strobe_count[member] = record.first_strobe[0, member]
    record.first_strobe[0, member] = record.first_strobe[1, member]
