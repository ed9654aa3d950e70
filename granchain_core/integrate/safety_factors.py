"""Safety factors on the difference of two computations, from which the stated error follows.

Two errors of displacements have no factor. That of a settled orbit is the difference over 1 − the contraction factor
(steady/settling/recording.py). That of a motion without a drive, as the page shows it, is at least the method's typical
error (steady/settling/undriven.py).

Where the error falls with the method's order, the difference is itself an overestimate: with half the step at order 4
it is about 15 times the error of the finer computation. Contact events make the fall irregular. The factors are tested
on random scenes (docs/accuracy.md); what they give is an estimate, no proven bound.
"""

from __future__ import annotations

#: [safety factor] Displacements whose error falls by the method's order at every refinement
#: (`Method.converges_regularly`).
REGULAR = 1.5
#: [safety factor] Displacements whose error falls irregularly: at contact events with the other methods, with tension
#: cut, and between the samples of a measured force. Also strobes of an orbit, which an error of its map may move by
#: more than 1/(1 − |μ|).
IRREGULAR = 3.0
#: [safety factor] Largest forces of a run where no force jumps, on top of the factor of displacements. Found by trial,
#: as is the next one (`python -m tests.numerics.forces run`).
RUN_FORCES = 1.5
#: [safety factor] Largest forces of a run where a force jumps. Its error varies from one step size to the next.
RUN_FORCES_THAT_JUMP = 3.0
#: [safety factor] Largest forces on a periodic orbit, in place of both other factors. Only two computations are
#: compared, and their change is enlarged by 1/(1 − the contraction factor) as well (`errors_of_map`).
ORBIT_FORCES = 2.0
#: [safety factor] Errors by the interpolation between samples of a driver's measured motion. The factor multiplies the
#: larger of the differences from every second sample over 2^p − 1, with an order p of 1 to 2. Found by trial.
SAMPLED_DRIVE = 2.5
