"""Tests of the law that docs/add-a-damping-law.md adds, which pytest runs in a tree that has the law."""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core import LiveChain, resonance_curve, run, scene, settle
from granchain_core.integrate import Engine, MethodSetting
from granchain_core.kernels.error_control.force_kinks import scaled_force
from granchain_core.orbits.stroboscopic_map import StroboscopicMap
from granchain_core.scene.laws import LAWS

CHAIN = scene("sec2").evolve(N=3, f=600.0, D=400.0, accuracy=1e-4, dissipation="three-quarters")
REFINED = (1, 2, 4, 8, 16)


def test_every_way_to_the_steady_state_gives_the_same_state() -> None:
    """dop853, a batch, and the fixed-step method after 200 periods agree in the displacements at phase 0."""
    orbit = settle(CHAIN).state.displacement
    live = LiveChain(CHAIN)
    near = {"rtol": 0.0, "atol": 1e-4 * CHAIN.A0}
    np.testing.assert_allclose(live.advance(200 * live.samples).displacement[-1], orbit, **near)
    np.testing.assert_allclose(resonance_curve(CHAIN, [CHAIN.f]).points[0].state.displacement, orbit, **near)


def test_energy_is_accounted_for() -> None:
    """Work of the driver = lost in contacts + stored, to the accuracy of the motion."""
    assert run(CHAIN, periods=0, record=10).energy_residual < 1e-4


def motion(f: float, setting: MethodSetting) -> np.ndarray:
    """Return displacements over three periods from rest, eight per period; six beads fit the vectors of the chain
    above.
    """
    return Engine(scene("sec2").evolve(N=6, f=f, dissipation="three-quarters"), setting, 8).record(24).displacement


@pytest.mark.parametrize(("method", "least", "most"), [("rk4-split", 3.3, 5.0), ("rk4", 2.0, 3.0)])
def test_split_steps_keep_their_order_across_contact_events(method: str, least: float, most: float) -> None:
    """Their order is 3.5, because the error of Simpson's rule in G is known and subtracted; steps across events have
    2.5.
    """
    errors = []
    for f in (340.0, 615.0, 1130.0):
        true = motion(f, MethodSetting("dop853", tolerance=1e-13))
        errors.append([np.abs(motion(f, MethodSetting(method, refine=r)) - true).max() for r in REFINED])
    assert least < -np.polyfit(np.log(REFINED), np.log(errors).mean(axis=0), 1)[0] < most


def test_tangent_is_the_derivative_of_the_map() -> None:
    """Every column agrees with central differences, whose error is about h² = 1e-10 over the kinks of the contacts."""
    stroboscopic_map, h = StroboscopicMap(CHAIN, 1), 1e-5
    here = np.concatenate([np.linspace(0.3, 0.1, 3), np.zeros(3)])
    flow = stroboscopic_map(here)
    for column, unit in enumerate(np.eye(6)):
        difference = (stroboscopic_map(here + h * unit).end - stroboscopic_map(here - h * unit).end) / (2 * h)
        np.testing.assert_allclose(flow.derivative[:, column], difference, atol=1e-4)
    sign, logarithm = np.linalg.slogdet(flow.derivative)
    assert sign > 0.0 and logarithm == pytest.approx(flow.log_determinant, rel=1e-9)


def test_a_cut_contact_stops_pushing_where_its_force_is_zero() -> None:
    """The sign of F/g decides, where F = K δ^{3/2} + c δ^{3/4} δ̇."""
    for d, rate in ((0.3, -0.7), (1e-4, -1e-4), (2.0, 1.0)):
        damping = 0.4 * d**0.75
        assert scaled_force(LAWS["three-quarters"].slot(0.4), 1.4, d, rate) == pytest.approx(
            (1.4 * d**1.5 + damping * rate) / damping, rel=1e-13)
