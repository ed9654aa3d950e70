"""The right-hand sides of `problem`, compiled by Numba for SciPy and as callbacks for solvers in C and C++."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numba import cfunc, njit, types

from .problem import LAMBDA


@njit(cache=True, error_model="numpy")
def fill_uv(t, y, dy, n, beta):
    """Compute the right-hand side in (u, v); y and dy may be arrays or pointers."""
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
    """Compute the right-hand side in w."""
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
    """Call `fill_uv` and return a new array, for SciPy."""
    dy = np.empty_like(y)
    fill_uv(t, y, dy, y.size // 2, beta)
    return dy


@njit(cache=True)
def slope_w(t, y, beta):
    """Call `fill_w` and return a new array, for SciPy."""
    dy = np.empty_like(y)
    fill_w(t, y, dy, y.size // 2, beta)
    return dy


_POINTER = types.CPointer(types.float64)


def callback(form: str, order: str) -> Callable[..., None]:
    """Return a C callback for solvers that call compiled code; `order` lists its arguments, "t y dy p" or "dy t y p".

    p points to N, β and a counter of the evaluations.
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
