"""What lanes believe at the end of a period, from states made by hand; and what they take back beside events."""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core import scene
from granchain_core.integrate.batch import Batch
from granchain_core.kernels.batch import contact_correction, period_end
from granchain_core.kernels.effects.dissipation import KuwabaraKono, LinearDashpot, Tsuji
from granchain_core.kernels.width import BATCH_LANES
from granchain_core.stop import Stop

LANE, ROW = BATCH_LANES - 2, 4


def seen(record: np.ndarray) -> Batch:
    """A block of two-bead chains in one lane of which all numbers of the beads were `record`, strobe by strobe."""
    block = Batch(scene("sec2").evolve(N=2), Stop())
    block.state.strobes[LANE, : len(record), :, 1:-1] = record[:, None, None]
    block.state.kept[LANE] = block.state.periods[LANE] = len(record)
    block.state.y[[1, 2, ROW + 1, ROW + 2], LANE] = record[-1]
    return block


def test_an_orbit_found_by_extrapolation_is_disturbed_before_it_is_believed() -> None:
    """States that repeat are periodic where the chain came there by itself; where it was put there they are tried."""
    block = seen(np.ones(60))
    assert period_end.check_coarse.py_func(block.state, LANE)
    block = seen(np.ones(60))
    block.state.slowest[LANE] = 0.9
    assert not period_end.check_coarse.py_func(block.state, LANE)
    assert block.state.testing[LANE] == 1
    moved = np.abs(block.state.y[[1, 2, ROW + 1, ROW + 2], LANE] - 1.0)
    assert moved == pytest.approx(period_end._DISTURBANCE, rel=1e-9)


@pytest.mark.parametrize(("rate", "stable"), [(0.8, True), (1.2, False)])
def test_an_orbit_is_believed_where_its_disturbance_decays(rate: float, stable: bool) -> None:
    """Sixteen periods after a disturbance of 1e-4: smaller, and the chain is put back; larger, and it was no orbit.

    The scale of displacements and velocities is the lane's own: others have used the workspace meanwhile.
    """
    block = seen(1.0 + 1e-4 * rate ** np.arange(period_end._TEST_ORBITS + 1))
    state = block.state
    state.testing[LANE], state.slowest[LANE], state.last_check[LANE, 0] = 1, 0.9, 1.0
    state.scale[:] = 1e-12, 1e12
    state.before[LANE, :, 1:-1] = 1.0
    assert period_end.decayed.py_func(state, LANE) == stable
    assert state.testing[LANE] == 0 and (state.slowest[LANE] > 0.0) == stable
    assert (state.y[1, LANE] == 1.0) == stable
    assert (state.last_check[LANE, 0] == 1.0) == stable, "what was no orbit has no period"
    assert state.scale == pytest.approx(1.0, rel=1e-2)


@pytest.mark.parametrize(("before", "kept"), [(1e-3, True), (1e-9, False)])
def test_a_jump_is_kept_only_if_changes_are_smaller_behind_it(before: float, kept: bool) -> None:
    """Else the chain goes back to where it was extrapolated from, and waits twice as long."""
    block = seen(1.0 + 1e-3 * 0.9 ** np.arange(60))
    state = block.state
    state.change_before_extrapolation[LANE], state.before[LANE, :, 1:-1], state.extrapolate_from[LANE], state.pause[LANE] = before, 0.25, 10_000, 16
    assert not period_end.check_coarse.py_func(state, LANE)
    assert state.change_before_extrapolation[LANE] == 0.0
    assert (state.y[1, LANE] != 0.25) == kept and (state.pause[LANE] == 16) == kept


def excess(power: float, r: float) -> float:
    """Simpson's rule over one step through the kink less ∫ s^p over its closed part r."""
    return (r**power + 4.0 * max(r - 0.5, 0.0) ** power) / 6.0 - r ** (power + 1.0) / (power + 1.0)


@pytest.mark.parametrize("r", [0.2, 0.5, 0.8, 1.0])
def test_what_a_lanes_step_across_an_event_gives_too_much(r: float) -> None:
    """Impulse and path of contact_correction.py by their definition, law by law."""
    half, speed, h, c = max(r - 0.5, 0.0), 0.7, 0.2, 0.3
    beside = ((r**1.5 + 4.0 * (r + 0.5) ** 1.5 + (r + 1.0) ** 1.5) / 6.0 - 0.4 * ((r + 1.0) ** 2.5 - r**2.5))
    assert contact_correction.momentum_error.py_func(r, r**1.5, half**1.5) == pytest.approx(excess(1.5, r) + beside, abs=1e-14)
    for law, scale, power in ((LinearDashpot(c), c, 1.0), (Tsuji(c), 0.8 * c, 1.25), (KuwabaraKono(c), 2.0 / 3.0 * c, 1.5)):
        found = contact_correction.displacement_error(law, r, half, speed, h)
        assert found == pytest.approx(scale * speed**power * h ** (power + 1.0) * excess(power, r), rel=1e-9, abs=1e-16)
