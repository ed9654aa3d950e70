"""The pulse ratio of a periodic orbit, strong pushes per drive period, from the orbit alone; for 1:1, in step or not.

*Resonance* is a term for curves (steady/curve/resonance.py), whose rule may disagree with this one; docs/orbits.md
gives both rules and their thresholds. Source: Zhang et al. 2016, sections 2 and 3. In a 1:n resonance, the driver gives
one strong push every n periods, at the moment at which the pulse reflected by the wall comes back to it. In an
anti-resonance, pulses interfere destructively, and every period has one push, none much stronger than the others.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from ..former_names import with_former_names
from ..integrate import Engine, dop853_setting
from ..integrate.methods import DOP853
from ..results.regime import Regime
from ..results.run import GIVEN_STATE, Cost, Run, run_from
from ..steady.curve.resonance import END_FRACTION, STOP_BAND_FRACTION, pushes
from .orbit import Orbit

#: [response] The reflected pulse of a 1:1 orbit is in step if bead 1, just before the strongest push, approaches the
#: driver with at least this fraction of the drive's largest speed 2πf A0. No orbit of `rig` (20 to 160 Hz in steps of
#: 1) is classified differently with 0.2 to 1/3; with 0.4, three of 102 are. Of 261 orbits of `sec2` (60 to 3000 Hz in
#: steps of 10), one is classified differently with 0.3, three with 0.4 and four with 0.25.
RETURNS_IN_STEP = 1.0 / 3.0
#: [no threshold] Samples per period: events are placed to about a degree of the drive.
_SAMPLES = 480
#: [no threshold] Tolerance of a step.
_TOLERANCE = 1e-9


@with_former_names
@dataclass(frozen=True)
class Response:
    """The pulse ratio, `strong` pushes of the driver in `periods` drive periods, and the evidence.

    `in_step` tells whether the reflected pulse is in step with the driver. It is measured for 1:1 only: it is None for
    every other ratio, and where little is transmitted. `contact_phase` and `peak_phase` are the drive phases
    [degrees] at which the strongest push begins and is strongest. The phase is 0 where the driver moves forward through
    its middle position, and `contact_phase` is None where driver and bead 1 never separate. `returning` is the speed of
    bead 1 towards the driver just before the strongest push, relative to 2πf A0; `transmission` is the largest output
    force over the largest input force.
    """

    strong: int
    periods: int
    in_step: bool | None
    contact_phase: float | None
    peak_phase: float
    returning: float
    transmission: float

    @property
    def little_transmitted(self) -> bool:
        """Whether less than `STOP_BAND_FRACTION` of the input force arrives at the wall.

        This is not called a stop band, which lies beyond the last peak of a curve: a single orbit has no peaks.
        """
        return self.transmission < STOP_BAND_FRACTION

    @property
    def sentence(self) -> str:
        """The response in words."""
        ratio = f"pulse ratio {self.strong}:{self.periods}"
        if self.in_step is not None:
            return f"{ratio}, {'in step' if self.in_step else 'not in step'}"
        return f"{ratio}, little transmitted ({100.0 * self.transmission:.0f} %)" if self.little_transmitted else ratio


def response(orbit: Orbit) -> Response:
    """Compute the pulse ratio of a periodic orbit, with its evidence."""
    run = recorded(orbit)
    counted = pushes(run)
    strong, periods = counted if counted is not None else (orbit.period, orbit.period)
    force, speed = run.input_force[:-1], run.velocity[:-1, 0] / (2.0 * pi * orbit.scene.f * orbit.scene.A0)
    peak = int(np.argmax(force))
    begin = _begin(force, peak)
    returning = 0.0 if begin is None else max(0.0, -float(speed[begin - 1]))
    transmission = run.max_output_force / run.max_input_force if run.max_input_force > 0.0 else 0.0
    measured = (strong, periods) == (1, 1) and transmission >= STOP_BAND_FRACTION
    in_step = returning >= RETURNS_IN_STEP if measured else None
    return Response(strong, periods=periods, in_step=in_step, contact_phase=None if begin is None else _phase(begin),
                    peak_phase=_phase(peak), returning=returning, transmission=transmission)


def _phase(sample: int) -> float:
    return 360.0 * (sample % _SAMPLES) / _SAMPLES


def _begin(force: np.ndarray, peak: int) -> int | None:
    """The sample at which the push around `peak` begins; the orbit is closed, so it may lie after the peak's index."""
    quiet = np.flatnonzero(np.roll(force, -peak) < END_FRACTION * force[peak])
    return None if len(quiet) == 0 else int((peak + quiet[-1] + 1) % len(force))


def recorded(orbit: Orbit) -> Run:
    """Record the orbit as a run over its whole period."""
    engine = Engine(orbit.scene, dop853_setting(_TOLERANCE), _SAMPLES)
    engine.start(orbit.state)
    samples = engine.record(orbit.period * _SAMPLES)
    leading = float(np.abs(orbit.multipliers).max())
    regime = Regime(name="periodic", period=orbit.period, observed_contraction=None, distance=None,
                    periods_run=orbit.period, multiplier=leading)
    return run_from(engine, samples, 0, regime, None, Cost.of(0.0, engine.counts, DOP853), start=GIVEN_STATE)
