"""The problem that all rows solve, stated independently of granchain: scaled equations in (u, v) and in w.

u is in units of the drive amplitude A0, time in units of 1/φ with φ² = K√A0/m. With the overlap d_c = u_c − u_{c+1},

    (u, v):   u̇ = v,   v̇_i = F_{i−1} − F_i,            F_c = [d_c]_+^{3/2} + λ ḋ_c H(d_c)
    w:        u̇_i = w_i + λ([d_{i−1}]_+ − [d_i]_+),     ẇ_i = [d_{i−1}]_+^{3/2} − [d_i]_+^{3/2}

The second form follows from the first with w = v − λ([d_{i−1}]_+ − [d_i]_+). Its right-hand side is continuous.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

#: Values of section 2 of the paper, in SI units.
MASS, YOUNG, POISSON, RADIUS, DAMPING, AMPLITUDE = 28.84e-3, 193e9, 0.3, 9.525e-3, 100.0, 5e-7
STIFFNESS = YOUNG * math.sqrt(2.0 * RADIUS) / (3.0 * (1.0 - POISSON**2))
RATE = math.sqrt(STIFFNESS * math.sqrt(AMPLITUDE) / MASS)
LAMBDA = DAMPING / (MASS * RATE)
BEADS = 11

#: The trajectory: drive frequency [Hz], periods from rest, and samples per period at which displacements are compared.
FREQUENCY, PERIODS, SAMPLES = 340.0, 20, 16
#: The curve: periods discarded, periods over which the peak is found, and scaled time between samples of the force.
PASSED, WATCHED, SPACING = 100, 20, 0.25

FORMS = ("uv", "w")


def beta_of(frequency: float) -> float:
    """Return the scaled drive rate β = 2πf/φ."""
    return 2.0 * math.pi * frequency / RATE


def period_of(frequency: float) -> float:
    """Return the drive period in scaled time."""
    return RATE / frequency


def curve_frequencies(points: int = 300) -> np.ndarray:
    """Return the drive frequencies of the curve [Hz]."""
    return np.linspace(30.0, 3000.0, points)


def trajectory_times() -> np.ndarray:
    """Return the scaled times of the trajectory's samples."""
    return period_of(FREQUENCY) * np.arange(PERIODS * SAMPLES + 1) / SAMPLES


def watched_times(frequency: float) -> np.ndarray:
    """Return 0 and then the equally spaced times at which the force is sampled in the last periods of a curve's point.
    """
    count = math.ceil(period_of(frequency) / SPACING)
    late = period_of(frequency) * (PASSED + np.arange(-2, WATCHED * count + 3) / count)
    return np.concatenate([[0.0], late])


def slope_uv_numpy(t: float, y: np.ndarray, beta: float) -> np.ndarray:
    """Return the right-hand side in (u, v), in plain NumPy, the version that you would write first."""
    n = y.size // 2
    u = np.concatenate([[math.sin(beta * t)], y[:n], [0.0]])
    v = np.concatenate([[beta * math.cos(beta * t)], y[n:], [0.0]])
    d, rate = u[:-1] - u[1:], v[:-1] - v[1:]
    force = np.maximum(d, 0.0) ** 1.5 + LAMBDA * rate * (d > 0.0)
    return np.concatenate([y[n:], force[:-1] - force[1:]])


def slope_w_numpy(t: float, y: np.ndarray, beta: float) -> np.ndarray:
    """Return the right-hand side in w, in NumPy."""
    n = y.size // 2
    u = np.concatenate([[math.sin(beta * t)], y[:n], [0.0]])
    d = np.maximum(u[:-1] - u[1:], 0.0)
    e = d**1.5
    return np.concatenate([y[n:] + LAMBDA * (d[:-1] - d[1:]), e[:-1] - e[1:]])


@dataclass(frozen=True)
class Solved:
    """States (times, 2N) in scaled units, and the number of evaluations of the right-hand side if it is known."""

    states: np.ndarray
    evaluations: int | None


def peak_of(force: np.ndarray) -> float:
    """Return the largest value of a smooth, equally sampled function: the top of the quartic through five samples."""
    c = int(np.argmax(force[2:-2])) + 2
    p = np.polyfit(np.arange(-2.0, 3.0), force[c - 2 : c + 3], 4)
    x = np.linspace(-1.0, 1.0, 2001)
    return float(np.polyval(p, x).max())


def output_peak(states: np.ndarray) -> float:
    """Return the largest elastic output force of states at `watched_times`, in scaled units."""
    n = states.shape[1] // 2
    return peak_of(np.maximum(states[1:, n - 1], 0.0) ** 1.5)
