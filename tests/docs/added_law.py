"""What is asked of the law that docs/add-a-damping-law.md adds; run by pytest in a tree in which it has been added."""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core import LiveChain, resonance_curve, run, scene, settled
from granchain_core.hard.damping import bounce
from granchain_core.hard.oracle import restitution
from granchain_core.integrate import Engine, Setting
from granchain_core.orbits.flow import StroboscopicMap

CHAIN = scene("sec2").evolve(N=3, f=600.0, accuracy=1e-4, dissipation="three-quarters")
REFINED = (1, 2, 4, 8, 16)


def test_every_way_to_the_steady_state_gives_the_same_force() -> None:
    """The certified or fixed step, the SIMD step, the batch; the next law's force differs by more than is allowed."""
    force = settled(CHAIN).run.max_output_force
    other = settled(CHAIN.evolve(dissipation="kuwabara-kono")).run.max_output_force
    assert abs(other / force - 1.0) > 5e-3
    live = LiveChain(CHAIN)
    live.advance(200 * live.samples)
    assert live.advance(live.samples).max_output_force == pytest.approx(force, rel=1e-3)
    assert resonance_curve(CHAIN, [CHAIN.f]).points[0].max_output_force == pytest.approx(force, rel=1e-3)


def test_energy_is_accounted_for() -> None:
    """Work of the driver = lost in contacts + stored, to the accuracy of the motion."""
    assert run(CHAIN, periods=0, record=10).energy_residual < 1e-4


def motion(f: float, setting: Setting) -> np.ndarray:
    """Displacements over three periods from rest, eight a period."""
    return Engine(scene("sec2").evolve(f=f, dissipation="three-quarters"), setting, 8).record(24).displacement


@pytest.mark.parametrize(("method", "least", "most"), [("rk4-split", 3.3, 5.0), ("rk4", 2.0, 3.0)])
def test_split_steps_keep_their_order_across_contact_events(method: str, least: float, most: float) -> None:
    """3.5, because what Simpson's rule gives too much of G is known; steps across events have 2.5."""
    errors = []
    for f in (340.0, 615.0, 1130.0):
        true = motion(f, Setting("dop853", tolerance=1e-13))
        errors.append([np.abs(motion(f, Setting(method, refine=r)) - true).max() for r in REFINED])
    assert least < -np.polyfit(np.log(REFINED), np.log(errors).mean(axis=0), 1)[0] < most


def test_tangent_is_the_derivative_of_the_map() -> None:
    """Every column against central differences, whose own error is about h² = 1e-10 over the kinks of the contacts."""
    strobe, h = StroboscopicMap(CHAIN, 1), 1e-5
    here = np.concatenate([np.linspace(0.3, 0.1, 3), np.zeros(3)])
    flow = strobe(here)
    for column, unit in enumerate(np.eye(6)):
        difference = (strobe(here + h * unit).end - strobe(here - h * unit).end) / (2 * h)
        np.testing.assert_allclose(flow.derivative[:, column], difference, atol=1e-4)
    sign, logarithm = np.linalg.slogdet(flow.derivative)
    assert sign > 0.0 and logarithm == pytest.approx(flow.log_determinant, rel=1e-9)


@pytest.mark.parametrize("cut", [False, True])
def test_restitution_is_that_of_an_independent_quadrature(cut: bool) -> None:
    """Tension allowed, and cut where F/g goes through zero."""
    assert bounce("three-quarters", 0.3, cut) == pytest.approx(restitution("three-quarters", 0.3, cut), abs=1e-8)
