"""Lyapunov exponents by the shadow against an independent way: products of the stroboscopic map's derivatives with QR."""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core import Scene, State, scene
from granchain_core.integrate import Engine, Setting
from granchain_core.integrate.batch import Batch
from granchain_core.orbits.stroboscopic_map import StroboscopicMap
from granchain_core.scaling import scale_chain
from granchain_core.steady.lyapunov import exponents, exponents_in_pairs
from granchain_core.steady.settling.settling import run_until_settled
from granchain_core.stop import Stop

CHAOTIC = scene("rig").evolve(kappa=0.0, f=100.0, N=3)  # chaotic, as all of `rig` without flexures (docs/model.md)
QUASI = scene("sec2").evolve(f=1640.0)


def by_tangents(shown: Scene, state: State, blocks: int, block: int, count: int = 2) -> tuple[np.ndarray, np.ndarray]:
    """The `count` largest exponents per period and their standard errors, by the adaptive motion and its tangents."""
    stroboscopic_map = StroboscopicMap(shown, 1)
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


def by_shadow(shown: Scene, state: State) -> list[tuple[float, float]]:
    """Mean and standard error by the one-scene shadow and by the one in a batch."""
    engine = Engine(shown, Setting("rk4-split"), 1)
    engine.start(state)
    scaled = scale_chain(shown)
    found = exponents(engine, 10, 20)[0], exponents_in_pairs([(scaled, scaled.from_si(state))], 10, 20,
                                                             Batch(shown, Stop()))[0][0]
    return [(float(growth.mean()), float(growth.std(ddof=1) / np.sqrt(10))) for growth in found]


def test_a_chaotic_chain_has_the_exponent_of_its_tangent_flow() -> None:
    settling = run_until_settled(CHAOTIC, None, None)
    assert settling.regime.name == "chaotic"
    exact, error = by_tangents(CHAOTIC, settling.engine.state, 10, 12)
    assert exact[0] > 0.5
    for mean, spread in by_shadow(CHAOTIC, settling.engine.state):
        assert abs(mean - exact[0]) <= 3.0 * np.hypot(spread, error[0])


def test_a_quasi_periodic_chain_has_one_zero_exponent_and_the_rest_below() -> None:
    settling = run_until_settled(QUASI, None, None)
    assert settling.regime.name == "quasi-periodic"
    exact, error = by_tangents(QUASI, settling.engine.state, 10, 30)
    # on a closed curve tangents turn into it within the first block; what is left of that dies as 1/periods
    assert abs(exact[0]) <= 3.0 * error[0] + 0.01 and exact[1] < -3.0 * error[1]
    for mean, spread in by_shadow(QUASI, settling.engine.state):
        assert abs(mean - exact[0]) <= 3.0 * np.hypot(spread, error[0]) and abs(mean) < 0.01


def test_exponents_of_a_scene_do_not_depend_on_those_beside_it() -> None:
    scaled = scale_chain(QUASI)
    y = scaled.from_si(run_until_settled(QUASI, None, None).engine.state)
    slower = scale_chain(QUASI.evolve(f=QUASI.f / 2.2))
    pairs = Batch(QUASI, Stop())
    alone = exponents_in_pairs([(scaled, y)], 5, 20, pairs)[0]
    beside = exponents_in_pairs([(slower, 0.5 * y), (scaled, y)], 5, 20, pairs)[1]
    lost = exponents_in_pairs([(slower, np.nan * y), (scaled, y)], 5, 20, pairs)
    after = exponents_in_pairs([(scaled, y)], 5, 20, pairs)[0]  # beside the places of the one that was lost
    for first, *others in zip(alone, beside, lost[1], after, strict=True):
        assert all((first == other).all() for other in others)
    assert np.isnan(lost[0][0]).all()
    with pytest.raises(ValueError, match="differ by more than a factor"):
        exponents_in_pairs([(scaled, y), (scale_chain(QUASI.evolve(f=QUASI.f / 9.0)), y)], 5, 20, pairs)
