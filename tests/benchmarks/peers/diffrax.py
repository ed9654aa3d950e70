"""diffrax: adaptive Runge–Kutta in JAX, with 64 bits, compiled for the CPU."""

from __future__ import annotations

import functools
import importlib.util
from typing import Any

import numpy as np

from .. import problem
from ..case import Case, Solve, case_of, rest, rungs
from ..problem import Solved

METHODS = ("Tsit5", "Dopri8")
_STEPS = 1 << 24


def missing() -> str:
    """Return the reason why it cannot run, or an empty text."""
    return "" if importlib.util.find_spec("diffrax") else "diffrax is not installed"


def slope(form: str) -> Any:
    """Return the right-hand side in jax.numpy. Only values are needed, so the root's argument may be 0."""
    import jax.numpy as jnp

    def overlaps(t: Any, u: Any, beta: Any) -> Any:
        line = jnp.concatenate([jnp.sin(beta * t)[None], u, jnp.zeros(1)])
        return line[:-1] - line[1:]

    def in_w(t: Any, y: Any, beta: Any) -> Any:
        n = y.shape[0] // 2
        d = jnp.maximum(overlaps(t, y[:n], beta), 0.0)
        e = d * jnp.sqrt(d)
        return jnp.concatenate([y[n:] + problem.LAMBDA * (d[:-1] - d[1:]), e[:-1] - e[1:]])

    def in_uv(t: Any, y: Any, beta: Any) -> Any:
        n = y.shape[0] // 2
        gap = overlaps(t, y[:n], beta)
        d = jnp.maximum(gap, 0.0)
        v = jnp.concatenate([beta * jnp.cos(beta * t)[None], y[n:], jnp.zeros(1)])
        force = d * jnp.sqrt(d) + jnp.where(gap > 0.0, problem.LAMBDA * (v[:-1] - v[1:]), 0.0)
        return jnp.concatenate([y[n:], force[:-1] - force[1:]])

    return {"uv": in_uv, "w": in_w}[form]


@functools.cache
def _compiled(form: str, method: str) -> Any:
    """Return a jitted diffeqsolve; it is compiled again for another number of times, but not for another tolerance."""
    import diffrax
    import jax
    import jax.numpy as jnp

    jax.config.update("jax_enable_x64", True)
    term = diffrax.ODETerm(slope(form))

    @jax.jit
    def run(beta: Any, times: Any, tolerance: Any) -> Any:
        found = diffrax.diffeqsolve(
            term, getattr(diffrax, method)(), 0.0, times[-1], None, jnp.asarray(rest()), beta, max_steps=_STEPS,
            saveat=diffrax.SaveAt(ts=times), stepsize_controller=diffrax.PIDController(tolerance, tolerance))
        return found.ys, found.stats["num_steps"]

    return run


def solver(form: str, method: str, tolerance: float) -> Solve:
    """Solve by diffeqsolve with rtol = atol = tolerance; evaluations are attempted steps times stages."""
    run, stages = _compiled(form, method), {"Tsit5": 6, "Dopri8": 13}[method]

    def solve(beta: float, times: np.ndarray) -> Solved:
        states, steps = run(beta, times, tolerance)
        return Solved(np.asarray(states), stages * int(steps))

    return solve


def cases() -> list[Case]:
    """Return two methods in both forms. A point of the curve is run once before it is timed, so that compiling is not
    timed.
    """
    return [case_of(f"diffrax {method}", form, lambda t, f=form, m=method: solver(f, m, t), rungs(1e-3, 1e-12, 1),
                    rungs(1e-7, 1e-9, 1), 60, warm=1)
            for form in problem.FORMS for method in METHODS]
