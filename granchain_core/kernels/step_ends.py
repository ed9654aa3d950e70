"""Rows of the arrays that describe the contacts at both ends of a step, which may be split at a contact event."""

from __future__ import annotations

#: Overlaps and their rates at the step's two ends, then the quadrature errors of each contact's impulse and, with
#: damping that grows with the overlap, of ∫G dt. The last name is the number of rows.
OVERLAP, RATE, OVERLAP_END, RATE_END, MOMENTUM_ERROR, DISPLACEMENT_ERROR, END_ROWS = range(7)
#: Rows of the overlaps and of their rates at the start (0) and at the end (1).
OVERLAP_AT, RATE_AT = (OVERLAP, OVERLAP_END), (RATE, RATE_END)
