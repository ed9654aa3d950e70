"""The largest Lyapunov exponent of the stroboscopic map from a shadow trajectory (Benettin et al. 1980)."""

from __future__ import annotations

import numpy as np

from ..integrate import Engine
from ..integrate.lane_block import NEVER, LaneBlock
from ..kernels.section import LONGEST_PERIOD
from ..kernels.shadow import run_shadowed
from ..lower import Lowered

#: Distance of the shadow, relative to the motion: far above rounding, far below the kinks of the contacts.
_DISTANCE = 1e-8


def exponents_in_pairs(scenes: list[tuple[Lowered, np.ndarray]], blocks: int, block: int,
                       stop: np.ndarray) -> list[tuple[np.ndarray, ...]]:
    """`exponents` of up to four scenes side by side in lanes, each from its scaled state (2(N+2),) at phase 0.

    Of each the exponents (blocks,), its strobes (P, 2, N) of displacement and w, the largest forces of its last periods
    (16, 3), scaled, and its last scaled state; exponents are NaN where the motion did not stay finite.
    """
    pairs, periods = LaneBlock(scenes[0][0].scene, stop), (blocks + 1) * block
    size = max(1e-6, max(float(np.abs(y[: lowered.row]).max()) for lowered, y in scenes))
    for i, (lowered, y) in enumerate(scenes):
        row = lowered.row
        offset = np.random.default_rng(0).standard_normal(2 * row)
        offset[[0, row - 1, row, 2 * row - 1]] = 0.0
        pairs.put(2 * i, lowered, y, 1, periods, NEVER)
        pairs.put(2 * i + 1, lowered, y + offset * (_DISTANCE * size / np.linalg.norm(offset)), 1, periods, NEVER)
    growth = pairs.run_pairs(_DISTANCE * size, periods)
    return [(growth[i, block:].reshape(blocks, block).mean(axis=1), pairs.strobes(2 * i, periods).copy(),
             np.array([pairs.tops(2 * i, n) for n in range(LONGEST_PERIOD, 0, -1)]),
             pairs.state.y[:, 2 * i].copy()) for i in range(len(scenes))]


def exponents(engine: Engine, blocks: int, block: int) -> tuple[np.ndarray, np.ndarray]:
    """Mean exponent per period of each block of `block` periods, after one block to turn into the leading direction.

    `engine` is a fixed-step one at phase 0 and goes on; returns the exponents (blocks,) and its strobes (P, 2, N).
    """
    shadow = Engine(engine.lowered.scene, engine.setting, engine.samples, stop=engine.stop)
    shadow.start(engine.state)
    row = engine.lowered.row
    offset = np.random.default_rng(0).standard_normal(2 * row)
    offset[[0, row - 1, row, 2 * row - 1]] = 0.0
    size = max(1e-6, float(np.abs(engine.y[1 : row - 1]).max()))
    shadow.y[: 2 * row] = engine.y[: 2 * row] + offset * (_DISTANCE * size / np.linalg.norm(offset))
    shadow.place()
    growth = np.zeros((blocks + 1) * block)
    strobes = np.zeros((len(growth), 2, row))
    # step by step, whatever vectors the engine has: one kernel for chains of every length
    one, other = engine.work._replace(along=None), shadow.work._replace(along=None)
    status, done = run_shadowed(engine.method, engine.lowered.slots, engine.drive, engine.h, engine.y, shadow.y,
                                one, other, growth, strobes, engine.counts.array, engine.stop)
    engine.raise_for(status, done)
    return growth[block:].reshape(blocks, block).mean(axis=1), strobes[:, :, 1:-1]
