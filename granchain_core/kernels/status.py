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
#: A contact opens and closes more often than time can resolve.
CHATTER = 4
#: A period took more steps than are worth waiting for.
TOO_MANY_STEPS = 5
#: The array that records the run is too small for it: it is computed again with a larger one.
FULL = 6
#: A step of the flow was aimed at a release, but the contact does not open there: the step is tried again. Only kernels
#: of the flow see it.
LOST = -1

#: More events in a period than this, times the number of contacts, are CHATTER.
EVENTS_PER_CONTACT = 2000
#: Most fixed steps between two readings of the stop flag; with error control it is read before every step.
STEPS_BETWEEN_STOP_CHECKS = 4096

#: Places in an array of counts (4,): accepted steps, evaluations of the equations, contact events, rejected steps.
STEPS, EVALUATIONS, EVENTS, REJECTED = 0, 1, 2, 3
