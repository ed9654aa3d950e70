"""Status codes of kernels, the limits that they keep to, and the indices of their cost counters."""

from __future__ import annotations

# Return values of a kernel.
#: It ran to its end.
DONE = 0
#: The stop flag was set.
CANCELLED = 1
#: A number was not finite.
NOT_FINITE = 2
#: Error control asked for a step too small to change the time.
STEP_TOO_SMALL = 3
#: Contacts open and close while hardly any time passes: rounding decides this, not the motion (`EVENTS_PER_CONTACT`).
CHATTER = 4
#: A period took more steps than the flow allows (`_MOST_STEPS` in kernels/flow/run.py).
TOO_MANY_STEPS = 5
#: The array that records the run is too small: the run is repeated with a larger one.
FULL = 6
#: An orbit has more contact events than the log of the flow can hold.
TOO_MANY_EVENTS = 7
#: A step of the flow was aimed at an opening, but the contact does not open there: the step is tried again. This status
#: never leaves the kernels of the flow.
OPENING_MISSED = -1

#: Most contact events per contact within `EVENT_WINDOW`; more end the run with CHATTER. The log of the flow has room
#: for this many per contact and drive period, and for `MOST_EVENTS_OF_ORBIT` (integrate/failure.py) in all.
EVENTS_PER_CONTACT = 2000
#: Scaled time within which contact events are counted. By Hertz's theory, a contact of two equal beads that meet at the
#: scaled velocity v lasts a scaled time of 3.2 v^{-1/5}: 0.08 at v = 1e8.
EVENT_WINDOW = 1.0
#: Fixed steps times bodies in one call of a kernel, or between two readings of the stop flag: 5 to 40 ms.
WORK_BETWEEN_STOP_CHECKS = 1 << 19
#: Most fixed steps between two readings of the stop flag (docs/design.md, "When a kernel reads the stop flag").
STEPS_BETWEEN_STOP_CHECKS = 4096

#: Indices into an array of counts (4,): accepted steps, evaluations of the equations, contact events, rejected steps.
STEPS, EVALUATIONS, EVENTS, REJECTED = 0, 1, 2, 3
