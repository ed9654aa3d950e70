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
#: No contact opens and closes more often than this in one period unless it chatters.
EVENTS_PER_CONTACT = 2000
#: A period took more steps than are worth waiting for.
TOO_MANY_STEPS = 5
#: The arrays in which a run is kept are full.
FULL = 6
#: A step was aimed at a release, but the contact does not open there; the step is taken in another way.
LOST = -1

#: Most fixed steps between two readings of the stop flag; with error control it is read before every step.
STEPS_BETWEEN_STOP_CHECKS = 4096

#: Places in an array of counts (4,): accepted steps, evaluations of the equations, contact events, rejected steps.
STEPS, EVALUATIONS, EVENTS, REJECTED = 0, 1, 2, 3
