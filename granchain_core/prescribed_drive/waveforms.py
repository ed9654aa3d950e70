"""Formulas of the driver's motion over time [s]: a chirp, a burst, two tones, noise.

Each function returns two functions of time: velocity [m/s] and displacement [m].
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

OverTime = Callable[[np.ndarray], np.ndarray]

#: Number of sines in the noise.
_SINES = 200


def chirp(amplitude: float, low: float, high: float, duration: float) -> tuple[OverTime, OverTime]:
    """A linear chirp, A sin 2π(f₀ t + (f₁ − f₀) t²/2T)."""
    def phase(t: np.ndarray) -> np.ndarray:
        return np.asarray(2.0 * np.pi * (low * t + 0.5 * (high - low) * t * t / duration))

    def velocity(t: np.ndarray) -> np.ndarray:
        rate = low + (high - low) * t / duration
        return np.asarray(2.0 * np.pi * amplitude * rate * np.cos(phase(t)))

    def displacement(t: np.ndarray) -> np.ndarray:
        return np.asarray(amplitude * np.sin(phase(t)))

    return velocity, displacement


def burst(amplitude: float, frequency: float, periods: float) -> tuple[OverTime, OverTime]:
    """A sin 2πft · sin² πft/n for n periods of f, then rest."""
    end, omega = periods / frequency, 2.0 * np.pi * frequency

    def velocity(t: np.ndarray) -> np.ndarray:
        window, slope = np.sin(np.pi * t / end) ** 2, np.pi / end * np.sin(2.0 * np.pi * t / end)
        moving = omega * np.cos(omega * t) * window + np.sin(omega * t) * slope
        return np.where(t <= end, amplitude * moving, 0.0)

    def displacement(t: np.ndarray) -> np.ndarray:
        return np.where(t <= end, amplitude * np.sin(omega * t) * np.sin(np.pi * t / end) ** 2, 0.0)

    return velocity, displacement


def tones(amplitude: float, first: float, second: float, ratio: float) -> tuple[OverTime, OverTime]:
    """A (sin 2πf₁t + r sin 2πf₂t)/(1 + r)."""
    def velocity(t: np.ndarray) -> np.ndarray:
        moving = first * np.cos(2.0 * np.pi * first * t) + ratio * second * np.cos(2.0 * np.pi * second * t)
        return np.asarray(2.0 * np.pi * amplitude / (1.0 + ratio) * moving)

    def displacement(t: np.ndarray) -> np.ndarray:
        return np.asarray(amplitude / (1.0 + ratio) * (np.sin(2.0 * np.pi * first * t)
                                                       + ratio * np.sin(2.0 * np.pi * second * t)))

    return velocity, displacement


def noise(amplitude: float, low: float, high: float, seed: int) -> tuple[OverTime, OverTime]:
    """A sum of sines with random frequencies and phases and the rms A/√2, which grows over two periods of f₀."""
    rng = np.random.default_rng(seed)
    omega = 2.0 * np.pi * rng.uniform(low, high, _SINES)
    phase, size, rise = rng.uniform(0.0, 2.0 * np.pi, _SINES), amplitude / math.sqrt(_SINES), 2.0 / low

    def window(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The fraction to which the noise has grown, and its rate."""
        part = np.clip(t / rise, 0.0, 1.0)
        return np.sin(0.5 * np.pi * part) ** 2, 0.5 * np.pi / rise * np.sin(np.pi * part)

    def velocity(t: np.ndarray) -> np.ndarray:
        (height, slope), total, rising = window(t), np.zeros_like(t), t < rise
        for w, p in zip(omega, phase, strict=True):
            total += w * np.cos(w * t + p) * height
            total[rising] += np.sin(w * t[rising] + p) * slope[rising]
        return size * total

    def displacement(t: np.ndarray) -> np.ndarray:
        total = np.zeros_like(t)
        for w, p in zip(omega, phase, strict=True):
            total += np.sin(w * t + p)
        return size * total * window(t)[0]

    return velocity, displacement
