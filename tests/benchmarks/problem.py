"""The problem all rows solve, written down independently of granchain: scaled equations in (u, v) and in w.

u is in units of the drive amplitude A0, time in units of 1/φ with φ² = K√A0/m. With the overlap d_c = u_c − u_{c+1},

    (u, v):   u̇ = v,   v̇_i = F_{i−1} − F_i,            F_c = [d_c]_+^{3/2} + λ ḋ_c H(d_c)
    w:        u̇_i = w_i + λ([d_{i−1}]_+ − [d_i]_+),     ẇ_i = [d_{i−1}]_+^{3/2} − [d_i]_+^{3/2}

The second is the first with w = v − λ([d_{i−1}]_+ − [d_i]_+): its right-hand side is continuous.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numba import cfunc, njit, types

#: Section 2 of the paper, SI.
MASS, YOUNG, POISSON, RADIUS, DAMPING, AMPLITUDE = 28.84e-3, 193e9, 0.3, 9.525e-3, 100.0, 5e-7
_STIFFNESS = YOUNG * math.sqrt(2.0 * RADIUS) / (3.0 * (1.0 - POISSON**2))
RATE = math.sqrt(_STIFFNESS * math.sqrt(AMPLITUDE) / MASS)
LAMBDA = DAMPING / (MASS * RATE)
BEADS = 11

#: The trajectory: drive frequency [Hz], periods from rest, samples a period at which displacements are compared.
FREQUENCY, PERIODS, SAMPLES = 340.0, 20, 16
#: The curve: periods passed, periods over which the peak is taken, scaled time between samples of the force.
PASSED, WATCHED, SPACING = 100, 20, 0.25

FORMS = ("uv", "w")


def beta_of(frequency: float) -> float:
    """Scaled drive rate β = 2πf/φ."""
    return 2.0 * math.pi * frequency / RATE


def period_of(frequency: float) -> float:
    """Drive period in scaled time."""
    return RATE / frequency


def curve_frequencies(points: int = 300) -> np.ndarray:
    """The drive frequencies of the curve, Hz."""
    return np.linspace(30.0, 3000.0, points)


def trajectory_times() -> np.ndarray:
    """The times of the trajectory's samples."""
    return period_of(FREQUENCY) * np.arange(PERIODS * SAMPLES + 1) / SAMPLES


def watched_times(frequency: float) -> np.ndarray:
    """0 and then the times, equally spaced, at which the force is taken in the last periods of a curve's point."""
    count = math.ceil(period_of(frequency) / SPACING)
    late = period_of(frequency) * (PASSED + np.arange(-2, WATCHED * count + 3) / count)
    return np.concatenate([[0.0], late])


def slope_uv_numpy(t: float, y: np.ndarray, beta: float) -> np.ndarray:
    """Right-hand side in (u, v), in NumPy, as one would write it first."""
    n = y.size // 2
    u = np.concatenate([[math.sin(beta * t)], y[:n], [0.0]])
    v = np.concatenate([[beta * math.cos(beta * t)], y[n:], [0.0]])
    d, rate = u[:-1] - u[1:], v[:-1] - v[1:]
    force = np.maximum(d, 0.0) ** 1.5 + LAMBDA * rate * (d > 0.0)
    return np.concatenate([y[n:], force[:-1] - force[1:]])


def slope_w_numpy(t: float, y: np.ndarray, beta: float) -> np.ndarray:
    """Right-hand side in w, in NumPy."""
    n = y.size // 2
    u = np.concatenate([[math.sin(beta * t)], y[:n], [0.0]])
    d = np.maximum(u[:-1] - u[1:], 0.0)
    e = d**1.5
    return np.concatenate([y[n:] + LAMBDA * (d[:-1] - d[1:]), e[:-1] - e[1:]])


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


@dataclass(frozen=True)
class Solved:
    """States (times, 2N) in scaled units and evaluations of the right-hand side, where they are known."""

    states: np.ndarray
    evaluations: int | None


def peak_of(force: np.ndarray) -> float:
    """Largest value of a smooth function known at equal spacing: the quartic's top through five samples."""
    c = int(np.argmax(force[2:-2])) + 2
    p = np.polyfit(np.arange(-2.0, 3.0), force[c - 2 : c + 3], 4)
    x = np.linspace(-1.0, 1.0, 2001)
    return float(np.polyval(p, x).max())


def output_peak(states: np.ndarray) -> float:
    """Largest elastic output force of states at `watched_times`, in scaled units."""
    n = states.shape[1] // 2
    return peak_of(np.maximum(states[1:, n - 1], 0.0) ** 1.5)
