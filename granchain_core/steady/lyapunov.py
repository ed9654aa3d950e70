"""The largest Lyapunov exponent of the stroboscopic map from a neighbouring trajectory.

Source     Benettin, Galgani & Strelcyn 1976, Phys. Rev. A 14, 2338
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from ..integrate import Engine
from ..integrate.batch import Batch
from ..kernels.batch.record import STROBES_KEPT
from ..kernels.strobes.periodicity import LONGEST_PERIOD
from ..scaling import ScaledChain

#: [chaotic, quasi-periodic] Distance of the neighbouring trajectory, in drive amplitudes. It is far above rounding and
#: far below the kinks of the contacts.
_DISTANCE = 1e-8


def put_with_shadow(batch: Batch, member: int, shadow: int, scaled: ScaledChain, y: np.ndarray, blocks: int,
                    block: int, offset: np.ndarray | None = None) -> None:
    """Make a scene a member of a batch for `exponents_of`, its shadow in another lane, from the scaled state y.

    The shadow begins at y + `offset` (2(N+2),), where an earlier measurement ended, or in a random direction.
    """
    begin = _offset(scaled.bodies) if offset is None else offset
    batch.put_pair(member, shadow, scaled, y, begin, _DISTANCE, (blocks + 1) * block)


@dataclass(frozen=True, eq=False)
class MeasuredExponents:
    """What a member with a shadow has shown.

    `exponents` (blocks,) are mean exponents per period, `strobes` (P, 2, N) displacement and w at the ends of the
    periods, `maxima` (16, 3) the largest forces of the last periods, `y` (2(N+2),) the last state, all scaled; `offset`
    (2(N+2),) leads from there to the shadow.
    """

    exponents: np.ndarray
    strobes: np.ndarray
    maxima: np.ndarray
    y: np.ndarray
    offset: np.ndarray


def exponents_of(batch: Batch, member: int, block: int) -> MeasuredExponents:
    """The exponents of a member that is due and has kept its shadow.

    In the first block, which does not count, the shadow turns to the leading direction.
    """
    growth = batch.growth(member)
    periods, state = len(growth), batch.state
    strobes = state.strobes[member, : periods + 1]
    last = np.arange(periods - LONGEST_PERIOD + 1, periods + 1) % STROBES_KEPT
    return MeasuredExponents(growth[block:].reshape(-1, block).mean(axis=1), strobes[1:, :, 1:-1].copy(),
                             state.maxima[member, last, :3].copy(), strobes[-1].ravel().copy(),
                             state.y[:, state.shadow[member]] - state.y[:, member])


@functools.cache
def _offset(bodies: int) -> np.ndarray:
    """From a chain to its neighbouring trajectory, (2(N+2),): random, `_DISTANCE` long.

    It is the same for every chain of this length.
    """
    offset = np.random.default_rng(0).standard_normal(2 * bodies)
    offset[[0, bodies - 1, bodies, 2 * bodies - 1]] = 0.0
    offset *= _DISTANCE / np.linalg.norm(offset)
    offset.flags.writeable = False
    return offset


def exponents(engine: Engine, blocks: int, block: int,
              offset: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Mean exponent per period of each block of `block` periods, after one block to turn into the leading direction.

    `engine` is at phase 0 and goes on; returns the exponents (blocks,), its strobes (P, 2, N) and the
    last offset (2(N+2),) of the neighbouring trajectory (`shadow`), with which the next measurement may begin: without
    one it begins in a random direction. In each period the usual kernel runs both; then the distance between them is
    measured, and the neighbour is put back to the first distance.
    """
    row, count = 2 * engine.scaled.bodies, (blocks + 1) * block
    shadow = Engine(engine.scaled.scene, engine.setting, engine.samples, stop=engine.stop)
    shadow.start(engine.state)
    offset = _offset(engine.scaled.bodies) if offset is None else offset
    growth, strobes = np.zeros(count), np.zeros((count, 2, engine.scaled.beads))
    for period in range(count):
        shadow.y[:row] = engine.y[:row] + offset
        shadow.evaluate()
        strobes[period] = engine.periods(1)[0][1]
        shadow.periods(1)
        offset = shadow.y[:row] - engine.y[:row]
        distance = max(float(np.linalg.norm(offset)), 1e-300)
        growth[period] = np.log(distance / _DISTANCE)
        offset *= _DISTANCE / distance
    return growth[block:].reshape(blocks, block).mean(axis=1), strobes, offset
