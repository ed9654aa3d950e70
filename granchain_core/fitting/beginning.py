"""The start of a record that does not begin at rest: a state of the settled motion, at the drive phase of the record.

Equation   v(t) = A0 ω cos(ωt + φ) by least squares over the record: φ is the drive phase at its first sample, and
           A0 sin φ is the displacement of the driver there
Note       The velocity does not show in which of its n drive periods a motion of period n begins; the measured forces
           do, by the least sum of squares.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from ..errors import BadInput
from ..execution.stop import Stop
from ..experiment import Series
from ..experiment.compare_forces import FORCES
from ..experiment.sensors import Sensors
from ..results.run import Run
from ..scene import Scene
from ..scene.refusals import refuse_undriven
from ..scene.state import State
from ..steady.settling.settle import settle
from .trains import Train

#: Samples per drive period of the settled motion, between which the state is interpolated.
_SAMPLES = 2048
#: Largest fraction of the measured signal, in root mean square, that may deviate from a sine of the scene's frequency.
_NO_SINE = 0.1
#: Relative difference between the record's drive amplitude and the scene's above which a sentence reports it.
_OTHER_AMPLITUDE = 0.02
#: Ratio of the first sample to the largest one above which a record counts as beginning in motion.
_IN_MOTION = 0.05


@dataclass(frozen=True, eq=False)
class Beginning:
    """The state of the chain and the driver's displacement [m] at a record's first sample; `words` say their origin."""

    state: State
    displacement: float
    words: str


def settled_beginning(scene: Scene, series: Series, sensors: Sensors | None = None,
                      stop: Stop | None = None) -> Beginning:
    """Compute the settled motion of a scene at the drive phase at which a record begins.

    Parameters
    ----------
    scene : Scene
        The driven chain, with the frequency and the amplitude of the record.
    series : Series
        A series with the velocity or the displacement of the driver.
    sensors : Sensors, optional
        The sensors of the measured forces; by default perfect ones.
    stop : Stop, optional
        Ends the computation when another thread sets it.

    Raises
    ------
    BadInput
        No drive, neither velocity nor displacement, a drive that is not a sine of the scene's frequency, or a settled
        motion that is not periodic.
    Cancelled
        `stop` was set.
    """
    refuse_undriven(scene)
    phase, amplitude = _drive_phase(scene, series)
    settled = settle(scene, samples=_SAMPLES, stop=stop)
    if settled.regime.name != "periodic":
        raise BadInput(f"The settled motion of {scene.name} is {settled.regime.name}: a drive phase does not determine "
                       "its state. Start at rest, or in the state of a recorded run.")
    run, periods = settled.run, settled.regime.period or 1
    begins = [(phase + turn) / scene.f for turn in range(periods)]
    best = int(np.argmin(_squares(series, run, begins, sensors or Sensors()))) if periods > 1 else 0
    time = run.time - run.time[0]
    moving = CubicHermiteSpline(time, run.displacement, run.velocity)
    state = State(moving(begins[best]), moving.derivative()(begins[best]), phase)
    words = f"the settled motion at drive phase {phase:.4f}"
    if periods > 1:
        known = any(getattr(series, name) is not None for name in FORCES)
        words += f" of drive period {best + 1} of {periods}{'' if known else ', chosen without a measured force'}"
    if abs(amplitude / scene.drive_amplitude - 1.0) > _OTHER_AMPLITUDE:
        words += (f"; the record's drive has the amplitude {amplitude:.4g} m and the scene's has "
                  f"{scene.drive_amplitude:.4g} m, so this is a different motion")
    return Beginning(state, scene.drive_amplitude * math.sin(2.0 * math.pi * phase), words)


def _drive_phase(scene: Scene, series: Series) -> tuple[float, float]:
    """The drive phase at the first sample, as a fraction of a period, and the amplitude of the drive [m]."""
    name, values = (("velocity", series.velocity) if series.velocity is not None else
                    ("displacement", series.displacement))
    if values is None:
        raise BadInput("The series has neither velocity nor displacement of the driver, so its phase is not known.")
    omega, time = 2.0 * math.pi * scene.f, series.time - series.time[0]
    waves = np.stack([np.cos(omega * time), np.sin(omega * time), np.ones(len(time))], axis=1)
    solved = np.linalg.lstsq(waves, values, rcond=None)[0]
    left = float(np.std(values - waves @ solved)) / (float(np.std(values)) or 1.0)
    if not left <= _NO_SINE:
        raise BadInput(f"The {name} is not a sine of f = {scene.f:g} Hz: {100.0 * left:.3g} % of it is something else, "
                       "so its phase is not known; start at rest, or set the scene's f to that of the record.")
    cosine, sine = float(solved[0]), float(solved[1])
    size = math.hypot(cosine, sine)
    angle = math.atan2(-sine, cosine) if name == "velocity" else math.atan2(cosine, sine)
    return angle / (2.0 * math.pi) % 1.0, size / omega if name == "velocity" else size


def _squares(series: Series, run: Run, begins: list[float], sensors: Sensors) -> list[float]:
    """For each beginning [s] on the orbit, the sum of squared differences between its forces and the measured ones."""
    time, squares = series.time - series.time[0], [0.0] * len(begins)
    width = float(np.median(np.diff(time)))
    for name in FORCES:
        measured = getattr(series, name)
        if measured is None:
            continue
        train = Train.of(run, name)
        for i, begin in enumerate(begins):
            squares[i] += float(((train.recorded(time + begin, width, sensors) - measured) ** 2).sum())
    return squares


def in_motion(series: Series, rest_force: float) -> str:
    """A sentence if the first sample shows that the chain is already moving; empty if it does not.

    `rest_force` is the force of the contacts at rest, the scene's F0 [N].
    """
    moving = []
    for name, rest in (("velocity", 0.0), *((force, rest_force) for force in FORCES)):
        values = getattr(series, name)
        if values is not None and abs(values[0] - rest) > _IN_MOTION * float(np.abs(values - rest).max()):
            moving.append(name.replace("_", " "))
    if not moving:
        return ""
    return (f"The record begins in motion: the first sample of its {' and '.join(moving)} is not that of a chain at "
            "rest. The chain starts at rest and the driver at displacement 0, so at least the first part differs; "
            "--start settled begins on the settled motion.")
