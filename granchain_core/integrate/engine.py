"""The engine, which advances one scene with one method, by whole periods or from sample to sample."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..errors import BadInput, Cancelled
from ..execution.stop import Stop
from ..kernels.forces.largest import CLOSED, UNRESOLVED, new_log
from ..kernels.forces.peaks import largest_forces, largest_jumps, reset_peaks
from ..kernels.samples import KernelIO, Samples, first_not_finite
from ..kernels.status import DONE, NOT_FINITE
from ..scene import Scene
from ..scene.state import State, rest
from .counts import Counts
from .failure import Failure
from .flushed import flushed
from .methods import METHODS, MethodSetting
from .scaling import ScaledChain, scale_chain
from .stepper import CallStart, empty_samples

#: A start's phase may be this part of a sample interval away from a sample, because of rounding.
_BETWEEN_SAMPLES = 1e-6
#: Number of closings recorded per contact and period; further bounces are ever weaker.
_MOST_CLOSINGS = 4


class Engine:
    """Advances a state of `scene` in time; all arrays are allocated beforehand, none in a kernel.

    `samples` is the number of samples per period. `stop` ends a call from another thread. `scaled` may be given if more
    than the scene's own chain moves. Everything that depends on the method is in `stepper`.

    A call that ends with `Cancelled` leaves the chain where the call began; the largest forces and the counts include
    the cancelled part.
    """

    def __init__(self, scene: Scene, setting: MethodSetting, samples: int = 1, account: bool = False,
                 stop: Stop | None = None, scaled: ScaledChain | None = None) -> None:
        method = METHODS[setting.method]
        ready = (scale_chain(scene, account and method.has_account) if scaled is None else scaled).with_own_tension()
        self.setting = setting
        self.samples = samples
        self.counts = Counts()
        self.log = new_log()
        self.stop = Stop() if stop is None else stop
        self.y = np.zeros(ready.size)
        self.stepper: Any = method.stepper(setting, ready, samples)
        self.stepper.pause = self.stop.pause
        self.grid: int = self.stepper.grid
        self.start(rest(scene) if scaled is None else State(np.zeros(ready.beads), np.zeros(ready.beads)))
        self._remember()

    @property
    def scaled(self) -> ScaledChain:
        """The scene in scaled arrays."""
        chain: ScaledChain = self.stepper.scaled
        return chain

    def use(self, scaled: ScaledChain) -> None:
        """Continue with other values or effects of the same chain; the step is unchanged."""
        self.stepper.use(scaled)

    def move(self, scaled: ScaledChain, steps: int) -> None:
        """Become the engine of another scene with the same effects, with a fixed step; a start must follow.

        `steps` is the number of steps per period. The arrays are reused: if many orbits are followed for a period each,
        making a new engine would take as long as the period itself.
        """
        self.stepper.move(scaled.with_own_tension(), steps)
        self.grid = self.stepper.grid

    # --- state ---------------------------------------------------------------------------------------------

    def start(self, state: State) -> None:
        """Put the chain into `state`; the energy account starts at zero.

        Raises `BadInput` if the phase is not that of a sample.
        """
        scales, at = self.scaled.scales, state.phase * self.samples
        if abs(at - round(at)) > _BETWEEN_SAMPLES:
            raise BadInput(f"The start is at drive phase {state.phase!r}, between two samples. With {self.samples} "
                           f"samples per period, a motion begins at a multiple of 1/{self.samples}; the nearest is "
                           f"{round(at)}/{self.samples}.")
        self.grid_index = round(at) % self.samples * (self.grid // self.samples)
        self._begin(scales.scaled_displacements(state.displacement), scales.scaled_velocities(state.velocity),
                    from_velocity=True)

    def start_scaled(self, x: np.ndarray) -> None:
        """Put the chain into a scaled state (2N,) of displacements, then w, at phase 0."""
        n = self.scaled.beads
        self.grid_index = 0
        self._begin(x[:n], x[n:], from_velocity=False)

    def _begin(self, displacement: np.ndarray, rates: np.ndarray, from_velocity: bool) -> None:
        """Start from scaled displacements and velocities, or w."""
        self.y[:] = 0.0
        first, second = self.scaled.rows(self.y)
        first[:], second[:] = displacement, rates
        self.elapsed = 0.0
        self.evaluate(from_velocity)
        self.stepper.prepare(self.y)
        self.reset_peaks()

    def evaluate(self, from_velocity: bool = False) -> None:
        """Recompute the driver's state and dy/dt for y."""
        if self.scaled.slots.tension is not None:  # flags of the last step
            self.scaled.slots.tension.force_free[:] = 0
        self.stepper.evaluate_at_phase(2 * np.pi * self.grid_index / self.grid, self.y, from_velocity)

    @property
    def state(self) -> State:
        """Return the present state in SI."""
        scaled = self.scaled
        self.evaluate(from_velocity=False)
        displacement, velocity = scaled.rows(self.y)[0], scaled.rows(self.stepper.slope)[0]
        return State(scaled.scales.displacements(displacement), scaled.scales.velocities(velocity),
                     self.grid_index / self.grid)

    # --- motion --------------------------------------------------------------------------------------------

    def empty_samples(self, rows: int) -> Samples:
        """Return arrays for `rows` samples in scaled units."""
        return empty_samples(self.scaled, rows)

    @flushed
    def record(self, count: int) -> Samples:
        """Advance by `count` samples and return them, the present one first: count + 1 rows.

        Raises `ComputationError`, `Cancelled`.
        """
        self.stop.pause()
        self._remember()
        stepper, periods = self.stepper, count / self.samples
        samples = empty_samples(stepper.scaled, count + 1)
        out = self._output(round(_MOST_CLOSINGS * (1.0 + periods) * stepper.scaled.bodies))
        try:
            status, rows = stepper.samples(self.y, self.grid_index, samples, out)
            if status != DONE:
                self.raise_for(status, max(0, rows - 1) / self.samples, self._before)
        except Cancelled:
            self._go_back()
            raise
        self.grid_index = (self.grid_index + count * (self.grid // self.samples)) % self.grid
        self.elapsed += periods
        return samples

    @flushed
    def periods(self, count: int, watch: bool = True) -> tuple[np.ndarray, np.ndarray]:
        """Advance by whole periods from phase 0.

        Returns the stroboscopic states (count + 1, 2, N), displacement and velocity in scaled units, and the largest
        input, output and elastic output force of each period (count, 3). Without `watch`, a method with error control
        does not search for the largest forces, and they are NaN.
        """
        self.stop.pause()
        self._remember()
        stepper = self.stepper
        strobes, maxima = np.zeros((count + 1, 2, stepper.scaled.bodies)), np.full((count, 3), np.nan)
        try:
            status, done = stepper.periods(self.y, strobes, maxima, watch, self._output())
            if status != DONE:
                self.raise_for(status, done, self._before)
        except Cancelled:
            self._go_back()
            raise
        self.elapsed += count
        return strobes[:, :, 1:-1], maxima

    def strobe(self) -> np.ndarray:
        """Return the present state at phase 0 as one strobe (1, 2, N): displacement and velocity in scaled units."""
        return self.periods(0)[0]

    def _output(self, closings: int = 0) -> KernelIO:
        """Return a new log with room for this number of closings, the counts and the stop flag."""
        self.log = new_log(self.log, closings)
        return KernelIO(self.log, self.counts.array, self.stop.flag)

    # --- largest forces ------------------------------------------------------------------------------------

    def reset_peaks(self) -> None:
        """Reset the largest forces."""
        reset_peaks(self.log.peaks)

    def begin_record(self) -> None:
        """Start counting largest forces, work and loss from here.

        The account of a long run before would swamp that of a record with little energy: their sums cancel.
        """
        self.reset_peaks()
        if self.scaled.slots.account is not None:
            self.y[-2:] = 0.0

    @property
    def maxima(self) -> np.ndarray:
        """The largest input, output and elastic output force since they were last reset, in scaled units."""
        return largest_forces(self.log.peaks).copy()

    @property
    def jumps(self) -> np.ndarray:
        """The largest jumps of input and output force (2,) over the same time, in scaled units."""
        return largest_jumps(self.log.peaks).copy()

    @property
    def closings(self) -> np.ndarray:
        """The jumps in the last record (J, 4): sample before, drive phase θ, contact, scaled force just after."""
        return self.log.closings[: self.log.counts[CLOSED]]

    @property
    def unresolved(self) -> int:
        """Number of touches shorter than a step that a method without event location has detected."""
        return int(self.log.counts[UNRESOLVED])

    @property
    def closings_missing(self) -> int:
        """Number of further jumps, for which there was no room."""
        return max(0, int(self.log.counts[CLOSED]) - len(self.log.closings))

    def advance_and_find_largest(self, periods: int) -> np.ndarray:
        """Advance by whole periods; return the largest input, output and elastic output force (3,), scaled."""
        self.reset_peaks()
        self.record(periods * self.samples)
        return self.maxima

    # --- failures ------------------------------------------------------------------------------------------

    def raise_for(self, status: int, done: float, before: CallStart | None = None) -> None:
        """Raise the error for a kernel's status after `done` periods of a call from `before`; None if that is unknown.

        Raises `ComputationError`, `Cancelled`.
        """
        if status == DONE:
            return
        place = (0, None)
        if status == NOT_FINITE:
            place = self.stepper.locate_failure(self.y, before, done, self.stop)
        raise self._failure(status, done, *place).error

    def _remember(self) -> None:
        """Record where a call begins; a number that is already non-finite there is reported at once."""
        stepper = self.stepper
        bead = first_not_finite(self.y, stepper.scaled.bodies)
        if bead:
            raise self._failure(NOT_FINITE, 0.0, bead, stepper.step_at(self.grid_index)).error
        self._before: CallStart = self.y.copy(), stepper.slope.copy(), self.grid_index

    def _go_back(self) -> None:
        """Return to the start of the last call."""
        before, slope, self.grid_index = self._before
        self.y[:] = before
        self.evaluate()  # also clears the flags of force-free contacts from the last step
        self.y[:], self.stepper.slope[:] = before, slope

    def _failure(self, status: int, done: float, bead: int, step: int | None) -> Failure:
        return Failure(status, periods=self.elapsed + done, bead=bead, step=step, cost=self.counts.by_name,
                       scene=self.scaled.scene, method=self.setting.method)
