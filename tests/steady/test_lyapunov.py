"""Lyapunov exponents from a neighbouring trajectory agree with an independent method: products of the stroboscopic
map's derivatives with QR decomposition.
"""

from __future__ import annotations

import numpy as np
import pytest
from tangent_exponents import by_tangents

from granchain_core import Scene, State, scene
from granchain_core.execution.stop import Stop
from granchain_core.integrate import Engine, MethodSetting
from granchain_core.integrate.batch import Batch
from granchain_core.integrate.scaling import ScaledChain, scale_chain
from granchain_core.kernels.batch_size import BATCH_SIZE
from granchain_core.steady.lyapunov import MeasuredGrowth, block_means, growth_along, growth_of, put_with_neighbour
from granchain_core.steady.regime_criteria import mean_and_error
from granchain_core.steady.settling.advance import run_until_settled

CHAOTIC = scene("rig").evolve(kappa=0.0, f=100.0, N=3)  # chaotic, like all motions of `rig` without flexures (docs/lecture.md)
QUASI = scene("sec2").evolve(f=1640.0)


def in_pairs(scenes: list[tuple[ScaledChain, np.ndarray]], batch: Batch, periods: int = 220) -> list[MeasuredGrowth | None]:
    """Measure the growth of scenes, each in two lanes of a batch; None if it is not finite."""
    measured: list[MeasuredGrowth | None] = [None] * len(scenes)
    for lane in range(BATCH_SIZE):
        batch.empty(lane)
    for number, (scaled, y) in enumerate(scenes):
        put_with_neighbour(batch, 2 * number, 2 * number + 1, scaled, y, periods)
    for _ in scenes:
        lane, finite = batch.run()
        if finite and np.isfinite(batch.growth(lane)).all():
            measured[lane // 2] = growth_of(batch, lane)
        batch.empty(lane)
        batch.empty(lane + 1)
    return measured


def by_neighbour(chain: Scene, state: State) -> list[tuple[float, float]]:
    """Return mean and standard error from the neighbour of a single chain and from one in a batch."""
    engine = Engine(chain, MethodSetting("rk4-split"), 1)
    engine.start(state)
    scaled = scale_chain(chain)
    (pair,) = in_pairs([(scaled, scaled.from_si(state))], Batch(chain, Stop()))
    assert pair is not None
    alone_and_in_batch = growth_along(engine, 220)[0], pair.growth
    return [mean_and_error(block_means(growth[20:], 10)) for growth in alone_and_in_batch]


def test_a_chaotic_chain_has_the_exponent_of_its_tangent_flow() -> None:
    settling = run_until_settled(CHAOTIC, None, None)
    assert settling.regime.name == "chaotic"
    exact, error = by_tangents(CHAOTIC, settling.engine.state, 10, 12)
    assert exact[0] > 0.5
    for mean, spread in by_neighbour(CHAOTIC, settling.engine.state):
        assert abs(mean - exact[0]) <= 3.0 * np.hypot(spread, error[0])


def test_a_quasi_periodic_chain_has_one_zero_exponent_and_the_rest_below() -> None:
    settling = run_until_settled(QUASI, None, None)
    assert settling.regime.name == "quasi-periodic"
    exact, error = by_tangents(QUASI, settling.engine.state, 10, 30)
    # on a closed curve, tangents align with it within the first block; the rest decays as 1/periods
    assert abs(exact[0]) <= 3.0 * error[0] + 0.01 and exact[1] < -3.0 * error[1]
    for mean, spread in by_neighbour(QUASI, settling.engine.state):
        assert abs(mean - exact[0]) <= 3.0 * np.hypot(spread, error[0]) and abs(mean) < 0.01


@pytest.mark.parametrize("lost", [np.nan, 1e300])
def test_exponents_of_a_scene_do_not_depend_on_those_beside_it(lost: float) -> None:
    """They agree to the last bit, even if another scene was lost, next to it or earlier in its lanes."""
    scaled = scale_chain(QUASI)
    y = scaled.from_si(run_until_settled(QUASI, None, None).engine.state)
    slower = scale_chain(QUASI.evolve(f=QUASI.f / 9.0))
    batch = Batch(QUASI, Stop())
    alone = in_pairs([(scaled, y)], batch, 120)[0]
    assert alone is not None and np.isfinite(alone.growth).all()
    beside = in_pairs([(slower, 0.5 * y), (scaled, y)], batch, 120)
    broken = in_pairs([(slower, lost * y), (scaled, y)], batch, 120)
    assert broken[0] is None and beside[0] is not None
    for other in (beside[1], broken[1], in_pairs([(scaled, y)], batch, 120)[0]):
        assert other is not None
        for name in ("growth", "strobes", "maxima", "y"):
            np.testing.assert_array_equal(getattr(other, name), getattr(alone, name))
