"""The right-hand sides of `problem`, compiled by Numba: for SciPy, and as callbacks for solvers written in C and C++.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numba import cfunc, njit, types

from .problem import LAMBDA


@njit(cache=True, error_model="numpy")
def fill_uv(t, y, dy, n, beta):
    """Right-hand side in (u, v), compiled; y and dy are anything that can be indexed."""
    u, v = math.sin(beta * t), beta * math.cos(beta * t)
    right, right_v = y[0], y[n]
    d = u - right
    left = d * math.sqrt(d) + LAMBDA * (v - right_v) if d > 0.0 else 0.0
    for i in range(n):
        u, v = right, right_v
        right, right_v = (y[i + 1], y[n + i + 1]) if i + 1 < n else (0.0, 0.0)
        d = u - right
        force = d * math.sqrt(d) + LAMBDA * (v - right_v) if d > 0.0 else 0.0
        dy[i] = v
        dy[n + i] = left - force
        left = force


@njit(cache=True, error_model="numpy")
def fill_w(t, y, dy, n, beta):
    """Right-hand side in w, compiled."""
    right = y[0]
    left_d = max(math.sin(beta * t) - right, 0.0)
    left = left_d * math.sqrt(left_d)
    for i in range(n):
        u, right = right, y[i + 1] if i + 1 < n else 0.0
        d = max(u - right, 0.0)
        e = d * math.sqrt(d)
        dy[i] = y[n + i] + LAMBDA * (left_d - d)
        dy[n + i] = left - e
        left_d, left = d, e


@njit(cache=True)
def slope_uv(t, y, beta):
    """`fill_uv` that returns a new array, for SciPy."""
    dy = np.empty_like(y)
    fill_uv(t, y, dy, y.size // 2, beta)
    return dy


@njit(cache=True)
def slope_w(t, y, beta):
    """`fill_w` that returns a new array, for SciPy."""
    dy = np.empty_like(y)
    fill_w(t, y, dy, y.size // 2, beta)
    return dy


_POINTER = types.CPointer(types.float64)


def callback(form: str, order: str) -> Callable[..., None]:
    """A C callback for solvers that call compiled code; `order` names its arguments, "t y dy p" or "dy t y p".

    p points to N, β and a counter of evaluations.
    """
    fill = {"uv": fill_uv, "w": fill_w}[form]
    if order == "t y dy p":

        @cfunc(types.void(types.float64, _POINTER, _POINTER, _POINTER))
        def called(t, y, dy, p):
            p[2] += 1.0
            fill(t, y, dy, int(p[0]), p[1])

        return called

    @cfunc(types.void(_POINTER, types.float64, _POINTER, _POINTER))
    def called_dy_first(dy, t, y, p):
        p[2] += 1.0
        fill(t, y, dy, int(p[0]), p[1])

    return called_dy_first
