"""A touch that begins and ends within one fixed step is found, by vector code and by scalar code."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from thrown_bead import thrown_by_a_touch

from granchain_core import State, scene
from granchain_core.integrate import Engine, MethodSetting
from granchain_core.integrate.scaling import scale_chain


@pytest.mark.parametrize("vectors", [True, False])
@pytest.mark.parametrize("depth", [1e-6, 1e-5])
def test_a_touch_inside_a_step_throws_the_bead(depth: float, vectors: bool) -> None:
    """The driver reaches `depth` beyond a bead at rest for a part of a step: two events with a tiny impulse.

    It throws the bead with at most 1e-9 of the drive's speed. The correction next to an event assumes that the overlap
    continues to grow. For so brief a touch it exceeds the impulse itself, by at most 1e-9.
    """
    chain = scene("sec2").evolve(N=1, f=500.0, D=100.0)
    finer = (MethodSetting("rk4-split", refine=1.0 + 0.01 * i) for i in range(100))
    engine = Engine(chain, next(s for s in finer if s.steps_per_period(scale_chain(chain), 1) % 4 == 2), 1)
    slots = engine.scaled.slots
    far = slots.chain._replace(stiffness=np.array([1.0, 0.0]))  # the wall exerts no force
    engine.use(replace(engine.scaled, slots=slots._replace(chain=far, dissipation=type(slots.dissipation)(0.0))))
    engine.stepper.work = engine.stepper.work._replace(simd=engine.stepper.new_simd_workspace() if vectors else None)
    beta = engine.scaled.beta
    assert 2.0 * np.sqrt(2.0 * depth) / beta < 0.9 * engine.stepper.h  # shorter than the step, whose middle is the turning point
    engine.start(State(np.array([(1.0 - depth) * chain.A0]), np.zeros(1)))
    kept = engine.record(1)
    assert engine.counts.events == 2
    assert abs(kept.velocity[-1, 0] - thrown_by_a_touch(depth, beta)) < 1.5e-9
