"""SciPy: solve_ivp and odeint, with right-hand sides in NumPy and compiled by Numba."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.integrate import odeint, solve_ivp

from .. import compiled, problem
from ..case import Case, Solve, case_of, rest, rungs
from ..problem import Solved

_COMPILED = {"uv": compiled.slope_uv, "w": compiled.slope_w}
_NUMPY = {"uv": problem.slope_uv_numpy, "w": problem.slope_w_numpy}
#: solve_ivp refuses tolerances below this.
_LEAST_RTOL = 3e-14


def missing() -> str:
    """Return an empty text: SciPy is always installed."""
    return ""


def ivp(method: str, slope: Callable[..., np.ndarray], tolerance: float) -> Solve:
    """Solve by solve_ivp with rtol = atol = tolerance; states are in units of A0, so that atol is meaningful."""

    def solve(beta: float, times: np.ndarray) -> Solved:
        found = solve_ivp(slope, (0.0, times[-1]), rest(), method, times, args=(beta,), rtol=max(tolerance, _LEAST_RTOL),
                          atol=tolerance)
        if not found.success:
            return Solved(np.full((times.size, rest().size), np.nan), found.nfev)
        return Solved(found.y.T, found.nfev)

    return solve


def ode(slope: Callable[..., np.ndarray], tolerance: float) -> Solve:
    """Solve by odeint (LSODA) with rtol = atol = tolerance."""

    def solve(beta: float, times: np.ndarray) -> Solved:
        states, info = odeint(slope, rest(), times, (beta,), rtol=tolerance, atol=tolerance, tfirst=True,
                              full_output=True, mxstep=10_000_000)
        return Solved(states, int(info["nfe"][-1]))

    return solve


def cases() -> list[Case]:
    """Return all methods, compiled, in both forms, and LSODA with plain NumPy, the version that you would write first.
    """
    found = []
    for form in problem.FORMS:
        slope = _COMPILED[form]
        found.append(case_of("scipy odeint, compiled", form, lambda t, s=slope: ode(s, t), rungs(1e-3, 1e-13),
                             rungs(1e-6, 1e-9), 20))
        for method in ("RK45", "DOP853", "LSODA"):
            found.append(case_of(f"scipy {method}, compiled", form, lambda t, s=slope, m=method: ivp(m, s, t),
                                 rungs(1e-3, 1e-13), rungs(1e-7, 1e-9, 1), 60))
        found.append(case_of("scipy LSODA, NumPy", form, lambda t, s=_NUMPY[form]: ivp("LSODA", s, t),
                             rungs(1e-3, 1e-13), rungs(1e-7, 1e-9, 1), 60))
    return found
