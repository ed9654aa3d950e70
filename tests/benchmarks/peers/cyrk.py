"""CyRK: Runge–Kutta in C++ with a compiled right-hand side."""

from __future__ import annotations

import importlib.util
from typing import Any

import numpy as np

from .. import compiled, problem
from ..case import Case, Solve, case_of, rest, rungs
from ..problem import Solved

METHODS = ("DOP853", "VERN8", "LSODA")


def missing() -> str:
    """Return the reason why it cannot run, or an empty text."""
    return "" if importlib.util.find_spec("CyRK") else "CyRK is not installed"


def solver(method: str, called: Any, tolerance: float) -> Solve:
    """Solve by nbsolve2_ivp with rtol = atol = tolerance."""
    from CyRK import nbsolve2_ivp

    def solve(beta: float, times: np.ndarray) -> Solved:
        data = np.array([problem.BEADS, beta, 0.0])
        found = nbsolve2_ivp(called.address, (0.0, float(times[-1])), rest(), method=method, t_eval=times, args=data,
                             rtol=tolerance, atol=tolerance, max_num_steps=0)
        states = np.array(found.y).T if found.success else np.full((times.size, rest().size), np.nan)
        found.free()
        return Solved(states, int(data[2]) or None)

    return solve


def cases() -> list[Case]:
    """Return three methods in both forms."""
    found = []
    for form in problem.FORMS:
        called = compiled.callback(form, "dy t y p")
        for method in METHODS:
            found.append(case_of(f"CyRK {method}", form, lambda t, m=method, c=called: solver(m, c, t),
                                 rungs(1e-3, 1e-13, 4), rungs(1e-6, 1e-10), 10))
    return found
