"""The driver's work and the energy lost are right at every instant, not only after whole periods."""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core import scene
from granchain_core.integrate import Engine, MethodSetting

pytestmark = pytest.mark.quick

SAMPLES = 4096


def test_work_and_loss_on_the_way_are_the_integrals_up_to_there() -> None:
    """W(t) = ∫ F_0 v_0 dt and Q(t) = ∫ Σ (F − F_el) δ̇ dt within a period, including the term G_0 v_0.

    The integrals use the trapezoidal rule. The dashpot's force jumps about twenty times in a period, and each jump
    costs half a spacing.
    """
    shown = scene("sec2").evolve(N=5, f=900.0, kappa=0.002, F0=2.0)
    engine = Engine(shown, MethodSetting("dop853", tolerance=1e-9), SAMPLES, account=True)
    kept, scaled = engine.record(SAMPLES), engine.scaled
    theta = 2 * np.pi * np.arange(SAMPLES + 1) / SAMPLES
    v0, rows = scaled.beta * np.cos(theta), np.zeros((SAMPLES + 1, 1))
    bodies = np.hstack([np.sin(theta)[:, None], kept.displacement, rows])
    speeds = np.hstack([v0[:, None], kept.velocity, rows])
    overlap = np.maximum(-np.diff(bodies, axis=1) + shown.static_overlap() / scaled.scales.length, 0.0)
    damped = kept.force - scaled.slots.chain.stiffness * overlap**1.5
    for power, found in ((kept.force[:, 0] * v0, kept.energy[:, 1]), ((damped * -np.diff(speeds, axis=1)).sum(axis=1), kept.energy[:, 2])):
        spacing = scaled.period / SAMPLES
        summed = np.concatenate([[0.0], np.cumsum(0.5 * spacing * (power[1:] + power[:-1]))])
        near = 20 * 0.5 * spacing * np.abs(np.diff(power)).max()
        np.testing.assert_allclose(found - found[0], summed, atol=near)
        assert np.abs(summed).max() > 20 * near  # the comparison is meaningful
