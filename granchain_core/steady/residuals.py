"""The residual of a periodic orbit; stopping and acceptance tolerances of every Newton method for orbits.

An orbit's residual is the change of its state under the map, in displacements and in w, each relative to its size.
Beads that follow a slow drive pass their rest positions at phase 0: their displacements there are rounding errors and
not a measure of size. So displacements have a least size, a fraction of the amplitude of w over the scaled drive
frequency β.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .returns import relative_change

#: [branch] Residual of the accurate map (`StroboscopicMap`) at which Newton's method stops.
RESIDUAL_GOAL = 1e-11
#: [branch] Largest residual of the accurate map that is accepted, where rounding keeps it above `RESIDUAL_GOAL`. Of
#: 3851 random chains, 2883 ended below the goal, 2 between both limits, and the others, without an orbit, far above.
ACCEPTED_RESIDUAL = 1e-9
#: [period n, followed] Residual of the map with fixed steps (`FiniteDifferenceMap`) at which Newton's method stops.
FIXED_STEP_RESIDUAL_GOAL = 1e-9
#: [period n, followed] Largest residual of the map with fixed steps that is accepted. It is this large because the map
#: jumps where a contact event passes the end of a step.
ACCEPTED_FIXED_STEP_RESIDUAL = 1e-7
#: [no threshold] Least size of displacements at phase 0, relative to the amplitude of w over β.
_LEAST_DISPLACEMENT = 1e-3


def formatted(residuals: Sequence[float]) -> str:
    """Residuals in words."""
    return ", ".join(f"{r:.1e}" for r in residuals)


def least_displacement(x: np.ndarray, beta: float) -> float:
    """Least size of displacements for a scaled state x (2N,) at the scaled drive frequency `beta`."""
    return _LEAST_DISPLACEMENT * float(np.abs(x[len(x) // 2 :]).max()) / beta


def orbit_change(change: np.ndarray, x: np.ndarray, beta: float) -> float:
    """The larger of the changes of displacements and of w, each relative to its size in x (2N,).

    Displacements have a least size (`least_displacement`), which depends on the scaled drive frequency `beta`.
    """
    return relative_change(change, x, least_displacement(x, beta))
