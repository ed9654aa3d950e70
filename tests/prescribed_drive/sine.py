"""The chain and the prescribed sine of several tests."""

from __future__ import annotations

import numpy as np

from granchain_core import Signal, scene

CHAIN = scene("sec2").evolve(N=3)


def sine(amplitude: float, frequency: float, periods: float) -> Signal:
    """Return the harmonic drive as a signal."""
    omega = 2.0 * np.pi * frequency
    return Signal.of(lambda t: amplitude * omega * np.cos(omega * t), lambda t: amplitude * np.sin(omega * t),
                     periods / frequency, frequency, "sine")
