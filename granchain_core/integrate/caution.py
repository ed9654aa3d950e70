"""Factors of caution: the stated error of a computation is its difference from a coarser one times one of these.

The displacements of a settled orbit have none: their difference is enlarged by 1/(1 − |μ|) only
(steady/settling/recorded.py).

Where the error falls by the method's order, the difference alone is a bound: at order 4 it is fifteen times the error.
Contact events make the fall uneven.
"""

from __future__ import annotations

#: Displacements. EVEN: the error falls by the method's order at every refinement (`Method.even`). UNEVEN: it does not,
#: as at contact events with the other methods, with tension cut, and between the samples of a measured force.
EVEN, UNEVEN = 1.5, 3.0
#: Largest forces of a run, on top of the factor above: where no force jumps, and where one does, whose error varies
#: from one step size to the next. Found by trial (`python -m tests.numerics.forces run`).
RUN_FORCES, RUN_FORCES_THAT_JUMP = 1.5, 3.0
#: Largest forces on a periodic orbit, in place of both factors above: only two computations are compared, and their
#: change is enlarged by 1/(1 − |μ|) as well (`orbit_force_errors`).
ORBIT_FORCES = 2.0
