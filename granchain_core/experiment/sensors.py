"""Model of a rig's sensors: tip inertia, limited bandwidth, noise.

Equation   F_in = F_0 + m_tip ü_0: the input sensor sits between the shaker and a tip of mass m_tip that touches bead 1
           H(f) = 1 / (1 + √2 i f/f_c − (f/f_c)²),   |H(f)|² = 1 / (1 + (f/f_c)⁴): Butterworth's low-pass of order 2
           y = 2 Re b z,   ż = s z + F,   s = 2π f_c (−1 + i)/√2,   b = (2π f_c)² / (s − s̄): the same over time
           normal noise, independent from sample to sample
Source     Butterworth 1930; the rig: Zhang et al. 2016, figure 4
Note       The low-pass is an analogue filter, the same for both forces. A force is given at nodes and is piecewise
           linear, with jumps allowed. For such a force, z is advanced without error from node to node, at any spacing.
           The only error left is that of linear interpolation: for a force with f_s nodes per second, the amplitude of
           a line at f is too small by the fraction (π f/f_s)²/3. The output sensor is at the wall and does not move, so
           its mass has no effect. A wall that yields is the scene's knob `wall`.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from itertools import accumulate

import numpy as np

from ..errors import BadInput
from ..inputs.checks import check_range

#: Nodes of a force per time 1/f_c that the low-pass needs: linear interpolation makes a line of the force at f_c too
#: small by (π/128)²/3, which is 0.02 %.
SAMPLES_PER_BANDWIDTH = 128
#: Times 1/(2π f_c) after which the filter has forgotten its initial state, to 1e-6.
_FORGOTTEN = 20.0
#: Exponents below which the second integral of the exponential is computed as a series, since its formula cancels.
_SMALL = 1e-3


@dataclass(frozen=True)
class Sensors:
    """The sensors of a rig, in SI units; perfect by default.

    Attributes
    ----------
    noise : float
        Standard deviation of a sample of either force [N].
    velocity_noise : float
        Standard deviation of a sample of the driver's velocity [m/s].
    bandwidth : float
        Frequency f_c at which a force is recorded with 1/√2 of its amplitude [Hz].
    tip_mass : float
        Mass that moves with the driver in front of the input sensor [kg].
    rate : float
        Samples per second [Hz].

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
        """Description of the sensors' imperfections and rate."""
        parts = [(f"noise {self.noise:g} N", self.noise > 0.0),
                 (f"velocity noise {self.velocity_noise:g} m/s", self.velocity_noise > 0.0),
                 (f"bandwidth {self.bandwidth:g} Hz", math.isfinite(self.bandwidth)),
                 (f"tip of {self.tip_mass:g} kg before the input sensor", self.tip_mass > 0.0),
                 (f"{self.rate:g} samples/s", True)]
        return ", ".join(words for words, present in parts if present)

    @property
    def filters(self) -> bool:
        """Whether the bandwidth is limited."""
        return math.isfinite(self.bandwidth)

    @property
    def lead_in(self) -> float:
        """Time by which a record has to start earlier [s], so that it does not contain the filter's own transient."""
        return _FORGOTTEN / (2.0 * math.pi * self.bandwidth)

    @property
    def shortest_pulse(self) -> float:
        """Duration of the low-pass's impulse response, up to its first zero [s]: no recorded pulse is shorter."""
        return 1.0 / (math.sqrt(2.0) * self.bandwidth)

    def response(self, frequency: float) -> complex:
        """Return H(f), the low-pass's complex gain (amplitude and phase) for a sine of frequency f [Hz]."""
        part = frequency / self.bandwidth
        return 1.0 / complex(1.0 - part * part, math.sqrt(2.0) * part)

    def passed(self, time: np.ndarray, force: np.ndarray, at: np.ndarray, periodic: bool = False) -> np.ndarray:
        """Return a force after the low-pass, at the times `at` [s] from the first node on.

        Parameters
        ----------
        time, force : numpy.ndarray, shape (T,)
            Nodes of the force: times [s], not descending, and values [N]; a jump is two nodes at one time.
        at : numpy.ndarray
            Times [s]; later than the last node only if the force is periodic.
        periodic : bool
            Whether the force repeats after its last node. If not, it was constant before its first one.
        """
        if periodic:
            length = float(time[-1] - time[0])
            at = time[0] + np.mod(at - time[0], length)
        left = np.clip(np.searchsorted(time, at, side="right") - 1, 0, len(time) - 2)
        since, step = at - time[left], time[left + 1] - time[left]
        if not self.filters:
            part = np.divide(since, step, out=np.zeros_like(since), where=step > 0.0)
            return np.asarray(force[left] + part * (force[left + 1] - force[left]))
        pole = 2.0 * math.pi * self.bandwidth * cmath.rect(1.0, 0.75 * math.pi)
        scale = (2.0 * math.pi * self.bandwidth) ** 2 / (pole - pole.conjugate())
        steps = np.diff(time)
        kept, first, second = _integrals(pole, steps)
        added = steps * (force[:-1] * (first - second) + force[1:] * second)
        begin = -force[0] / pole
        if periodic:  # z repeats after a period: it equals what a period adds plus the part of itself that is kept
            once = _advanced(0.0, kept, added)[-1]
            begin = once / (1.0 - cmath.exp(pole * length))
        state = _advanced(begin, kept, added)
        kept, first, second = _integrals(pole, since)
        end = force[left] + np.divide(since, step, out=np.zeros_like(since), where=step > 0.0) * (
            force[left + 1] - force[left])
        response = kept * state[left] + since * (force[left] * (first - second) + end * second)
        return np.asarray(2.0 * (scale * response).real)


def _advanced(begin: complex, kept: np.ndarray, added: np.ndarray) -> np.ndarray:
    """Return the states (T,) of z ← kept · z + added, starting at `begin`."""
    return np.array(list(accumulate(zip(kept.tolist(), added.tolist(), strict=True),
                                    lambda z, one: one[0] * z + one[1], initial=complex(begin))))


def _integrals(pole: complex, step: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return e^q, φ₁ = (e^q − 1)/q and φ₂ = (e^q − 1 − q)/q² for q = pole · step: over a step h, z gains h (F_0 (φ₁ −
    φ₂) + F_1 φ₂).
    """
    q = pole * step
    small = np.abs(q) < _SMALL
    safe = np.where(small, 1.0, q)
    series = 1.0 + q / 2.0 * (1.0 + q / 3.0 * (1.0 + q / 4.0))
    first = np.where(small, series, np.expm1(safe) / safe)
    second = np.where(small, 0.5 * (1.0 + q / 3.0 * (1.0 + q / 4.0 * (1.0 + q / 5.0))), (first - 1.0) / safe)
    return np.exp(q), first, second
