"""SciPy's solvers, applied to the same compiled equations in scaled w-variables.

SciPy is imported by the first measurement. The dashboard starts without one, and so answers 0.3 s earlier.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import Cancelled, ComputationError
from ..execution.stop import Stop
from ..integrate import Counts
from ..integrate.error_controlled import LEAST_STEPS_PER_PERIOD
from ..integrate.scaling import ScaledChain, scale_chain
from ..kernels.compiling.entry import entry
from ..kernels.equations.motion import evaluate_at_phase
from ..kernels.status import EVALUATIONS
from ..scene import Scene
from ..scene.state import rest


@dataclass(frozen=True)
class Solver:
    """One of SciPy's solvers, by its name in `scipy.integrate`, with the properties that its documentation claims."""

    name: str
    title: str
    order: float
    restrictions: str
    reference: str


_ACROSS = "steps across contact events; its tolerance is per step and does not bound the error at the end"

SOLVERS: dict[str, Solver] = {
    s.name: s
    for s in (
        Solver("LSODA", "SciPy LSODA, Adams and BDF with switching", 12.0, _ACROSS,
               "Petzold 1983; Hindmarsh 1983"),
        Solver("RK45", "SciPy RK45, Dormand–Prince 5(4)", 5.0, _ACROSS, "Dormand & Prince 1980"),
        Solver("DOP853", "SciPy DOP853, Dormand–Prince 8(5,3)", 8.0, _ACROSS,
               "Hairer, Nørsett & Wanner 1993, section II.5"),
    )
}
#: Smallest relative tolerance that SciPy accepts without changing it.
_LEAST_RTOL = 3e-14
#: A contact event within this fraction of a period after a step's start is the event at which the step started.
_SAME_EVENT = 1e-9


class ScipyMotion:
    """The beads' equations in the form SciPy needs: a function of time and one flat array (u_1..u_N, w_1..w_N), (2N,).

    All quantities are scaled, and time is measured from the start of the period.
    """

    def __init__(self, scaled: ScaledChain, stop: Stop) -> None:
        self.scaled = scaled
        self.stop = stop
        self.evaluations = 0
        self._row = scaled.bodies
        self._whole, self._slope, self._forces = np.zeros(scaled.size), np.zeros(scaled.size), scaled.forces()
        # without Numba's dispatcher, whose time is not SciPy's
        self._evaluate = entry(evaluate_at_phase, scaled.slots, 0.0, self._whole, self._slope, self._forces, False)

    def inner(self, y: np.ndarray) -> np.ndarray:
        """Return the beads' part (2N,) of a whole state array (2(N + 2),)."""
        row = self._row
        return np.concatenate([y[1 : row - 1], y[row + 1 : 2 * row - 1]])

    def __call__(self, t: float, inner: np.ndarray) -> np.ndarray:
        """Return the slope (2N,) at time t of the period."""
        row, full_state = self._row, self._whole
        self.evaluations += 1
        full_state[1 : row - 1], full_state[row + 1 : 2 * row - 1] = inner[: row - 2], inner[row - 2 :]
        self._evaluate(self.scaled.slots, float(self.scaled.beta * t), full_state, self._slope, self._forces, False)
        return self.inner(self._slope)

    def overlaps(self, t: float, inner: np.ndarray) -> np.ndarray:
        """Return the overlap of every contact (N+1,) in scaled units."""
        slots = self.scaled.slots
        drive = slots.driver.amplitude * np.sin(self.scaled.beta * t)
        bodies = np.concatenate([[drive], inner[: self._row - 2], [0.0]])
        static = 0.0 if slots.preload is None else slots.preload.static
        return bodies[:-1] - bodies[1:] + static


def solve(scene: Scene, solver: str, tolerance: float, periods: int, samples: int, stop: Stop | None = None,
          located: bool = False) -> tuple[np.ndarray, Counts]:
    """Return scaled displacements (periods · samples + 1, N) from rest, `samples` per period; atol = rtol = tolerance.

    The motion is solved period by period, so that the drive phase stays exact. With `located`, the solver is also
    restarted wherever a contact opens or closes, as a careful user would do. Raises `ComputationError` and `Cancelled`.
    """
    scaled = scale_chain(scene)
    motion = ScipyMotion(scaled, Stop() if stop is None else stop)
    inner = motion.inner(scaled.from_si(rest(scene)))
    out = np.full((periods * samples + 1, scene.N), np.nan)
    out[0] = inner[: scene.N]
    for p in range(periods):
        inner, rows = _period(motion, SOLVERS[solver], tolerance, inner, samples, located)
        out[p * samples + 1 : (p + 1) * samples + 1] = rows
        if not np.isfinite(inner).all():  # LSODA reports this as a success
            raise ComputationError(f"SciPy's {solver} failed in drive period {p + 1}: its state is no longer "
                                   f"finite, at tolerance {tolerance:g}.", "not-finite")
    counts = Counts()
    counts.array[EVALUATIONS] = motion.evaluations
    return out, counts


def _period(motion: ScipyMotion, solver: Solver, tolerance: float, inner: np.ndarray, samples: int,
            located: bool) -> tuple[np.ndarray, np.ndarray]:
    """Solve one drive period from the state `inner` (2N,); return its last state and the displacements (samples, N).

    The start is not a sample. Raises `ComputationError` and `Cancelled`.
    """
    from scipy import integrate

    period, n = motion.scaled.period, len(inner) // 2
    times = period * np.arange(1, samples + 1) / samples
    rows, t = np.full((samples, n), np.nan), 0.0

    def start(t: float, state: np.ndarray, end: float) -> Any:
        make = getattr(integrate, solver.name)
        return make(motion, t, state, end, max_step=period / LEAST_STEPS_PER_PERIOD, atol=tolerance,
                    rtol=max(tolerance, _LEAST_RTOL))

    stepper, event = start(0.0, inner, period), period
    while t < period:
        if motion.stop:
            raise Cancelled
        before = stepper.y.copy()
        stepper.step()
        if stepper.status == "failed":
            raise ComputationError(f"SciPy's {solver.name} gave up after {t / period:.3g} of a drive period at "
                                   f"tolerance {tolerance:g}.", "solver-gave-up")
        dense = stepper.dense_output()
        if located and stepper.t_bound == period:
            event = _first_event(motion, dense, stepper, before)
            if event < stepper.t:
                stepper = start(t, before, event)
                continue
        inside = (times > t) & (times <= stepper.t)
        if inside.any():
            rows[inside] = dense(times[inside])[:n].T
        t, inner = stepper.t, stepper.y
        if stepper.status == "finished" and t < period:
            stepper = start(t, inner, period)
    return inner, rows


def _first_event(motion: ScipyMotion, dense: Any, stepper: Any, before: np.ndarray) -> float:
    """Return the scaled time at which the first contact opens or closes within the last step; infinite if none does.

    `dense` is the step's interpolant, `stepper` the solver after the step, and `before` the state (2N,) at its start.
    """
    from scipy.optimize import brentq

    changed = (motion.overlaps(stepper.t_old, before) > 0.0) != (motion.overlaps(stepper.t, stepper.y) > 0.0)
    near = _SAME_EVENT * motion.scaled.period
    first = np.inf
    for c in np.flatnonzero(changed):
        if (motion.overlaps(stepper.t_old + near, dense(stepper.t_old + near))[c] > 0.0) == (
                motion.overlaps(stepper.t, stepper.y)[c] > 0.0):
            continue
        first = min(first, brentq(lambda t, c=c: motion.overlaps(t, dense(t))[c], stepper.t_old + near, stepper.t,
                                  xtol=1e-14))
    return first
