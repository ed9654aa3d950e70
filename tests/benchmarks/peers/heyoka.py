"""heyoka: Taylor's method to machine precision, with contact events and piecewise equations.

The power 3/2 has no Taylor series at overlap 0, and Taylor steps shrink in proportion to the distance from it. Each
contact therefore has two gates, both switched by events: that of the dashpot at d = 0, and that of the elastic force at
a small overlap ε, below which the elastic force is omitted. The resulting error falls as ε^{5/2}; ε depends on the
tolerance.
"""

from __future__ import annotations

import importlib.util
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from .. import problem
from ..case import Case, Solve, case_of, rest, rungs
from ..problem import Solved

#: For an error e, ε is e^{2/5} times this.
_OVERLAP = 0.03
_CONTACTS = problem.BEADS + 1
#: Scaled time at which heyoka takes over after the start, and the most steps of one problem.
_BEGIN, _STEPS = 2.5, 5_000_000


def missing() -> str:
    """Return the reason why it cannot run, or an empty text."""
    return "" if importlib.util.find_spec("heyoka") else "heyoka is not installed"


class _Switch:
    """The callback of an event, which sets one gate by the direction in which the overlap crosses."""

    def __init__(self, gate: int) -> None:
        self.gate = gate

    def __call__(self, integrator: Any, direction: int) -> bool:
        integrator.pars[self.gate] = 1.0 if direction > 0 else 0.0
        return True


def _integrator(tolerance: float) -> Any:
    """Return an integrator of the equations in w; parameters are β (0), dashpot gates (1–12) and elastic gates (13–24).
    """
    import heyoka as hy

    hy.set_logger_level_error()
    n, overlap = problem.BEADS, _OVERLAP * tolerance**0.4
    u = hy.make_vars(*[f"u{i}" for i in range(n)])
    w = hy.make_vars(*[f"w{i}" for i in range(n)])
    line = [hy.sin(hy.par[0] * hy.time), *u, hy.expression(0.0)]
    d = [a - b for a, b in pairwise(line)]
    dashpot = [problem.LAMBDA * hy.par[1 + c] * d[c] for c in range(_CONTACTS)]
    elastic = []
    for c in range(_CONTACTS):
        gate = hy.par[1 + _CONTACTS + c]
        elastic.append(gate * (gate * d[c] + (1.0 - gate)) ** 1.5)  # with the gate shut, the base is 1
    system = [(u[i], w[i] + dashpot[i] - dashpot[i + 1]) for i in range(n)]
    system += [(w[i], elastic[i] - elastic[i + 1]) for i in range(n)]
    events = [hy.t_event(d[c], callback=_Switch(1 + c)) for c in range(_CONTACTS)]
    events += [hy.t_event(d[c] - overlap, callback=_Switch(1 + _CONTACTS + c)) for c in range(_CONTACTS)]
    return hy.taylor_adaptive(system, list(rest()), pars=[0.0] * (1 + 2 * _CONTACTS), tol=tolerance, t_events=events,
                              compact_mode=True)


def _begun(beta: float) -> np.ndarray:
    """Return the state at `_BEGIN` from rest, by SciPy: at the start, all overlaps are 0 and events are ambiguous."""
    found = solve_ivp(problem.slope_w_numpy, (0.0, _BEGIN), rest(), "DOP853", args=(beta,), rtol=1e-13, atol=1e-22)
    return found.y[:, -1]


def _gates(beta: float, state: np.ndarray, tolerance: float) -> np.ndarray:
    """Return all parameters at `_BEGIN`."""
    line = np.concatenate([[np.sin(beta * _BEGIN)], state[: problem.BEADS], [0.0]])
    overlap = line[:-1] - line[1:]
    return np.concatenate([[beta], overlap > 0.0, overlap > _OVERLAP * tolerance**0.4])


def solver(tolerance: float) -> Solve:
    """Compile the integrator once, and restart it for every problem; the time before `_BEGIN` is not timed again."""
    integrator = _integrator(tolerance)
    starts: dict[float, np.ndarray] = {}

    def solve(beta: float, times: np.ndarray) -> Solved:
        if beta not in starts:
            starts[beta] = _begun(beta)
        integrator.time = _BEGIN
        integrator.state[:] = starts[beta]
        integrator.pars[:] = _gates(beta, starts[beta], tolerance)
        integrator.reset_cooldowns()
        assert times[0] == 0.0 and times[1] > _BEGIN
        *_, steps, _, states = integrator.propagate_grid(np.concatenate([[_BEGIN], times[1:]]), max_steps=_STEPS)
        if len(states) != times.size:
            return Solved(np.full((times.size, rest().size), np.nan), int(steps))
        states[0] = rest()
        return Solved(states, int(steps))

    return solve


def cases() -> list[Case]:
    """Return one row, whose evaluations are Taylor steps. In (u, v), the dashpot's jumps would be events at the same
    cost.
    """
    return [case_of("heyoka, events", "w", solver, rungs(1e-4, 1e-15, 3), rungs(1e-5, 1e-8, 1), 60)]
