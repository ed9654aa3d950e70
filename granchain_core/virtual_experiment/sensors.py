"""Models of a rig's sensors: inertia of a tip, limited bandwidth, noise.

Equation   F_in = F_0 + m_tip ü_0: the input sensor sits between the shaker and a tip of mass m_tip that touches bead 1
           |H(f)|² = 1 / (1 + (f/f_c)⁴): Butterworth's low-pass of order 2, for both forces
           normal noise, independent from sample to sample
Source     Butterworth 1930; the rig: Zhang et al. 2016, figure 4
Note       The output sensor stands at the wall and does not move: its mass adds nothing. A wall that yields is the
           scene's knob `wall`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.signal import butter, sosfilt

from ..errors import BadInput
from ..inputs.checks import check_range

#: Order of the low-pass.
_ORDER = 2
#: Times 1/(2π f_c) after which the filter has forgotten how it began, to 1e-6.
_FORGOTTEN = 20.0


@dataclass(frozen=True)
class Sensors:
    """The sensors of a rig, in SI; by default perfect ones.

    Attributes
    ----------
    noise : float
        Standard deviation of a sample of either force [N].
    velocity_noise : float
        That of a sample of the driver's velocity [m/s].
    bandwidth : float
        Frequency f_c at which a force is recorded with 1/√2 of its amplitude [Hz].
    tip_mass : float
        Mass that moves with the driver in front of the input sensor [kg].
    rate : float
        Samples a second [Hz].

    Examples
    --------
    >>> from granchain_core.virtual_experiment import Sensors
    >>> Sensors(noise=0.01, bandwidth=20e3).words
    'noise 0.01 N, bandwidth 20000 Hz, 100000 samples/s'
    """

    noise: float = 0.0
    velocity_noise: float = 0.0
    bandwidth: float = math.inf
    tip_mass: float = 0.0
    rate: float = 100_000.0

    def __post_init__(self) -> None:
        for name, value, high in (("noise [N] =", self.noise, 1e6),
                                  ("velocity noise [m/s] =", self.velocity_noise, 1e3),
                                  ("tip mass [kg] =", self.tip_mass, 100.0)):
            check_range(name, value, 0.0, high)
        check_range("rate [Hz] =", self.rate, 1.0, 1e8)
        if not self.bandwidth >= 1.0:
            raise BadInput(f"bandwidth [Hz] = {self.bandwidth:g} is below 1; the nearest valid value is 1.")

    @property
    def words(self) -> str:
        """What is not perfect about them, and their rate."""
        parts = [(f"noise {self.noise:g} N", self.noise > 0.0),
                 (f"velocity noise {self.velocity_noise:g} m/s", self.velocity_noise > 0.0),
                 (f"bandwidth {self.bandwidth:g} Hz", math.isfinite(self.bandwidth)),
                 (f"tip of {self.tip_mass:g} kg before the input sensor", self.tip_mass > 0.0),
                 (f"{self.rate:g} samples/s", True)]
        return ", ".join(words for words, there in parts if there)

    @property
    def lead_in(self) -> float:
        """Time that a record has to begin earlier [s], so that the filter's own beginning is not in it."""
        return _FORGOTTEN / (2.0 * math.pi * self.bandwidth)

    def passed(self, force: np.ndarray, rate: float) -> np.ndarray:
        """A force (T,) at `rate` samples a second after the low-pass; as it is where f_c is above half of that."""
        if self.bandwidth >= 0.5 * rate:
            return force
        filtered: np.ndarray = sosfilt(butter(_ORDER, self.bandwidth, fs=rate, output="sos"), force)
        return filtered
