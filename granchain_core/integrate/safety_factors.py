"""Safety factors by which the difference of two computations is multiplied to obtain the stated error.

One error of displacements has no factor. For a motion without a drive, as shown on the page, it is at least the
method's typical error (steady/settling/undriven.py).

Where the error falls with the method's order, the difference is itself an overestimate: with half the step at order 4,
it is about 15 times the error of the finer computation. Contact events make the decrease irregular. The factors are
tested on random scenes (docs/accuracy.md). The resulting error is an estimate, not a proven bound.
"""

from __future__ import annotations

#: [safety factor] Displacements whose error falls by the method's order at every refinement
#: (`Method.converges_regularly`).
REGULAR = 1.5
#: [safety factor] Displacements whose error falls irregularly: at contact events with the other methods, with tension
#: cut, and between the samples of a measured force. Also displacements of an orbit, which an error of its map may shift
#: by more than 1/(1 − |μ|) times that error.
IRREGULAR = 3.0
#: [safety factor] Largest forces of a run where no force jumps, on top of the factor for displacements. Found by trial,
#: like the next one (`python -m tests.numerics.forces run`).
RUN_FORCES = 1.5
#: [safety factor] Largest forces of a run where a force jumps. Their error varies from one step size to the next.
RUN_FORCES_THAT_JUMP = 3.0
#: [safety factor] Largest forces on a periodic orbit, instead of both other factors. Only two computations are
#: compared, and their difference is also enlarged by 1/(1 − the contraction factor) (`errors_of_map`).
ORBIT_FORCES = 2.0
#: [safety factor] Errors due to the interpolation between samples of a driver's measured motion. The factor multiplies
#: the larger of the differences from every second sample over 2^order − 1, with an order of 1 to 2. Found by trial.
SAMPLED_DRIVE = 2.5
