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
#: Contacts open and close while hardly any time passes: rounding decides it, not the motion (`EVENTS_PER_CONTACT`).
CHATTER = 4
#: A period took more steps than the flow allows (`_MOST_STEPS` in kernels/flow/run.py).
TOO_MANY_STEPS = 5
#: The array that records the run is too small for it: it is computed again with a larger one.
FULL = 6
#: An orbit has more contact events than there are places in the log of the flow.
TOO_MANY_EVENTS = 7
#: A step of the flow was aimed at an opening, but the contact does not open there: the step is tried again. Only
#: kernels of the flow see it.
LOST = -1

#: Most contact events for each contact within `EVENT_WINDOW`; more end with CHATTER. The log of the flow has so many
#: places for each drive period.
EVENTS_PER_CONTACT = 2000
#: Scaled time within which contact events are counted. By Hertz's theory a contact of two like beads that meet at the
#: scaled velocity v lasts 3.2 v^{-1/5} of it: 0.08 at v = 1e8.
EVENT_WINDOW = 1.0
#: Fixed steps times bodies in one call of a kernel, or between two readings of the stop flag: 5 to 40 ms.
WORK_BETWEEN_STOP_CHECKS = 1 << 19
#: Most fixed steps between two readings of the stop flag; with error control it is read before every step.
STEPS_BETWEEN_STOP_CHECKS = 4096

#: Places in an array of counts (4,): accepted steps, evaluations of the equations, contact events, rejected steps.
STEPS, EVALUATIONS, EVENTS, REJECTED = 0, 1, 2, 3
