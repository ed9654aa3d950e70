"""A record that starts before the shaker does: a drive period at rest, then a shaker whose amplitude rises.

Equation   u_0(t) = A0 sin(ωτ) s(τ),   τ = t − 1/f ≥ 0,   s = sin²(π τ f/4) over two periods, then 1
Note       Chain and driver start at rest, so `granchain run --drive` on the record needs no other start. Nothing jumps:
           the driver's acceleration starts at zero.
"""

from __future__ import annotations

import math

import numpy as np

from ..errors import BadInput
from ..execution.stop import Stop
from ..experiment.sensors import Sensors
from ..prescribed_drive import Signal, drive
from ..prescribed_drive.signal import KNOTS
from ..results.recorded_motion import MOST_RECORDED
from ..scene import Scene

#: Drive periods at rest, and drive periods over which the amplitude rises.
_AT_REST, _RISING = 1.0, 2.0
#: Highest frequency in the formula of the rising drive, in drive frequencies.
_HIGHEST = 2.0


def from_rest(scene: Scene, times: np.ndarray, rate: float, sensors: Sensors,
              stop: Stop | None) -> tuple[np.ndarray, list[np.ndarray]]:
    """Return perfect velocity, and both forces as the sensors record them, at `times` [s] from 0 on.

    `rate` is the number of model samples per second that the forces need [Hz].
    """
    signal = _rising(scene, float(times[-1]) + 1.0 / sensors.rate, rate)
    if len(signal.time) * scene.N > MOST_RECORDED:
        raise BadInput(f"{len(signal.time)} samples of the model for {scene.N} beads are more than {MOST_RECORDED:.0e} "
                       "values; take fewer periods, a smaller rate or a smaller bandwidth.")
    motion = drive(scene, signal, stop=stop)
    tip = sensors.tip_mass * np.gradient(signal.velocity, signal.time)
    forces = [sensors.passed(motion.time, force, times) for force in (motion.input_force + tip, motion.output_force)]
    return np.interp(times, signal.time, signal.velocity), forces


def _rising(scene: Scene, duration: float, rate: float) -> Signal:
    """Return the motion of the shaker over `duration` [s], with at least `rate` knots per second [Hz]."""
    omega, begin, rise = 2.0 * math.pi * scene.f, _AT_REST / scene.f, _RISING / scene.f

    def window(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        place = np.clip((t - begin) / rise, 0.0, 1.0)
        return np.sin(0.5 * np.pi * place) ** 2, 0.5 * np.pi / rise * np.sin(np.pi * place)

    def velocity(t: np.ndarray) -> np.ndarray:
        (height, slope), turn = window(t), omega * (t - begin)
        return np.asarray(scene.A0 * (omega * np.cos(turn) * height + np.sin(turn) * slope))

    def displacement(t: np.ndarray) -> np.ndarray:
        return np.asarray(scene.A0 * np.sin(omega * (t - begin)) * window(t)[0])

    return Signal.of(velocity, displacement, duration, max(_HIGHEST * scene.f, rate / KNOTS),
                     f"{scene.f:g} Hz, rising from rest")
