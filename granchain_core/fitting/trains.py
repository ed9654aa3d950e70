"""The model's force as a sensor samples it, with jumps at their exact times.

If the sensor's bandwidth is known, this is the force after the sensor's low-pass (experiment/sensors.py), at the time
of each sample: continuous, and delayed as by the sensor. If it is not known, this is the mean over each sampling
interval: a force that jumps between two samples would make a misfit that jumps with the parameters, whereas its mean
over an interval changes smoothly. The mean is not a model of a recorder, whose anti-aliasing filter is not a mean over
an interval and delays the force.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicHermiteSpline
from scipy.optimize import minimize_scalar

from ..experiment.sensors import Sensors
from ..results.run import Run

#: Half the range around the coarse search's best shift in which the exact one is sought, in steps of the coarse search:
#: the neighbours are one step away.
_AROUND = 1.5
#: Accuracy of the best shift, in the same steps.
_FINE = 1e-4
_PERFECT = Sensors()


@dataclass(frozen=True, eq=False)
class Train:
    """A periodic force: straight lines between nodes (time from 0 [s], force [N]), and their integral [N s]."""

    time: np.ndarray
    force: np.ndarray
    integral: np.ndarray
    length: float

    @classmethod
    def of(cls, run: Run, name: str) -> Train:
        """Make a train of the input or output force of a recorded orbit; a jump is two nodes at one time.

        The force jumps up where the contact closes, and from a pull to zero where it opens.
        """
        time, force = run.time - run.time[0], getattr(run, name)
        contact = 0 if name == "input_force" else run.scene.N
        of_contact = run.jumps.contact == contact
        closed, opened = run.jumps.time[of_contact] - run.time[0], _releases(run, contact)
        at = np.concatenate([closed, opened[0]])
        before = np.concatenate([np.zeros(len(closed)), opened[1]])
        after = np.concatenate([run.jumps.force[of_contact], np.zeros(len(opened[0]))])
        inside = (at > 0.0) & (at < time[-1])
        at, before, after = at[inside], before[inside], after[inside]
        order = np.argsort(np.concatenate([time, at, at]), kind="stable")  # samples, then before, then after
        nodes = np.concatenate([time, at, at])[order]
        forces = np.concatenate([force, before, after])[order]
        steps = 0.5 * (forces[1:] + forces[:-1]) * np.diff(nodes)
        return cls(nodes, forces, np.concatenate([[0.0], np.cumsum(steps)]), float(time[-1]))

    def mean_over(self, time: np.ndarray, width: float) -> np.ndarray:
        """Means over intervals of `width` [s] around times [s]."""
        return np.asarray((self._integral(time + 0.5 * width) - self._integral(time - 0.5 * width)) / width)

    def recorded(self, time: np.ndarray, width: float, sensors: Sensors) -> np.ndarray:
        """Recorded values at `time` [s]: the force after the low-pass, or means over `width` [s] if there is none."""
        if sensors.filters:
            return sensors.passed(self.time, self.force, time, periodic=True)
        return self.mean_over(time, width)

    def _integral(self, time: np.ndarray) -> np.ndarray:
        turns = np.floor(time / self.length)
        at = time - turns * self.length
        left = np.clip(np.searchsorted(self.time, at, side="right") - 1, 0, len(self.time) - 2)
        step = self.time[left + 1] - self.time[left]
        part = np.divide(at - self.time[left], step, out=np.zeros_like(at), where=step > 0.0)
        risen = self.force[left] * part + 0.5 * (self.force[left + 1] - self.force[left]) * part**2
        return np.asarray(turns * self.integral[-1] + self.integral[left] + risen * step)


def _releases(run: Run, contact: int) -> tuple[np.ndarray, np.ndarray]:
    """Times from the run's start [s] at which an end contact opens, and the forces just before [N].

    The times are roots of the cubic through the overlap and its rate at the samples. Both arrays are empty for a law
    whose force does not jump.
    """
    scene = run.scene
    if not scene.forces_jump or scene.cuts_tension:  # with cut tension, the pull ends before the contact opens
        return np.zeros(0), np.zeros(0)
    omega = 2.0 * np.pi * scene.f
    driver = scene.drive_amplitude * omega * np.cos(omega * run.time)
    rate = driver - run.velocity[:, 0] if contact == 0 else run.velocity[:, -1]
    overlap = CubicHermiteSpline(run.time - run.time[0], run.overlap[:, contact], rate)
    roots = np.asarray(overlap.roots(extrapolate=False), dtype=float)
    roots = np.unique(roots[np.isfinite(roots)])
    opening = np.asarray(overlap.derivative()(roots))
    return roots[opening < 0.0], scene.D * opening[opening < 0.0]


def moved(time: np.ndarray, measured: dict[str, np.ndarray], trains: dict[str, Train], width: float, count: int,
          sensors: Sensors = _PERFECT) -> float:
    """Find the shift of the trains [s] with the least sum of squares, first on a grid of all shifts, then exactly."""
    length = next(iter(trains.values())).length
    bins = np.floor(np.mod(time, length) / length * count).astype(int) % count
    score = np.zeros(count)
    for name, values in measured.items():
        train = trains[name].recorded(np.arange(count) * length / count, max(width, length / count), sensors)
        folded, hits = np.bincount(bins, values, count), np.bincount(bins, minlength=count)
        # Σ (train(t + s) − value)² over all shifts s, as two circular correlations
        turn = np.conj(np.fft.rfft(np.stack([folded, hits])))
        squares, products = np.fft.rfft(train**2) * turn[1], np.fft.rfft(train) * turn[0]
        score += np.fft.irfft(squares - 2.0 * products, count)

    def misfit(late: float) -> float:
        return sum(float(((trains[name].recorded(time + late, width, sensors) - values) ** 2).sum())
                   for name, values in measured.items())

    step = length / count
    best = float(np.argmin(score)) * step
    return float(minimize_scalar(misfit, bounds=(best - _AROUND * step, best + _AROUND * step), method="bounded",
                                 options={"xatol": _FINE * step}).x)
