"""Naive solvers in plain Python, for pictures that compare them with granchain.

They are correct apart from their omissions: contacts are only tested at the ends of steps, and no event is located.
"""

from __future__ import annotations

from collections.abc import Callable
from math import cos, sin
from typing import Any

import numpy as np

from .oracle import PlainChain

Slope = Callable[[float, np.ndarray], np.ndarray]


def plain_slope(chain: PlainChain, push: tuple[np.ndarray, np.ndarray] | None = None) -> Slope:
    """Return the function (u̇, v̇) of a chain whose contacts act where their overlap is above zero.

    With a `push` (times and forces, interpolated linearly), that force acts on the first bead instead of the driver.
    """
    n, bodies, zeros = len(chain.masses), np.zeros((2, len(chain.masses) + 2)), np.zeros(len(chain.masses) + 1)
    static = np.vstack([chain.static, zeros])

    def slope(t: float, state: np.ndarray) -> np.ndarray:
        bodies[:, 0] = sin(chain.beta * t), chain.beta * cos(chain.beta * t)
        bodies[:, 1:-1] = state.reshape(2, n)
        overlap, rate = bodies[:, :-1] - bodies[:, 1:] + static
        force = np.where(overlap > 0.0, chain.springs * np.abs(overlap) ** 1.5 + chain.damping * rate, zeros)
        if push is not None:
            force[0] = np.interp(t, *push)
        return np.concatenate([state[n:], (force[:-1] - force[1:] - chain.foundation * state[:n]) / chain.masses])

    return slope


def rk4(slope: Slope, start: np.ndarray, first: float, step: float, count: int) -> np.ndarray:
    """Return the states (count + 1, size) of the classical Runge–Kutta method, including non-finite numbers."""
    out = np.empty((count + 1, len(start)))
    out[0] = start
    with np.errstate(all="ignore"):
        for i in range(count):
            t, y = first + i * step, out[i]
            k1 = slope(t, y)
            k2 = slope(t + 0.5 * step, y + 0.5 * step * k1)
            k3 = slope(t + 0.5 * step, y + 0.5 * step * k2)
            out[i + 1] = y + step / 6.0 * (k1 + 2.0 * (k2 + k3) + slope(t + step, y + step * k3))
    return out


def euler(slope: Slope, start: np.ndarray, step: float, count: int) -> np.ndarray:
    """Return the states (count + 1, size) of explicit Euler steps."""
    out = np.empty((count + 1, len(start)))
    out[0] = start
    for i in range(count):
        out[i + 1] = out[i] + step * slope(i * step, out[i])
    return out


def one_after_another(velocity: np.ndarray, damping: float, step: float, count: int) -> np.ndarray:
    """Return displacements (count + 1, N) between two walls; a loop moves each bead before it computes the next."""
    u, v = np.zeros(len(velocity) + 2), np.concatenate([[0.0], velocity, [0.0]])
    out = np.zeros((count + 1, len(velocity)))

    def force(c: int) -> float:
        overlap = u[c] - u[c + 1]
        return float(overlap**1.5 + damping * (v[c] - v[c + 1])) if overlap > 0.0 else 0.0

    for row in range(1, count + 1):
        for i in range(1, len(velocity) + 1):
            v[i] += step * (force(i - 1) - force(i))
            u[i] += step * v[i]
        out[row] = u[1:-1]
    return out


def observed_apart(chain: PlainChain, start: np.ndarray, periods: int, rtol: float) -> np.ndarray:
    """Return the largest difference (periods + 1,) between a chain and its observer, two separate runs of solve_ivp.

    Both start in `start`. The observer's first bead is driven by the driver's force recorded in the first run.
    """
    from scipy.integrate import solve_ivp

    n, looks = len(chain.masses), 1000
    times = chain.period / looks * np.arange(looks * periods + 1)
    tolerances: dict[str, Any] = {"rtol": rtol, "atol": 1e-3 * rtol}
    driven: Any = solve_ivp(plain_slope(chain), times[[0, -1]], start, t_eval=times, **tolerances)
    overlap = np.sin(chain.beta * times) - driven.y[0]
    rate = chain.beta * np.cos(chain.beta * times) - driven.y[n]
    push = np.where(overlap > 0.0, chain.springs[0] * np.abs(overlap) ** 1.5 + chain.damping * rate, 0.0)
    pushed = plain_slope(chain, (times, push))
    observer: Any = solve_ivp(pushed, times[[0, -1]], start, t_eval=times[::looks], **tolerances)
    return np.asarray(np.abs(observer.y[:n] - driven.y[:n, ::looks]).max(axis=0))
