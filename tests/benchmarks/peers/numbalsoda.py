"""numbalsoda: LSODA in C++ and DOP853 in Fortran with a compiled right-hand side, called from Python."""

from __future__ import annotations

import functools
import importlib.util
from typing import Any

import numpy as np

from .. import compiled, problem
from ..case import Case, Solve, case_of, rest, rungs
from ..problem import Solved

_STEPS = 100_000_000


def missing() -> str:
    """Return the reason why it cannot run, or an empty text."""
    return "" if importlib.util.find_spec("numbalsoda") else "numbalsoda is not installed"


@functools.cache
def _callback(form: str) -> Any:
    return compiled.callback(form, "t y dy p")


def address(form: str) -> int:
    """Return the address of the compiled right-hand side."""
    return int(_callback(form).address)


def solver(method: str, function: int, tolerance: float) -> Solve:
    """Solve by numbalsoda's `lsoda` or `dop853` with rtol = atol = tolerance."""
    import numbalsoda

    call = getattr(numbalsoda, method)

    def solve(beta: float, times: np.ndarray) -> Solved:
        data = np.array([problem.BEADS, beta, 0.0])
        states, success = call(function, rest(), times, data, tolerance, tolerance, _STEPS)
        return Solved(states if success else np.full_like(states, np.nan), int(data[2]))

    return solve


def cases() -> list[Case]:
    """Return LSODA and DOP853 in both forms."""
    found = []
    for form in problem.FORMS:
        here = address(form)
        for method in ("lsoda", "dop853"):
            found.append(case_of(f"numbalsoda {method}", form, lambda t, m=method, a=here: solver(m, a, t),
                                 rungs(1e-3, 1e-13, 4), rungs(1e-6, 1e-10), 5))
    return found
