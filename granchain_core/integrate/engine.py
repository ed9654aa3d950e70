"""The engine: one scene, one method, one state, carried through whole periods or along a grid of samples."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..kernels.dop853.located import run_certified
from ..kernels.dop853.step import ALL_STAGES, Dop853, Work
from ..kernels.equations.motion import place
from ..kernels.equations.velocity_form import Rk4Naive, VerletNaive, naive_motion
from ..kernels.forces.largest import new_log
from ..kernels.forces.peaks import MEMORY, ROWS, forget, next_period
from ..kernels.jit import all_in_simd_kernels
from ..kernels.rk4.contact_events import ENDS
from ..kernels.rk4.long_chain import LongChain
from ..kernels.rk4.run import run_periods, run_samples
from ..kernels.rk4.short_chain import BLOCK, KEPT, WIDTHS, ShortChain
from ..kernels.rk4.step import Rk4, Rk4Split, Stages
from ..kernels.samples import Samples
from ..kernels.simd.vector import LANES, aligned
from ..lower import Lowered, lower
from ..scene import Scene
from ..stop import Stop
from .failures import check_start, raise_for
from .flushed import flushed
from .methods import METHODS, Setting
from .state import Counts, State, rest

#: The certified method makes at least this many steps a period, so that the driver is never stepped over.
_LEAST_STEPS = 16

#: Places for closings of a contact in one period; one that bounces more often does so ever more gently.
_CLOSINGS = 4
#: Steps in a period up to which the driver's motion is tabulated.
_LARGEST_TABLE = 200_000

_FIXED: dict[str, Any] = {"rk4": Rk4, "rk4-split": Rk4Split, "rk4-naive": Rk4Naive, "verlet-naive": VerletNaive}
#: Adaptive methods with the kernel that runs them.


class Engine:
    """Carries a state of `scene` through time; all arrays are allocated here, none in a kernel.

    `samples` is the number of recorded samples a period. `stop` ends a call from another thread. `lowered` may be
    given where more than the scene's own chain moves.
    """

    def __init__(self, scene: Scene, setting: Setting, samples: int = 1, balance: bool = False,
                 stop: Stop | None = None, lowered: Lowered | None = None) -> None:
        self._in_uv = METHODS[setting.method].variables == "uv"
        self.lowered = (lower(scene, balance and not self._in_uv) if lowered is None else lowered).own()
        self.setting = setting
        self.samples = samples
        self.counts = Counts()
        self.log = new_log()
        self.stop = Stop() if stop is None else stop
        self.y = np.zeros(self.lowered.size)
        self._adaptive = METHODS[setting.method].adaptive
        if self._adaptive:
            self._prepare_adaptive()
        else:
            self._prepare_fixed()
        self.start(rest(scene) if lowered is None else State(np.zeros(lowered.beads), np.zeros(lowered.beads)))
        self._before = self.y.copy(), self.work.k[0].copy(), self.grid_index

    # --- set-up --------------------------------------------------------------------------------------------

    def _prepare_fixed(self) -> None:
        lo = self.lowered
        n = self.setting.steps_per_period(lo, self.samples)
        self.method: Any = _FIXED[self.setting.method](n)
        self.h = lo.period / n
        # the table is the faster way, but a period of many steps would not fit into memory
        theta = np.pi * np.arange(2 * n + 1 if n <= _LARGEST_TABLE else 0) / n
        driver = lo.slots.driver
        self.drive = np.stack([driver.amplitude * np.sin(theta), driver.amplitude * driver.beta * np.cos(theta)], 1)
        self.work: Any = Stages(np.zeros((4, lo.size)), np.zeros(lo.size), np.zeros(lo.size),
                                np.zeros((ENDS, lo.row - 1)), lo.forces(),
                                self.new_simd_workspace())
        self.grid = n

    def new_simd_workspace(self) -> LongChain | ShortChain | None:
        """The workspace of SIMD steps: a driven chain with no effect that they do not know."""
        lo, slots = self.lowered, self.lowered.slots
        if self.setting.method != "rk4-split" or not all_in_simd_kernels(slots) or slots.driver is None:
            return None
        width = next((lanes for lanes in WIDTHS if lo.row <= lanes), 0)
        if width:
            return self._wide(width)
        blocks = -(-lo.row // LANES)

        def padded(values: np.ndarray) -> np.ndarray:
            return np.pad(values, (0, blocks * LANES - len(values))).reshape(blocks, LANES)

        def empty(rows: int) -> np.ndarray:
            return np.zeros((rows, LANES))

        preload = None if slots.preload is None else type(slots.preload)(padded(slots.preload.static))
        return LongChain(padded(slots.chain.inverse_mass), padded(slots.chain.stiffness), preload,
                     now=empty(2 * blocks), before=empty(2 * blocks), acc=empty(2 * blocks), first=empty(2 * blocks),
                     second=empty(2 * blocks), gap=empty(blocks), slope=empty(blocks), elastic=empty(blocks),
                     signs=np.zeros(blocks, dtype=np.int64))

    def _wide(self, width: int) -> ShortChain:
        """The workspace of a chain whose bodies fit into one vector."""
        slots = self.lowered.slots

        def padded(values: np.ndarray) -> np.ndarray:
            row = aligned(1, width)
            row[0, : len(values)] = values
            return row

        preload = None if slots.preload is None else type(slots.preload)(padded(slots.preload.static))
        return ShortChain(WIDTHS[width], padded(slots.chain.inverse_mass), padded(slots.chain.stiffness), preload,
                    aligned(2 * KEPT, width), aligned(ENDS, width), np.zeros((3, BLOCK)))

    def _prepare_adaptive(self) -> None:
        lo = self.lowered
        self.method = Dop853(self.setting.tolerance, lo.period / _LEAST_STEPS)
        size = lo.size
        self.work = Work(k=np.zeros((ALL_STAGES, size)), stage=np.zeros(size), end=np.zeros(size), probe=np.zeros(size),
                         slope=np.zeros(size), dense=np.zeros((7, size)), scale=np.zeros(2), forces=lo.forces())
        self.clock = np.array([min(0.01, lo.period / _LEAST_STEPS)])
        self.grid = self.samples

    # --- state ---------------------------------------------------------------------------------------------

    def start(self, state: State) -> None:
        """Put the chain into `state`; the energy account starts at zero."""
        lo, row = self.lowered, self.lowered.row
        self.grid_index = round(state.phase * self.grid) % self.grid
        self.y[:] = 0.0
        self.y[1 : row - 1] = state.displacement / lo.scales.length
        self.y[row + 1 : 2 * row - 1] = state.velocity / lo.scales.velocity
        self._begin(from_velocity=True)

    def start_scaled(self, x: np.ndarray) -> None:
        """Put the chain into a scaled state (2N,) of displacements, then w, at phase 0."""
        row, n = self.lowered.row, self.lowered.beads
        self.grid_index = 0
        self.y[:] = 0.0
        self.y[1 : row - 1], self.y[row + 1 : 2 * row - 1] = x[:n], x[n:]
        self._begin(from_velocity=False)

    def _begin(self, from_velocity: bool) -> None:
        row = self.lowered.row
        self.elapsed = 0.0
        self.place(from_velocity)
        if self._adaptive:
            self.work.scale[0] = max(1e-3, float(np.abs(self.y[1 : row - 1]).max()))
            self.work.scale[1] = max(1e-3, float(np.abs(self.y[row + 1 : 2 * row - 1]).max()))
        self.forget_peaks()

    def place(self, from_velocity: bool = False) -> None:
        """Put the driver and the slope, where every kernel expects it, in step with y."""
        theta, slots = 2 * np.pi * self.grid_index / self.grid, self.lowered.slots
        if slots.tension is not None:  # what the last step left behind
            slots.tension.slack[:] = 0
        if self._in_uv:
            v0 = slots.driver.amplitude * slots.driver.beta * np.cos(theta)
            naive_motion(slots, slots.driver.amplitude * np.sin(theta), v0, self.y, self.work.k[0], self.work.forces)
        else:
            place(slots, theta, self.y, self.work.k[0], self.work.forces, from_velocity)

    @property
    def state(self) -> State:
        """The present state in SI."""
        lo, row = self.lowered, self.lowered.row
        self.place(from_velocity=False)
        return State(self.y[1 : row - 1] * lo.scales.length, self.work.k[0, 1 : row - 1] * lo.scales.velocity,
                     self.grid_index / self.grid)

    # --- motion --------------------------------------------------------------------------------------------

    def empty_samples(self, rows: int) -> Samples:
        """Arrays for `rows` samples in scaled units."""
        n = self.lowered.beads
        energy = np.zeros((rows, 3)) if self.lowered.slots.balance is not None else None
        return Samples(np.zeros((rows, n)), np.zeros((rows, n)), np.zeros((rows, n + 1)), energy)

    @flushed
    def record(self, count: int) -> Samples:
        """Advance by `count` samples and keep them, the present one first: count + 1 rows.

        Raises `NumbersFailed`, `Cancelled`.
        """
        self._remember()
        samples, periods = self.empty_samples(count + 1), count / self.samples
        self.log = new_log(self.log, round(_CLOSINGS * (1.0 + periods) * self.lowered.row))
        every = self.grid // self.samples
        lo, work = self.lowered, self.work
        if self._adaptive:
            status, rows = run_certified(self.method, lo.slots, lo.beta, lo.period, self.y, work, self.clock,
                                         self.grid_index, count * every, self.grid, every, samples, self.log,
                                         self.counts.array, self.stop.flag)
        else:
            status, rows = run_samples(self.method, lo.slots, self.drive, self.h, self.y, work,
                                                self.grid_index, every, samples, self.log, self.counts.array,
                                                self.stop.flag)
        self.grid_index = (self.grid_index + count * every) % self.grid
        raise_for(self, status, max(0, rows - 1) / self.samples, self._before)
        self.elapsed += count / self.samples
        return samples

    def forget_peaks(self) -> None:
        """Watch for the largest forces afresh."""
        forget(self.log.peaks)

    @property
    def tops(self) -> np.ndarray:
        """The largest input, output and elastic output force since then, in scaled units."""
        return self.log.peaks[:MEMORY:ROWS].copy()

    @property
    def jumps(self) -> np.ndarray:
        """The largest jumps of input and output force since then (2,), in scaled units."""
        return self.log.peaks[MEMORY:].copy()

    @property
    def closings(self) -> np.ndarray:
        """The jumps of the last record (J, 4): sample before it, drive phase θ, contact, scaled force just after."""
        return self.log.closings[: self.log.met[0]]

    @property
    def unresolved(self) -> int:
        """How many of them were touches within a step, by a method that does not locate events."""
        return int(self.log.met[1])

    @property
    def closings_missing(self) -> int:
        """How many jumps there were behind these, for which there was no place."""
        return max(0, int(self.log.met[0]) - len(self.log.closings))

    def largest_forces(self, periods: int) -> np.ndarray:
        """Advance by whole periods: the largest input, output and elastic output force on the way (3,), scaled."""
        self.forget_peaks()
        self.record(periods * self.samples)
        return self.tops

    @flushed
    def periods(self, count: int, watch: bool = True) -> tuple[np.ndarray, np.ndarray]:
        """Advance by whole periods from phase 0.

        Returns the stroboscopic states (count + 1, 2, N), displacement and velocity in scaled units, and the largest
        input, output and elastic output force of each period (count, 3); without `watch` the certified method does
        not look for the forces and they are NaN.
        """
        self._remember()
        self.log = new_log(self.log)
        strobes, tops = np.zeros((count + 1, 2, self.lowered.row)), np.full((count, 3), np.nan)
        if self._adaptive:
            self._certified_periods(strobes, tops, watch)
        else:
            status, done = run_periods(self.method, self.lowered.slots, self.drive, self.h, self.y, self.work,
                                                strobes, self.log, tops, self.counts.array, self.stop.flag)
            raise_for(self, status, done, self._before)
        self.elapsed += count
        return strobes[:, :, 1:-1], tops

    def _certified_periods(self, strobes: np.ndarray, tops: np.ndarray, watch: bool) -> None:
        lo, keep, row = self.lowered, self.empty_samples(2), self.lowered.row
        strobes[0] = self.y[:row], self.work.k[0, :row]
        for p in range(len(tops)):
            next_period(self.log.peaks)
            status, _ = run_certified(self.method, lo.slots, lo.beta, lo.period, self.y, self.work, self.clock, 0,
                                  self.grid, self.grid, self.grid if watch else 0, keep, self.log,
                                  self.counts.array, self.stop.flag)
            self.raise_for(status, p)
            strobes[p + 1] = self.y[:row], self.work.k[0, :row]
            if watch:
                tops[p] = self.tops

    def raise_for(self, status: int, done: float) -> None:
        """Turn the status of a kernel that someone ran with this engine into an outcome, after `done` periods."""
        raise_for(self, status, done, None)

    def _remember(self) -> None:
        """Keep the state from which a failure would have to be searched; one that is there already is said at once."""
        check_start(self)
        self._before = self.y.copy(), self.work.k[0].copy(), self.grid_index
