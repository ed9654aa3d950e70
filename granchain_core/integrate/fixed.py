"""Stepping with a fixed step, a whole number of steps per drive period.

The kernels test for non-finite numbers only once per sample or period, because the test costs as much as a bead. When
one is found, the period is repeated from its start and bisected until the step is known. In that step the failure has
not spread yet, and its earliest stage identifies the bead where it began. Bead 0 means unknown.

A period of a long chain, or of a slow drive, may take minutes. It is computed in parts, so that it can be cancelled at
any time and other computations can run first (parts.py).
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any

import numpy as np

from ..execution.stop import Stop
from ..kernels.compiling.entry import Entries, types_of
from ..kernels.effects.driver import driver_displacement, driver_velocity
from ..kernels.effects.registry import unknown_slots
from ..kernels.equations.chain_in_vector import CHAIN_WIDTHS
from ..kernels.equations.motion import Trajectory, evaluate_at_phase
from ..kernels.forces.largest import new_log
from ..kernels.naive import naive_motion
from ..kernels.rk4.long_chain import LongChain
from ..kernels.rk4.run import RunRecord, run_steps
from ..kernels.rk4.short_chain import STATE_ROWS, STEPS_IN_BLOCK, ShortChain
from ..kernels.rk4.step import DriveTable, Rk4Workspace
from ..kernels.samples import KernelIO, Samples, first_not_finite
from ..kernels.simd.vector import BLOCK_WIDTH, aligned
from ..kernels.step_ends import END_ROWS
from .parts import periods_in_parts, samples_in_parts, steps_in_part
from .scaling import ScaledChain
from .stepper import CallStart, empty_samples

#: Most beads of a chain whose bodies, including driver and wall, fit into one vector.
SHORT_CHAIN = max(CHAIN_WIDTHS) - 2
#: Most steps per period for which the driver's motion is tabulated.
_LARGEST_TABLE = 200_000
#: Number of tables kept: a branch of orbits makes ten successive chains with the same number of steps.
_TABLES_KEPT = 4
# Kernels that are called many times a second: a branch runs thousands of single periods.
_RUN_STEPS = Entries(run_steps)
_EVALUATE_AT_PHASE = Entries(evaluate_at_phase)


class FixedStep:
    """Fixed steps of a method in (u, w); `simd` is true if it has SIMD kernels."""

    def __init__(self, method: Any, scaled: ScaledChain, samples: int, simd: bool = False) -> None:
        self.method = method
        self.scaled = scaled
        self.grid: int = method.steps_per_period
        self.h = scaled.period / self.grid
        self.pause: Callable[[], None] = Stop().pause
        self._every = self.grid // samples
        self._simd = simd
        self._no_samples = empty_samples(scaled, 0)
        self._no_periods = np.zeros((0, 2, 0)), np.zeros((0, 3))
        self._work: Any = None
        self._type_key: Any = None
        self._run_steps: Callable[..., Any] = _RUN_STEPS
        self.drive = self._driver_table(scaled)
        self.work = Rk4Workspace(np.zeros((4, scaled.size)), np.zeros(scaled.size), np.zeros(scaled.size),
                                 np.zeros((END_ROWS, scaled.bodies - 1)), scaled.forces(), self.new_simd_workspace())

    @property
    def work(self) -> Any:
        """The workspace of the kernels."""
        return self._work

    @work.setter
    def work(self, work: Any) -> None:
        """Use another workspace, perhaps of another type; the matching specialization of the kernels is then called."""
        self._work = work
        self._type_key = types_of((self.method, self.scaled.slots, work))

    def _driver_table(self, scaled: ScaledChain) -> np.ndarray:
        """Return the driver's displacement and velocity at every half step (2n + 1, 2)."""
        sine, cosine = _half_steps(self.grid)
        driver = scaled.slots.driver
        table = np.zeros((sine.size, 2))
        if driver is not None:
            np.multiply(sine, driver.amplitude, out=table[:, 0])
            np.multiply(cosine, driver.amplitude * driver.beta, out=table[:, 1])
        return table

    def new_simd_workspace(self) -> LongChain | ShortChain | None:
        """Return the workspace of SIMD steps; None unless the chain is driven and they support all of its effects."""
        scaled, slots = self.scaled, self.scaled.slots
        if not self._simd or unknown_slots(slots, "rk4") or slots.driver is None:
            return None
        width = chain_width(scaled)
        return short_chain_workspace(scaled, width) if width else _long_chain(scaled)

    @property
    def slope(self) -> np.ndarray:
        """The slope dy/dt at the present state."""
        return np.asarray(self.work.k[0])

    def use(self, scaled: ScaledChain) -> None:
        """Continue with other values in the same slots, or with other effects."""
        self.scaled = scaled
        self._no_samples = empty_samples(scaled, 0)
        self.drive = self._driver_table(scaled)
        self.work = self.work._replace(forces=scaled.forces(), simd=self.new_simd_workspace())

    def move(self, scaled: ScaledChain, steps: int) -> None:
        """Become the stepper of another scene with the same effects, with this number of steps per period."""
        self.method = self.method._replace(steps_per_period=steps)
        self._every = self._every * steps // self.grid
        self.grid, self.h = steps, scaled.period / steps
        if scaled.slots.chain is self.scaled.slots.chain:  # only the frequency differs: `scale_like`
            self.scaled, self.drive = scaled, self._driver_table(scaled)
        else:
            self.use(scaled)

    def prepare(self, y: np.ndarray) -> None:
        """Start from a new state: nothing is kept from the last one."""

    def trajectory(self, y: np.ndarray) -> Trajectory:
        """Return the state y with everything that its kernels need."""
        return Trajectory(self.scaled.slots, DriveTable(self.drive, 2.0 * np.pi / self.grid, self.h), y,
                          self.work)

    def stay_uncompiled(self) -> None:
        """Run steps in Python from now on, one by one in scalar code (uncompiled.py)."""
        self._simd = False
        self.work = self.work._replace(simd=None)
        self._run_steps = lambda _key, *arguments: run_steps.py_func(*arguments)

    def evaluate_at_phase(self, theta: float, y: np.ndarray, from_velocity: bool) -> None:
        """Recompute the driver's state and dy/dt for y."""
        self._evaluate_slope(theta, y, self.work.k[0], from_velocity)

    def _evaluate_slope(self, theta: float, y: np.ndarray, slope: np.ndarray, from_velocity: bool) -> None:
        """Recompute the driver's state in y, and write dy/dt into `slope`."""
        _EVALUATE_AT_PHASE(self._type_key, self.scaled.slots, theta, y, slope, self.work.forces, from_velocity)

    def samples(self, y: np.ndarray, first: int, samples: Samples, out: KernelIO) -> tuple[int, int]:
        """Advance from step `first` and fill the samples; return status and number of rows filled."""
        part = steps_in_part(self.scaled.bodies)
        if self._every * (len(samples.displacement) - 1) > part:
            return samples_in_parts(self, y, first, self._every, part, samples, out)
        return self.run(y, first, self._every, samples, out)

    def periods(self, y: np.ndarray, strobes: np.ndarray, maxima: np.ndarray, watch: bool,
                out: KernelIO) -> tuple[int, int]:
        """Advance by whole periods; fill strobes and, at no cost, largest forces; return status and periods done."""
        part = steps_in_part(self.scaled.bodies)
        if self.grid > part:
            return periods_in_parts(self, y, part, strobes, maxima, out)
        record = RunRecord(self._no_samples, strobes, maxima)
        status, done = self._run_steps(self._type_key, self.method, self.trajectory(y), 0, self.grid, record, out)
        return status, done

    def run(self, y: np.ndarray, first: int, stride: int, samples: Samples, out: KernelIO) -> tuple[int, int]:
        """Call the kernel once from step `first`, keeping every `stride`-th state; return status and rows filled."""
        record = RunRecord(samples, *self._no_periods)
        status, done = self._run_steps(self._type_key, self.method, self.trajectory(y), first, stride, record, out)
        return status, done

    def step_at(self, grid_index: int) -> int | None:
        """Return the number, within its period, of the step that begins at this grid index."""
        return grid_index

    def locate_failure(self, y: np.ndarray, start: CallStart | None, done: float,
                       stop: Stop) -> tuple[int, int | None]:
        """Find bead and step: repeat the call up to the last instant known to be good, then bisect the steps after it.

        Raises `Cancelled`.
        """
        steps, bodies = self.grid, self.scaled.bodies
        if start is None:
            return first_not_finite(y, bodies), None
        here, slope, first = start
        low = first + round(done * steps)
        here, slopes = self._again(here, slope, first, low, stop, vectors=True)
        slope = slopes[0]
        high = min((low // steps + 1) * steps, low + self._every)
        while high - low > 1:
            middle = (low + high) // 2
            state_there, slopes = self._again(here, slope, low, middle, stop, vectors=True)
            if first_not_finite(state_there, bodies):
                high = middle
            else:
                low, here, slope = middle, state_there, slopes[0]
        # each stage only spreads to the adjacent beads: the earliest stage identifies the bead
        stages = self._rk4_slopes(here, slope, low % steps)
        if not any(first_not_finite(k, bodies) for k in stages):  # the failure is outside the equations
            _, slopes = self._again(here, slope, low, high, stop)
            end, _ = self._again(here, slope, low, high, stop, vectors=True)
            stages = [*slopes[1:], end]
        return next((b for b in (first_not_finite(k, bodies) for k in stages) if b), 0), low % steps

    def _rk4_slopes(self, y: np.ndarray, slope: np.ndarray, step: int) -> list[np.ndarray]:
        """Return the slopes of the last three stages of an RK4 step without splits, in the method's variables.

        They represent the stages of any method, each of which only spreads to the adjacent beads. A method's own stages
        are not all kept: a method that splits its step at events overwrites the stages of each part with those of the
        next.
        """
        stages, before = [], slope
        for part in (0.5, 0.5, 1.0):
            stage, now = y + part * self.h * before, np.zeros_like(slope)
            self._evaluate_slope(2.0 * np.pi * (step + part) / self.grid, stage, now, False)
            stages.append(now)
            before = now
        return stages

    def _again(self, y: np.ndarray, slope: np.ndarray, first: int, last: int, stop: Stop,
               vectors: bool = False) -> tuple[np.ndarray, np.ndarray]:
        """Return state and slopes after steps `first` to `last`, counted across periods, by SIMD or scalar code."""
        n, now = self.grid, y.copy()
        # new vectors: those of the failed call contain non-finite numbers
        work = self.work._replace(simd=self.new_simd_workspace() if vectors else None, k=np.zeros_like(self.work.k))
        work.k[0] = slope
        trajectory = self.trajectory(now)._replace(workspace=work)
        kept, out = empty_samples(self.scaled, 2), KernelIO(new_log(), np.zeros(4, dtype=np.int64), stop.flag)
        j = first
        while j < last:
            stride = min(last, (j // n + 1) * n) - j
            run_steps(self.method, trajectory, j % n, stride, RunRecord(kept, *self._no_periods), out)
            stop.check()
            j += stride
        return now, work.k


class FixedStepInVelocity(FixedStep):
    """Fixed steps of a method in (u, v), whose equations have no energy account."""

    def _evaluate_slope(self, theta: float, y: np.ndarray, slope: np.ndarray, from_velocity: bool) -> None:
        """Recompute the driver's state in y, and write dy/dt into `slope`; velocities are part of y."""
        slots = self.scaled.slots
        displacement, velocity = driver_displacement(slots.driver, theta), driver_velocity(slots.driver, theta)
        naive_motion(slots, displacement, velocity, y, slope, self.work.forces)


@functools.lru_cache(maxsize=_TABLES_KEPT)
def _half_steps(grid: int) -> tuple[np.ndarray, np.ndarray]:
    """Return sine and cosine of the drive phase at every half step (2n + 1,), for all chains with this grid."""
    # the table is faster, but for a period of many steps it would not fit into memory
    theta = np.pi * np.arange(2 * grid + 1 if grid <= _LARGEST_TABLE else 0) / grid
    return np.sin(theta), np.cos(theta)


def chain_width(scaled: ScaledChain) -> int:
    """Return the width of the vector into which a chain's bodies fit; 0 if there is none."""
    return next((width for width in CHAIN_WIDTHS if scaled.bodies <= width), 0)


def short_chain_workspace(scaled: ScaledChain, width: int) -> ShortChain:
    """Return the workspace of a chain whose bodies fit into one vector."""
    slots = scaled.slots

    def padded(values: np.ndarray) -> np.ndarray:
        row = aligned(1, width)
        row[0, : len(values)] = values
        return row

    preload = None if slots.preload is None else type(slots.preload)(padded(slots.preload.static))
    return ShortChain(CHAIN_WIDTHS[width], padded(slots.chain.inverse_mass), padded(slots.chain.stiffness), preload,
                      aligned(2 * STATE_ROWS, width), aligned(END_ROWS, width), np.zeros((3, STEPS_IN_BLOCK)))


def _long_chain(scaled: ScaledChain) -> LongChain:
    """Return the workspace of a chain in blocks of eight bodies."""
    slots, blocks = scaled.slots, -(-scaled.bodies // BLOCK_WIDTH)

    def padded(values: np.ndarray) -> np.ndarray:
        rows = aligned(blocks)
        rows.reshape(-1)[: len(values)] = values
        return rows

    preload = None if slots.preload is None else type(slots.preload)(padded(slots.preload.static))
    return LongChain(padded(slots.chain.inverse_mass), padded(slots.chain.stiffness), preload,
                     now=aligned(2 * blocks), before=aligned(2 * blocks), acc=aligned(2 * blocks),
                     first=aligned(2 * blocks), second=aligned(2 * blocks), overlap=aligned(blocks),
                     velocity=aligned(blocks), elastic=aligned(blocks),
                     signs=np.zeros(blocks, dtype=np.int64))
