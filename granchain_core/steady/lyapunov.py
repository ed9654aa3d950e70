"""The largest Lyapunov exponent of the stroboscopic map from a neighbouring trajectory, and its mean over blocks.

Source     Benettin, Galgani & Strelcyn 1976, Phys. Rev. A 14, 2338; overlapping blocks with windows: Welch 1967
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from ..integrate import Engine
from ..integrate.batch import Batch
from ..integrate.scaling import ScaledChain
from ..kernels.batch.record import STROBES_KEPT
from ..kernels.strobes.periodicity import LONGEST_PERIOD

#: [chaotic, quasi-periodic] Distance of the neighbouring trajectory, in drive amplitudes. It is far above rounding, and
#: so small that a contact event hardly ever falls between the two trajectories.
_DISTANCE = 1e-8
#: [no threshold] Replaces a distance of zero, which has no logarithm: far below any other, but not subnormal.
_NO_DISTANCE = 1e-300


def put_with_neighbour(batch: Batch, member: int, lane: int, scaled: ScaledChain, y: np.ndarray, periods: int,
                       offset: np.ndarray | None = None) -> None:
    """Make a scene a member of a batch, from the scaled state y, with its neighbour in another lane, for `growth_of`.

    The neighbour starts at y + `offset` (2(N+2),), where an earlier measurement ended, or in a random direction.
    """
    begin = _offset(scaled.bodies) if offset is None else offset
    batch.put_pair(member, lane, scaled, y, begin, _DISTANCE, periods)


def block_means(growth: np.ndarray, blocks: int) -> np.ndarray:
    """Mean growth per period (blocks,) in blocks of equal length that overlap by half, weighted by Hann windows.

    On a closed curve a distance oscillates, so a plain mean is wrong by the oscillation at its two ends divided by the
    number of periods. The windows go to zero there, over half a block: oscillations much shorter than that are averaged
    out, and longer ones are not (`_BOUNDED_GROWTH` in regime_criteria.py). The windows add up to 1 between the first
    and the last block, so all periods have equal weight there; a remainder is left out at the beginning. Two
    neighbouring blocks correlate by 1/6 if the periods are independent (`OVERLAP_FACTOR` in regime_criteria.py).
    """
    half = len(growth) // (blocks + 1)
    halves = growth[len(growth) - half * (blocks + 1) :].reshape(blocks + 1, half)
    rising = np.sin(np.pi * (np.arange(half) + 0.5) / (2 * half)) ** 2 / half
    return np.asarray(halves[:-1] @ rising + halves[1:] @ rising[::-1])


@dataclass(frozen=True, eq=False)
class MeasuredGrowth:
    """The growth of the distance between a member and its neighbour, and the member's motion.

    `growth` (P,) is the logarithm of the factor by which the distance grows in each period. `strobes` (P, 2, N) are
    displacement and w at the ends of the periods, `maxima` (16, 3) the largest forces of the last periods, and
    `y` (2(N+2),) the last state, all scaled; `offset` (2(N+2),) leads from `y` to the neighbour.
    """

    growth: np.ndarray
    strobes: np.ndarray
    maxima: np.ndarray
    y: np.ndarray
    offset: np.ndarray


def growth_of(batch: Batch, member: int) -> MeasuredGrowth:
    """Return the growth measured for a member that is due and still has its neighbour."""
    growth = batch.growth(member)
    periods, state, y = len(growth), batch.state, batch.state.motion.y
    strobes = state.record.strobes[member, : periods + 1]
    last = np.arange(periods - LONGEST_PERIOD + 1, periods + 1) % STROBES_KEPT
    return MeasuredGrowth(growth.copy(), strobes=strobes[1:, :, 1:-1].copy(),
                          maxima=state.record.maxima[member, last, :3].copy(), y=strobes[-1].ravel().copy(),
                          offset=y[:, state.pairs.neighbour[member]] - y[:, member])


@functools.cache
def _offset(bodies: int) -> np.ndarray:
    """A random offset (2(N+2),) of length `_DISTANCE` to a neighbouring trajectory, the same for every chain of one N.
    """
    offset = np.random.default_rng(0).standard_normal(2 * bodies)
    offset[[0, bodies - 1, bodies, 2 * bodies - 1]] = 0.0
    offset *= _DISTANCE / np.linalg.norm(offset)
    offset.flags.writeable = False
    return offset


def growth_along(engine: Engine, periods: int,
                 offset: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Measure the growth of the distance to a neighbouring trajectory in each of `periods` drive periods.

    `engine` is at phase 0 and is advanced. Returns the logarithm of the growth (P,), the engine's strobes (P, 2, N) and
    the last offset (2(N+2),) of the neighbouring trajectory, with which the next measurement may begin. Without
    `offset`, the neighbour starts in a random direction and needs some periods to turn into the leading one. In each
    period the usual kernel runs both; then the distance between them is measured, and the neighbour is moved back to
    the initial distance.
    """
    row = 2 * engine.scaled.bodies
    neighbour = Engine(engine.scaled.scene, engine.setting, engine.samples, stop=engine.stop)
    neighbour.start(engine.state)
    offset = _offset(engine.scaled.bodies) if offset is None else offset
    growth, strobes = np.zeros(periods), np.zeros((periods, 2, engine.scaled.beads))
    for period in range(periods):
        neighbour.y[:row] = engine.y[:row] + offset
        neighbour.evaluate()
        strobes[period] = engine.periods(1)[0][1]
        neighbour.periods(1)
        offset = neighbour.y[:row] - engine.y[:row]
        distance = max(float(np.linalg.norm(offset)), _NO_DISTANCE)
        growth[period] = np.log(distance / _DISTANCE)
        offset *= _DISTANCE / distance
    return growth, strobes, offset
