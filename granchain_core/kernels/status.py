"""How a kernel's work ended, and where its costs are counted."""

from __future__ import annotations

#: The work is done.
DONE = 0
#: The stop flag was set.
CANCELLED = 1
#: A number is not finite.
NOT_FINITE = 2
#: Error control asked for a step too small to change the time.
STEP_TOO_SMALL = 3
#: A contact opens and closes more often than time can resolve.
CHATTER = 4

#: Places in an array of counts (4,): accepted steps, evaluations of the equations, contact events, rejected steps.
STEPS, EVALUATIONS, EVENTS, REJECTED = 0, 1, 2, 3
