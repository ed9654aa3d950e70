"""How a kernel ended, the limits it keeps to, and where its costs are counted."""

from __future__ import annotations

# What a kernel returns.
#: It went to its end.
DONE = 0
#: The stop flag was set.
CANCELLED = 1
#: A number is not finite.
NOT_FINITE = 2
#: Error control asked for a step too small to change the time.
STEP_TOO_SMALL = 3
#: A period has more contact events than `EVENTS_PER_CONTACT` times the number of contacts.
CHATTER = 4
#: A period took more steps than the flow allows (`_MOST_STEPS` in kernels/flow/run.py).
TOO_MANY_STEPS = 5
#: The array that records the run is too small for it: it is computed again with a larger one.
FULL = 6
#: A step of the flow was aimed at an opening, but the contact does not open there: the step is tried again. Only
#: kernels of the flow see it.
LOST = -1

#: A period with more contact events than this, times the number of contacts, ends with CHATTER.
EVENTS_PER_CONTACT = 2000
#: Most fixed steps between two readings of the stop flag; with error control it is read before every step.
STEPS_BETWEEN_STOP_CHECKS = 4096

#: Places in an array of counts (4,): accepted steps, evaluations of the equations, contact events, rejected steps.
STEPS, EVALUATIONS, EVENTS, REJECTED = 0, 1, 2, 3
