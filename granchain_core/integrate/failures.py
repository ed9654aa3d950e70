"""Which bead, when and in which step: what a kernel's status means, found out where it is not known yet.

Kernels with fixed steps look for numbers that are not finite once a sample or a period, because looking costs as much
as a bead. When they have found one, the period is gone through again from its start by halves, until the step is known;
in that step the failure has not spread yet, and its earliest stage names the bead where it began.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..errors import Cancelled, NumbersFailed
from ..kernels import status as outcome
from ..kernels.forces.largest import new_log
from ..kernels.rk4.run import run_samples
from ..stop import Stop
from .methods import METHODS

if TYPE_CHECKING:
    from .engine import Engine


#: State, slope and grid index at the start of a call.
Before = tuple[np.ndarray, np.ndarray, int]


def not_finite(state: np.ndarray, row: int) -> int:
    """Number of the first bead whose displacement or w is not finite, or 0."""
    beads = np.isfinite(state[1 : row - 1]) & np.isfinite(state[row + 1 : 2 * row - 1])
    return 0 if beads.all() else int(np.argmin(beads)) + 1


def check_start(engine: Engine) -> None:
    """Raise `NumbersFailed` if the state from which `engine` is to go on is not finite already."""
    bead = not_finite(engine.y, engine.lowered.row)
    if bead:
        adaptive = METHODS[engine.setting.method].adaptive
        raise _failed(engine, bead, engine.elapsed, None if adaptive else engine.grid_index)


def raise_for(engine: Engine, status: int, done: float, before: Before | None) -> None:
    """Turn a kernel's status into an outcome a student understands.

    `done` is how many drive periods of the call are certain, `before` where it started, None where nobody kept that.
    """
    if status == outcome.DONE:
        return
    if status == outcome.CANCELLED:
        raise Cancelled
    periods = engine.elapsed + done
    when = _when(engine, periods)
    if status == outcome.NOT_FINITE:
        bead, step = _located(engine, done, before)
        raise _failed(engine, bead, periods, step)
    scene, method = engine.lowered.scene, engine.setting.method
    if status == outcome.STEP_TOO_SMALL:
        raise NumbersFailed(f"The step of {method} shrank to nothing {when}; ask for less accuracy than "
                            f"{scene.accuracy:g} or use method rk4-split.", "step-too-small",
                            time=periods * scene.period, cost=_cost(engine))
    raise NumbersFailed(f"Contacts open and close without end {when}; the chain chatters: raise the damping D or use "
                        f"method rk4-split.", "chatter", time=periods * scene.period, cost=_cost(engine))


def _when(engine: Engine, periods: float) -> str:
    return f"at about {periods * engine.lowered.scene.period:.6g} s ({periods:.6g} drive periods)"


def _failed(engine: Engine, bead: int, periods: float, step: int | None) -> NumbersFailed:
    where = "" if step is None else f" in step {step} of its period"
    return NumbersFailed(f"The motion of bead {bead} stopped being a finite number {_when(engine, periods)}{where}; "
                         f"lower the damping or ask for a higher accuracy.", "not-finite", bead,
                         periods * engine.lowered.scene.period, step, _cost(engine))


def _cost(engine: Engine) -> dict[str, int]:
    return dict(zip(("steps", "rhs", "events", "rejected"), map(int, engine.counts.array), strict=True))


def _located(engine: Engine, done: float, before: Before | None) -> tuple[int, int | None]:
    """The bead and the step in which the numbers failed; the step is None where steps are not counted."""
    row = engine.lowered.row
    if METHODS[engine.setting.method].adaptive:
        for slope in engine.work.k:  # stage by stage, each of which spreads to the next beads only
            if not_finite(slope, row):
                return not_finite(slope, row), None
    if before is None or METHODS[engine.setting.method].adaptive:
        return max(1, not_finite(engine.y, row)), None
    return _by_halves(engine, done, before)


def _by_halves(engine: Engine, done: float, before: Before) -> tuple[int, int]:
    """Go through the call again up to the last certain instant, then halve the steps behind it."""
    n, row = engine.method.steps_per_period, engine.lowered.row
    y, slope, first = before
    low = first + round(done * n)
    y, slopes = _steps(engine, y, slope, first, low, vectors=True)
    slope = slopes[0]
    high = (low // n + 1) * n if engine.samples == 1 else min((low // n + 1) * n, low + n // engine.samples)
    while high - low > 1:
        middle = (low + high) // 2
        there, slopes = _steps(engine, y, slope, low, middle, vectors=True)
        if not_finite(there, row):
            high = middle
        else:
            low, y, slope = middle, there, slopes[0]
    _, slopes = _steps(engine, y, slope, low, high)
    end, _ = _steps(engine, y, slope, low, high, vectors=True)
    # each stage spreads to the next beads only: the earliest stage names the bead
    return next((b for b in (not_finite(k, row) for k in (*slopes[1:], end)) if b), 1), low % n


def _steps(engine: Engine, y: np.ndarray, slope: np.ndarray, first: int, last: int,
           vectors: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """State and slopes after steps `first` to `last`, counted through periods, by vectors or by scalar code."""
    n, now = engine.method.steps_per_period, y.copy()
    # new vectors: those of the failed call are full of what failed
    work = engine.work._replace(along=engine.new_simd_workspace() if vectors else None, k=np.zeros_like(engine.work.k))
    work.k[0] = slope
    kept, log = engine.empty_samples(2), new_log()
    j = first
    while j < last:
        stride = min(last, (j // n + 1) * n) - j
        run_samples(engine.method, engine.lowered.slots, engine.drive, engine.h, now, work, j % n, stride,
                             kept, log, np.zeros(4, dtype=np.int64), Stop().flag)
        j += stride
    return now, work.k
