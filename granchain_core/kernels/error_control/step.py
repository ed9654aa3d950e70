"""Steps with error control: the functions that each method supplies, and the choice of step sizes from the error.

A method is a slot with a `tolerance` and a `largest_step`; its type selects `attempt` and `error_order`. The type of
its workspace selects `stages` and the dense output, `prepare_dense` and `dense_value`. Every workspace has

    k (rows, M)       slopes: k[0] at the state, k[stages] at the step's end
    end (M,)          the state at the step's end
    probe, slope (M,) a state inside the step, and its slope
    scale (2,)        the largest displacement and the largest w so far, to which the tolerance is relative
    next_step (1,)    the size of the next step to try
    forces            the workspace of the equations
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..compiling.dispatch import by_type
from ..compiling.jit import inline_numba, internal
from ..effects.driver import driver_displacement, driver_velocity
from ..effects.preload import overlap
from ..equations.motion import motion
from ..status import DONE, EVALUATIONS, NOT_FINITE, REJECTED, STEP_TOO_SMALL
from .bracket import Bracket, maximum_inside, root_inside, value_at

#: [no threshold] Golden sections around a turning point of an overlap.
TURN_SECTIONS = 40
#: [no threshold] The search for an overlap's root ends when its fraction of the step changes by less than this.
_LAST_ROOT_CHANGE = 1e-15
#: [step size] Error control: largest factor from one step to the next, as in Hairer's dop853.f (FAC2).
_MAX_FACTOR = 6.0
#: [step size] Error control: smallest factor from one attempt to the next (FAC1). Hairer has 1/3; over ten scenes, both
#: take the same number of evaluations with dop853.
_MIN_FACTOR = 0.1
#: [step size] Error control: safety factor of the step-size controller, as in Hairer's dop853.f (SAFE).
_SAFETY = 0.9
#: [no threshold] ε in the resolution of t, ε·(t + 1/β): the spacing of floating-point numbers at 1.
_RESOLUTION = 2.2e-16
#: [step size] Error control: a step is too small if this part of it does not change the time, as in Hairer's dop853.f.
#: The times of its stages are about that far apart.
_PART_RESOLVED = 0.1
#: [step size] Error control: a step that ends closer to a goal (the period's end, a sample) than this, in periods, ends
#: at the goal. Such a difference is the rounding of a sum of steps.
GOAL_TOLERANCE = 1e-13


class DriveCycle(NamedTuple):
    """The driver's cycle in scaled time: drive frequency β and period 2π/β."""

    beta: float
    period: float


class Step(NamedTuple):
    """A step of size h from the state of a trajectory at local time t of the period; the rest is in the workspace."""

    trajectory: Any
    t: float
    h: float


class Overlap(NamedTuple):
    """The overlap of a contact inside a step, times a sign."""

    contact: int
    sign: float


@by_type
def attempt(method, step):
    """Make a trial step from y, whose slope is workspace.k[0]; the result is workspace.end, its slope k[stages].

    Returns the error in units of the tolerance: at most 1 if the step is acceptable, NaN if the numbers failed.
    """


@by_type
def error_order(method):
    """The order of the error of `attempt` in the step size."""


@by_type
def stages(workspace):
    """Number of evaluations in an attempt, and the row of k with the slope at its end."""


@by_type
def prepare_dense(workspace, step):
    """Prepare the dense output of an accepted step; return the number of evaluations."""


@by_type
def dense_value(workspace, y, h, x, i):
    """Component i of the state at fraction x of the step of size h from y, whose dense output is prepared."""


@internal
def evaluate(slots, beta, t, y, dy, forces):
    """Evaluate the slope at local time t of the period; the drive phase is βt."""
    motion(slots, driver_displacement(slots.driver, beta * t), driver_velocity(slots.driver, beta * t), y, dy, forces)


@internal
def shrunk(method, h, error):
    """A smaller step after one with too large an error."""
    return h * max(_MIN_FACTOR, _SAFETY * error ** (-1.0 / error_order(method)))


@internal
def next_factor(method, error, rejected):
    """Step-size factor after an accepted step; an error below 1e-12 gives the largest factor in any case.

    After a rejected attempt the step does not grow, as in Hairer's dop853.f, because it would be rejected again.
    """
    most = 1.0 if rejected else _MAX_FACTOR
    return min(most, _SAFETY * max(error, 1e-12) ** (-1.0 / error_order(method)))


@internal
def is_too_small(dt, t, beta):
    """Whether a part `_PART_RESOLVED` of a step dt at local time t is below the resolution of the time within a period.

    The resolution at t itself would be too fine at the start of a period: steps too small to change the state would
    follow one another endlessly.
    """
    return not beta * (_PART_RESOLVED * dt) > _RESOLUTION * (1.0 + beta * t)


@inline_numba
def accepted_in_t(method, trajectory, t, h, counts):
    """Shrink a step from t until its error is tolerable; return (status, size, factor for the next step)."""
    rejected = False
    while True:
        error = attempt(method, Step(trajectory, t, h))
        counts[EVALUATIONS] += stages(trajectory.workspace)
        if not np.isfinite(error):
            return NOT_FINITE, h, 1.0
        if error <= 1.0:
            return DONE, h, next_factor(method, error, rejected)
        counts[REJECTED] += 1
        rejected = True
        h = shrunk(method, h, error)
        if is_too_small(h, t, trajectory.drive.beta):
            return STEP_TOO_SMALL, h, 1.0


@internal
def write_dense_state(step, x):
    """Write the state at fraction x of the step into workspace.probe."""
    y, workspace = step.trajectory.y, step.trajectory.workspace
    for i in range(y.size):
        workspace.probe[i] = dense_value(workspace, y, step.h, x, i)


@by_type
def drive_phase(step, x):
    """Drive phase at fraction x of the step."""


@drive_phase.of(Step)
def _(step, x):
    return step.trajectory.drive.beta * (step.t + x * step.h)


@value_at.of(Overlap)
def _(quantity, step, x):
    slots, _, y, workspace = step.trajectory
    probe, c = workspace.probe, quantity.contact
    for i in range(c, c + 2):
        probe[i] = dense_value(workspace, y, step.h, x, i)
    if c == 0:  # the driver's motion is known exactly
        probe[0] = driver_displacement(slots.driver, drive_phase(step, x))
    return quantity.sign * overlap(slots.preload, probe, c)


@internal
def turning_point(signed_overlap, step):
    """Fraction at which an overlap is largest inside the step."""
    x, _ = maximum_inside(signed_overlap, step, 1.0, TURN_SECTIONS)
    return x


@internal
def crossing(signed_overlap, step, low, high):
    """Fraction between `low` and `high` at which an overlap changes sign."""
    f_low, f_high = value_at(signed_overlap, step, low), value_at(signed_overlap, step, high)
    return root_inside(signed_overlap, step, Bracket(low, high, f_low, f_high, 0), _LAST_ROOT_CHANGE)


@internal
def new_scale(y, workspace, bodies):
    """Raise the scale of the tolerance to the largest values in y."""
    for row in range(2):
        for i in range(row * bodies + 1, row * bodies + bodies - 1):
            workspace.scale[row] = max(workspace.scale[row], abs(y[i]))
