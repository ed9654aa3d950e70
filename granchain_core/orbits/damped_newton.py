"""Damped Newton's method for a fixed point of the exact stroboscopic map, with its derivative at each step.

It finds an orbit at given knobs (find_orbit.py), where z is the state, and a point of a bifurcation curve
(bifurcation_continuation/point.py), where z is the state together with a knob, in a plane across the branch. Branches
(branch/newton.py) and settling chains (steady/settling/finite_difference_map.py) have methods of their own, which need
fewer derivatives.

Source: Deuflhard 2004, Newton Methods for Nonlinear Problems, chapter 3.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..errors import ComputationError
from ..steady.residuals import ACCEPTED_RESIDUAL, RESIDUAL_GOAL
from .stroboscopic_map import Flow

#: Maximum number of steps.
MOST_STEPS = 12
#: Maximum number of sizes tried for one step, each half of the previous one.
_MOST_SIZES = 6


@dataclass(frozen=True, eq=False)
class Iterated:
    """The result of an iteration: the last point z, the flow from z with its derivative, and all residuals."""

    z: np.ndarray
    flow: Flow
    residuals: list[float]

    @property
    def converged(self) -> bool:
        """Whether the last residual is at most `ACCEPTED_RESIDUAL`."""
        return self.residuals[-1] <= ACCEPTED_RESIDUAL


def iterate(evaluate: Callable[[np.ndarray], tuple[Flow, float]], step: Callable[[np.ndarray, Flow], np.ndarray],
            z: np.ndarray) -> Iterated:
    """Iterate Newton's method from z until the residual is at most `RESIDUAL_GOAL`, or no step lowers it.

    `evaluate` returns the flow from a point, with its derivative, and the residual. The step is halved where `evaluate`
    raises `ComputationError` or the residual does not fall. `step` returns the full Newton step from a point.
    """
    flow, residual = evaluate(z)
    residuals = [residual]
    while residuals[-1] > RESIDUAL_GOAL and len(residuals) <= MOST_STEPS:
        full_step = step(z, flow)
        for halving in range(_MOST_SIZES):
            trial = z + full_step / 2**halving
            try:
                after, residual = evaluate(trial)
            except ComputationError:  # the state is too far away for the flow: try a shorter step
                continue
            if residual < residuals[-1]:
                break
        else:
            break
        z, flow = trial, after
        residuals.append(residual)
    return Iterated(z, flow, residuals)
