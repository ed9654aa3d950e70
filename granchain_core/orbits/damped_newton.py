"""Damped Newton's method for a fixed point of the exact stroboscopic map, with its derivative at each step.

It serves an orbit at given knobs (find_orbit.py), where z is the state, and a point of a bifurcation curve
(bifurcation_continuation/point.py), where z is the state with a knob, in a plane across the branch. Branches
(branch/newton.py) and settling chains (steady/settling/finite_difference_map.py) have methods of their own, because
they save derivatives.

Source: Deuflhard 2004, Newton Methods for Nonlinear Problems, chapter 3.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..errors import ComputationError
from ..steady.residuals import ACCEPTED_RESIDUAL, RESIDUAL_GOAL
from .stroboscopic_map import Flow

#: Steps at most.
MOST_STEPS = 12
#: Most sizes of a step that are tried, each half of the one before.
_MOST_SIZES = 6


@dataclass(frozen=True, eq=False)
class Iterated:
    """The end of an iteration: the point z, the map from z with its derivative, and the residuals of all points.

    It has `converged` where the last residual is accepted.
    """

    z: np.ndarray
    flow: Flow
    residuals: list[float]

    @property
    def converged(self) -> bool:
        """Whether the last residual is accepted."""
        return self.residuals[-1] <= ACCEPTED_RESIDUAL


def iterate(evaluate: Callable[[np.ndarray], tuple[Flow, float]], step: Callable[[np.ndarray, Flow], np.ndarray],
            z: np.ndarray) -> Iterated:
    """Newton's steps from z down to `RESIDUAL_GOAL`, or until no step lowers the residual.

    `evaluate` returns the map from a point with its derivative, and the residual; where it raises `ComputationError`
    the step is halved, as where the residual does not fall. `step` is Newton's step from a point.
    """
    flow, residual = evaluate(z)
    residuals = [residual]
    while residuals[-1] > RESIDUAL_GOAL and len(residuals) <= MOST_STEPS:
        full_step = step(z, flow)
        for halving in range(_MOST_SIZES):
            trial = z + full_step / 2**halving
            try:
                after, residual = evaluate(trial)
            except ComputationError:  # a state too far away to be followed: a shorter step is nearer
                continue
            if residual < residuals[-1]:
                break
        else:
            break
        z, flow = trial, after
        residuals.append(residual)
    return Iterated(z, flow, residuals)
