"""A block of lanes: scenes are put into lanes, run together, and taken out with their strobes and forces."""

from __future__ import annotations

import math

import numpy as np

from ..errors import Cancelled
from ..kernels.batch import run as kernels
from ..kernels.batch.period_end import COARSE_ERROR_LEFT, FINE, FORCES, STROBES_PER_LANE
from ..kernels.batch.unequal import Unequal
from ..kernels.forces.peaks import PEAKS
from ..kernels.jit import all_in_simd_kernels
from ..kernels.simd.vector import aligned
from ..kernels.status import CANCELLED, DONE
from ..kernels.strobes.extrapolation import ORBITS
from ..kernels.strobes.periodicity import LONGEST_PERIOD
from ..kernels.width import BATCH_LANES
from ..lower import Lowered, lower
from ..scene import Scene
from ..stop import Stop

#: A period that no lane reaches.
NEVER = int(np.iinfo(np.int64).max)
#: Drive periods until the next extrapolation after a failed one, at the start.
_PAUSE = 16
#: Fewest orbits in one round of a finer run.
_FEWEST = 2


def can_share_batch(scene: Scene) -> bool:
    """Whether lanes can run this scene, with every effect it has (the tension cut needs velocities before forces)."""
    return all_in_simd_kernels(lower(scene).slots)


def is_uniform(lowered: Lowered) -> bool:
    """Whether all beads, and all contacts but the wall's, are alike."""
    chain = lowered.slots.chain
    return bool((chain.inverse_mass[1:-1] == 1.0).all() and (chain.stiffness[:-1] == 1.0).all())


def _rows(rows: int) -> np.ndarray:
    """Zeros, one row of all lanes' numbers after another."""
    return aligned(rows, BATCH_LANES)


class Batch:
    """A place in every lane for scenes of one structure and one N, run by one thread."""

    def __init__(self, example: Scene, stop: Stop) -> None:
        lowered = lower(example)
        self.stop = stop
        n, slots = example.N, lowered.slots
        dissipation, foundation, preload = slots.dissipation, slots.foundation, slots.preload
        self.lanes = kernels.Lanes(
            wall=_rows(1), unequal=None if is_uniform(lowered) else Unequal(_rows(n + 2), _rows(n + 1)),
            dissipation=None if dissipation is None else type(dissipation)(_rows(1)),
            foundation=None if foundation is None else type(foundation)(_rows(1)),
            preload=None if preload is None else type(preload)(_rows(n + 1)),
            turn=_rows(2), beta=_rows(1), h=_rows(1),
        )
        rows = 2 * (n + 2)
        whole = [np.zeros(BATCH_LANES, dtype=np.int64) for _ in range(10)]
        parts = [np.zeros(BATCH_LANES) for _ in range(2)]
        self.state = kernels.BatchState(
            y=_rows(rows), gaps=_rows(n + 1), ends=_rows(4), phase=_rows(2), peaks=_rows(PEAKS),
            steps=whole[0], left=whole[1], periods=whole[2], return_at=whole[3], earliest=whole[4],
            extrapolate_from=whole[5], pause=whole[6], kept=whole[7], testing=whole[8], due=whole[9], slowest=parts[0],
            change_before_extrapolation=parts[1], before=np.zeros((BATCH_LANES, 2, n + 2)),
            fine_record=np.zeros((BATCH_LANES, FINE)), strobes=np.zeros((BATCH_LANES, 2 * STROBES_PER_LANE, 2, n + 2)),
            maxima=np.zeros((BATCH_LANES, STROBES_PER_LANE, 5)),
            last_check=np.zeros((BATCH_LANES, 3)), scale=np.zeros(2), change=np.zeros(3 * LONGEST_PERIOD),
            limit=np.zeros((2, n + 2)), basis=np.zeros((ORBITS, rows)), triangle=np.zeros((ORBITS, ORBITS)),
        )
        for lane in range(BATCH_LANES):  # an empty lane runs the example at rest and is never checked
            self.put(lane, lowered, np.zeros(rows), 1, NEVER, NEVER)

    def put(self, lane: int, lowered: Lowered, y: np.ndarray, refine: float, return_at: int, earliest: int = 0) -> None:
        """Start a scene in a lane from the scaled state y at phase 0, with `refine` times the live method's steps.

        It is checked after `return_at` periods, or from `earliest` on once it may have settled.
        """
        slots, lanes, state = lowered.slots, self.lanes, self.state
        steps = math.ceil(refine * lowered.steps_per_period())
        lanes.wall[0, lane] = slots.chain.stiffness[-1]
        if lanes.unequal is not None:
            lanes.unequal.inverse_mass[:, lane] = slots.chain.inverse_mass
            lanes.unequal.stiffness[:, lane] = slots.chain.stiffness
        for mine, its in ((lanes.dissipation, slots.dissipation), (lanes.foundation, slots.foundation),
                          (lanes.preload, slots.preload)):
            if mine is not None:
                mine[0][:, lane] = its[0]
        half = np.pi / steps
        lanes.turn[:, lane] = np.cos(half), np.sin(half)
        lanes.beta[0, lane], lanes.h[0, lane] = lowered.beta, lowered.period / steps
        state.phase[:, lane] = 0.0, 1.0
        state.peaks[:, lane] = 0.0
        state.steps[lane] = state.left[lane] = steps
        state.y[:, lane], state.gaps[:, lane] = y, 0.0
        state.ends[:, lane] = 1.0  # counts as closed, so that no closing is recorded here
        state.strobes[lane, 0], state.kept[lane] = y.reshape(2, -1), 1
        state.periods[lane], state.return_at[lane], state.earliest[lane] = 0, return_at, earliest
        state.extrapolate_from[lane], state.pause[lane] = 0, _PAUSE
        state.slowest[lane], state.change_before_extrapolation[lane] = 0.0, 0.0
        state.fine_record[lane], state.testing[lane], state.due[lane] = 0.0, 0, 0

    def put_fine(self, lane: int, lowered: Lowered, y: np.ndarray, refine: float, period: int, rate: float,
                 maxima: np.ndarray) -> None:
        """Start a scene on the orbit y of a coarser run, of `period` and decay `rate` per orbit, with its forces.

        It is checked once the difference from that orbit has decayed.
        """
        orbits = min(ORBITS, max(_FEWEST, math.ceil(math.log(COARSE_ERROR_LEFT) / math.log(rate))))
        self.put(lane, lowered, y, refine, NEVER, orbits * period)
        self.state.fine_record[lane] = period, rate, *maxima, orbits, 0.0

    def run(self) -> tuple[int, bool]:
        """Run until a lane is due for a check; its number, and whether it is finite."""
        status, lane = kernels.run_batch(self.lanes, self.state, self.stop.flag)
        if status == CANCELLED:
            raise Cancelled
        return int(lane), status == DONE

    def run_pairs(self, start: float, periods: int) -> np.ndarray:
        """Run lanes (0, 1), (2, 3), … as chains and shadows; the growth of their distances, (pairs, periods).

        It is NaN for a pair that did not stay finite.
        """
        growth = np.zeros((BATCH_LANES // 2, periods))
        if kernels.run_pairs(self.lanes, self.state, start, growth, self.stop.flag) == CANCELLED:
            raise Cancelled
        return growth

    def strobes(self, lane: int, most: int = STROBES_PER_LANE) -> np.ndarray:
        """The last `most` remembered strobes of a lane in order, (P, 2, N), displacement and w in scaled units."""
        kept = int(self.state.kept[lane])
        return self.state.strobes[lane, max(0, kept - most) : kept, :, 1:-1]

    def settled_maxima(self, lane: int, period: int) -> np.ndarray:
        """Largest forces on the orbit a coarse lane has settled on: from before it was disturbed, if it was."""
        disturbed = self.state.slowest[lane] > 0.0
        return self.state.fine_record[lane, FORCES : FORCES + 3].copy() if disturbed else self.maxima(lane, period)

    def maxima(self, lane: int, periods: int) -> np.ndarray:
        """Largest input, output and elastic output force of the last `periods` periods, in scaled units."""
        return self._last(lane, periods)[:3]

    def jumps(self, lane: int, periods: int) -> np.ndarray:
        """Largest jumps of input and output force in the same periods."""
        return self._last(lane, periods)[3:]

    def _last(self, lane: int, periods: int) -> np.ndarray:
        run = int(self.state.periods[lane])
        places = np.arange(max(1, run - min(periods, STROBES_PER_LANE) + 1), run + 1) % STROBES_PER_LANE
        return self.state.maxima[lane, places].max(axis=0)
