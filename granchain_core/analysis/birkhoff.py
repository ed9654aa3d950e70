"""Weighted Birkhoff averages along an orbit of a map.

Equation   ⟨h⟩ = Σ_k ŵ_k h_k,  ŵ_k = w(t_k) / Σ w,  t_k = (k + 1) / (P + 1),  w(t) = exp(−1 / (t (1 − t)))
           the Fourier coefficient at the frequency ν per period: ⟨x e^{−2πiνk}⟩
Source     Das, Saiki, Sander & Yorke 2016, 2017; the weight is their bump function of order 1. The frequency from the
           phases of two halves is the main idea of Laskar 1993
Note       Along a smooth torus with a Diophantine rotation, the average converges faster than any power of 1/P, whereas
           an average with equal weights converges as 1/P. In chaos it is no better than 1/√P.
"""

from __future__ import annotations

import functools

import numpy as np

#: Number of corrections of a line's frequency: each leaves a small fraction of the error, the last only rounding.
_CORRECTIONS = 3


@functools.lru_cache(maxsize=16)
def weights(count: int) -> np.ndarray:
    """The weights ŵ (count,) of an average over `count` points; their sum is 1."""
    t = np.arange(1, count + 1) / (count + 1)
    bump = np.exp(-1.0 / (t * (1.0 - t)))
    bump /= bump.sum()
    bump.flags.writeable = False
    return bump


def average(values: np.ndarray) -> np.ndarray:
    """The weighted average over the first axis of values (P, …)."""
    return np.asarray(weights(len(values)) @ values)


def turns(frequency: float, count: int) -> np.ndarray:
    """e^{−2πi ν k} (count,) for the frequency ν per period."""
    return np.asarray(np.exp(-2j * np.pi * frequency * np.arange(count)))


def fourier_coefficient(states: np.ndarray, frequency: float) -> np.ndarray:
    """The Fourier coefficients (D,) of states (P, D) at a frequency per period."""
    factors = weights(len(states)) * turns(frequency, len(states))
    return np.asarray(factors.real @ states + 1j * (factors.imag @ states))  # a complex copy of the states takes longer


def refined_frequency(states: np.ndarray, frequency: float) -> float:
    """Compute the frequency ν per period of the spectral line of states (P, D) that is within 1/P of `frequency`.

    The coefficients of the two halves differ by the phase 2π (ν − frequency) P/2.
    """
    half = len(states) // 2
    for _ in range(_CORRECTIONS):
        first = fourier_coefficient(states[:half], frequency)
        second = fourier_coefficient(states[half : 2 * half], frequency) * np.exp(-2j * np.pi * frequency * half)
        frequency += float(np.angle(np.vdot(first, second))) / (2.0 * np.pi * half)
    return frequency
