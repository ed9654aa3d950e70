"""The largest Lyapunov exponent of the stroboscopic map from a neighbouring trajectory.

Source     Benettin, Galgani & Strelcyn 1976, Phys. Rev. A 14, 2338
"""

from __future__ import annotations

import numpy as np

from ..integrate import Engine
from ..integrate.batch import NEVER, Batch
from ..kernels.batch.period_end import STROBES_KEPT
from ..kernels.strobes.periodicity import LONGEST_PERIOD
from ..kernels.width import BATCH_SIZE
from ..scaling import ScaledChain

#: Distance of the neighbouring trajectory in drive amplitudes: far above rounding, far below the kinks of the contacts.
_DISTANCE = 1e-8
#: Largest ratio of steps per period of two scenes that run side by side: the faster one runs on until the slower one
#: has finished, and these extra strobes must not overwrite those that count.
MOST_APART = 2.5


def exponents_in_pairs(scenes: list[tuple[ScaledChain, np.ndarray]], blocks: int, block: int,
                       pairs: Batch) -> list[tuple[np.ndarray, ...]]:
    """`exponents` of scenes side by side in pairs of members of the batch `pairs`, whose earlier members it replaces.

    Each begins in its scaled state (2(N+2),) at phase 0.

    Returns for each the exponents (blocks,), its strobes (P, 2, N) of displacement and w, the largest forces of its
    last periods (16, 3), scaled, and its last scaled state; exponents are NaN where the motion did not stay finite. The
    result for one does not depend on the others; their steps a period may differ by a factor `MOST_APART`.
    """
    steps = [scaled.steps_per_period() for scaled, _ in scenes]
    if max(steps) > MOST_APART * min(steps):
        raise ValueError(f"steps a period {steps} differ by more than a factor {MOST_APART:g}")
    periods = (blocks + 1) * block
    for i, (scaled, y) in enumerate(scenes):
        pairs.put(2 * i, scaled, y, 1, periods, NEVER)
        pairs.put(2 * i + 1, scaled, y + _offset(scaled.bodies), 1, periods, NEVER)
    for member in range(2 * len(scenes), BATCH_SIZE):
        pairs.empty(member)
    growth = pairs.run_pairs(_DISTANCE, periods)
    return [(growth[i, block:].reshape(blocks, block).mean(axis=1), *_record(pairs, 2 * i, periods))
            for i in range(len(scenes))]


def _offset(bodies: int) -> np.ndarray:
    """From a chain to its neighbouring trajectory, (2(N+2),): random, `_DISTANCE` long.

    It is the same for every chain of this length.
    """
    offset = np.random.default_rng(0).standard_normal(2 * bodies)
    offset[[0, bodies - 1, bodies, 2 * bodies - 1]] = 0.0
    return np.asarray(offset * (_DISTANCE / np.linalg.norm(offset)))


def _record(pairs: Batch, member: int, periods: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Strobes, last largest forces and last state of a member's own periods: it runs on until the slowest is done."""
    strobes = pairs.state.strobes[member, : periods + 1]
    last = np.arange(periods - LONGEST_PERIOD + 1, periods + 1) % STROBES_KEPT
    return strobes[1:, :, 1:-1].copy(), pairs.state.maxima[member, last, :3].copy(), strobes[-1].ravel().copy()


def exponents(engine: Engine, blocks: int, block: int) -> tuple[np.ndarray, np.ndarray]:
    """Mean exponent per period of each block of `block` periods, after one block to turn into the leading direction.

    `engine` is a fixed-step one at phase 0 and goes on; returns the exponents (blocks,) and its strobes (P, 2, N).
    In each period the usual kernel runs the chain and the neighbouring trajectory (`shadow`); then the distance between
    them is measured, and the neighbour is put back to the first distance.
    """
    row, count = 2 * engine.scaled.bodies, (blocks + 1) * block
    shadow = Engine(engine.scaled.scene, engine.setting, engine.samples, stop=engine.stop)
    shadow.start(engine.state)
    offset = _offset(engine.scaled.bodies)
    growth, strobes = np.zeros(count), np.zeros((count, 2, engine.scaled.beads))
    for period in range(count):
        shadow.y[:row] = engine.y[:row] + offset
        shadow.place()
        strobes[period] = engine.periods(1)[0][1]
        shadow.periods(1)
        offset = shadow.y[:row] - engine.y[:row]
        distance = max(float(np.linalg.norm(offset)), 1e-300)
        growth[period] = np.log(distance / _DISTANCE)
        offset *= _DISTANCE / distance
    return growth[block:].reshape(blocks, block).mean(axis=1), strobes
