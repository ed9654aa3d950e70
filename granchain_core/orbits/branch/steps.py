"""The steps along a branch: where the next orbit is expected, and how long the following step is.

The length of a step keeps two things small: the turn of the branch, and the distance of the orbit from its prediction.
Both are measured on the previous step, so the length does not depend on how Newton's method found the orbit. After a
failed step, the next one does not grow: the cause of the failure usually lies just ahead.
"""

from __future__ import annotations

import numpy as np

from .between import across

#: [branch] First step in arclength.
FIRST_STEP = 0.02
#: [branch] Longest step.
LONGEST_STEP = 0.2
#: [branch] Shortest step.
SHORTEST_STEP = 1e-7
#: [branch] Angle by which the branch turns in a step of the intended length [degrees].
_TURN_OF_STEP = 8.0
#: [branch] Distance of the orbit from its prediction in a step of the intended length, as a fraction of the step.
_MISS_OF_STEP = 0.02
#: [branch] Largest factor from one step to the next.
_GROWTH_FACTOR = 2.0
#: [branch] Smallest factor from one step to the next.
_LEAST_STEP_FACTOR = 0.5
#: [branch] Angle of the turn beyond which a step is rejected [degrees].
_LARGEST_TURN = 30.0
#: [no threshold] Cosine of the largest turn.
LEAST_COSINE = np.cos(np.radians(_LARGEST_TURN))
#: [branch] Largest distance from the predicted to the corrected point, as a fraction of the step.
LARGEST_CORRECTION = 0.3


def predicted(step: float, z: np.ndarray, tangent: np.ndarray,
              before: tuple[np.ndarray, np.ndarray] | None) -> np.ndarray:
    """The predicted point one step from z: along the tangent, with the curvature at z of the cubic through `before`."""
    guess = z + step * tangent
    if before is not None:
        distance = float(np.linalg.norm(z - before[0]))
        second = (6.0 * (before[0] - z) / distance + 2.0 * before[1] + 4.0 * tangent) / distance
        sideways = 0.5 * step**2 * across(second, tangent)
        if np.linalg.norm(sideways) < LARGEST_CORRECTION * step:
            guess += sideways
    return guess


def next_step(step: float, off: float, cosine: float, failed: bool) -> float:
    """The length of the next step, from the miss `off` and the turn of the last one.

    `off` is the distance of the last point from its prediction, and `cosine` that of the angle by which the branch
    turned. The turn grows with the step, and `off` relative to the step with its square. `failed` means that longer
    steps from there had failed.
    """
    angle = max(float(np.arccos(min(1.0, cosine))), 1e-9)
    most = 1.0 if failed else _GROWTH_FACTOR
    wanted = min(np.radians(_TURN_OF_STEP) / angle, np.sqrt(_MISS_OF_STEP * step / max(off, 1e-9 * step)), most)
    return min(LONGEST_STEP, max(_LEAST_STEP_FACTOR, float(wanted)) * step)
