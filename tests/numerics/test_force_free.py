"""A no-tension contact may be closed without force: before it opens, or before it pushes again."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from granchain_core import Scene, State, scene
from granchain_core.integrate import Engine, MethodSetting
from granchain_core.kernels.effects.dissipation import damping

#: Kernels take long to compile, and the hard cases and the fuzzer cover the other laws well enough.
LAW = "tsuji"
SAMPLES = 4096


def thrown() -> Scene:
    """Return precompressed beads, the last one thrown at the wall: the contact behind it stops pushing at once, and
    pushes again before it opens.
    """
    pressed = scene("sec2").evolve(N=3, f=300.0, A0=1.2e-8, F0=0.18, D=850.0, dissipation=LAW, tension="cut")
    return replace(pressed, start_velocity=((3, 1e-3),))


def test_a_force_free_contact_pushes_again() -> None:
    """Compared with RK4 with steps so short that the only kink, which RK4 does not locate, costs less than 1e-8: the
    change from half as many steps shows this.
    """
    chain = thrown()
    found, fine, finer = (Engine(chain, setting, SAMPLES).record(SAMPLES // 8) for setting in (
        MethodSetting("dop853", 1.0, 1e-12), MethodSetting("rk4", 32.0), MethodSetting("rk4", 64.0)))
    largest = np.abs(finer.displacement).max()
    assert np.abs(fine.displacement - finer.displacement).max() / largest < 1e-8
    assert np.abs(found.displacement - finer.displacement).max() / largest < 1e-8
    force = found.force[:, 2] / found.force[:, 2].max()
    assert abs(force[:3]).max() < 1e-12  # without force at first
    assert force[-1] > 0.5


def test_a_force_free_contact_moves_as_if_it_were_open() -> None:
    """Two beads that fly apart from an overlap exert no force on each other, from the first step on.

    They are compared with RK4, whose error comes from a force's fourth root at the opening: below 1e-6 with these
    steps.
    """
    apart = scene("sec2").evolve(N=2, f=2000.0, A0=1e-9, F0=1e-3, D=800.0, dissipation=LAW, tension="cut")
    apart = replace(apart, start_velocity=((1, -2e-3), (2, 2e-3)))
    engine = Engine(apart, MethodSetting("dop853", 1.0, 1e-10), SAMPLES)
    kept = engine.record(SAMPLES // 64)
    assert (kept.force[1:, 1] == 0.0).all()
    static = apart.static_overlap()[1] / engine.scaled.scales.length
    overlap = kept.displacement[:, 0] - kept.displacement[:, 1] + static
    assert overlap[0] > 0.0 > overlap[-1]
    fine = Engine(apart, MethodSetting("rk4", 64.0), SAMPLES).record(SAMPLES // 64)
    assert np.abs(fine.displacement - kept.displacement).max() < 1e-6 * np.abs(kept.displacement).max()


def test_a_start_on_the_kink_may_be_taken_for_either_side() -> None:
    """Where F = 0 up to rounding, its sign is arbitrary; starts a billionth to either side lead to the same motion."""
    rng = np.random.default_rng(3)
    for preload in 10.0 ** rng.uniform(-3.0, 0.0, 30):
        chain = scene("sec2").evolve(N=2, f=300.0, A0=1e-9, F0=preload, D=800.0, dissipation=LAW, tension="cut")
        engine = Engine(chain, MethodSetting("dop853", 1.0, 1e-12), SAMPLES)
        scales, slots = engine.scaled.scales, engine.scaled.slots
        overlap = slots.preload.static[1]
        kink = slots.chain.stiffness[1] * overlap**1.5 / damping(slots.dissipation, overlap)
        ends = []
        for factor in (1.0 - 1e-9, 1.0, 1.0 + 1e-9):
            engine.start(State(np.zeros(2), np.array([0.0, factor * kink]) * scales.velocity))
            ends.append(engine.record(SAMPLES // 256).displacement)
        largest = np.abs(ends[1]).max()
        assert max(np.abs(end - ends[1]).max() for end in ends) / largest < 1e-8
