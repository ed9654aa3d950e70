"""Lyapunov exponents from dop853's motion and tangents, with which measured exponents are compared."""

from __future__ import annotations

import numpy as np

from granchain_core import Scene, State
from granchain_core.orbits.stroboscopic_map import StroboscopicMap


def by_tangents(chain: Scene, state: State, blocks: int, block: int, count: int = 2) -> tuple[np.ndarray, np.ndarray]:
    """Return the `count` largest exponents per period and their standard errors, from dop853's motion and tangents."""
    stroboscopic_map = StroboscopicMap(chain, 1)
    x = stroboscopic_map.inner(stroboscopic_map.engine.scaled.from_si(state))
    frame, _ = np.linalg.qr(np.random.default_rng(3).standard_normal((len(x), count)))
    growth = []
    for _ in range((blocks + 1) * block):
        flow = stroboscopic_map(x)
        frame, triangle = np.linalg.qr(flow.derivative @ frame)
        x = flow.end
        growth.append(np.log(np.abs(np.diag(triangle))))
    means = np.array(growth)[block:].reshape(blocks, block, count).mean(axis=1)
    return means.mean(axis=0), means.std(axis=0, ddof=1) / np.sqrt(blocks)
