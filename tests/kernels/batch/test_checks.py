"""The periodicity checks of a batch, on states made by hand, and the corrections of its steps across events."""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core import scene
from granchain_core.execution.stop import Stop
from granchain_core.integrate.batch import Batch
from granchain_core.kernels.batch import checks, contact_correction, record
from granchain_core.kernels.batch_size import BATCH_SIZE
from granchain_core.kernels.effects.dissipation import KuwabaraKono, LinearDashpot, Tsuji

pytestmark = pytest.mark.quick

MEMBER, ROW = BATCH_SIZE - 2, 4


def seen(record: np.ndarray, before: float | None = None, **numbers: float) -> Batch:
    """Return a batch of two-bead chains in which all numbers of one member's beads were `record`, strobe by strobe.

    `before` is their value before an extrapolation; `numbers` are fields of `Search` or `Record` for that member.
    """
    batch = Batch(scene("sec2").evolve(N=2), Stop())
    batch.state.record.strobes[MEMBER, : len(record), :, 1:-1] = record[:, None, None]
    batch.state.record.strobe_count[MEMBER] = batch.state.record.periods[MEMBER] = len(record)
    batch.state.motion.y[[1, 2, ROW + 1, ROW + 2], MEMBER] = record[-1]
    if before is not None:
        batch.state.search.state_before[MEMBER, :, 1:-1] = before
    for name, value in numbers.items():
        group = batch.state.record if name in batch.state.record._fields else batch.state.search
        getattr(group, name)[MEMBER] = value
    return batch


def test_an_extrapolated_orbit_is_perturbed_before_it_is_accepted() -> None:
    """Repeated states count as periodic if the chain settled there; after an extrapolation, they are disturbed first.
    """
    batch = seen(np.ones(60))
    assert checks.check_coarse.py_func(batch.state, MEMBER)
    batch = seen(np.ones(60), slowest_contraction=0.9)
    assert not checks.check_coarse.py_func(batch.state, MEMBER)
    assert batch.state.search.tested_period[MEMBER] == 1
    moved = np.abs(batch.state.motion.y[[1, 2, ROW + 1, ROW + 2], MEMBER] - 1.0)
    assert moved == pytest.approx(checks._DISTURBANCE, rel=1e-9)


@pytest.mark.parametrize(("rate", "stable"), [
    (0.8, True), (1.2, False),
    ((checks._PART_LEFT - 0.01) ** (1 / checks._TEST_ORBITS), True),
    ((checks._PART_LEFT + 0.01) ** (1 / checks._TEST_ORBITS), False)])
def test_an_orbit_is_accepted_if_its_perturbation_decays(rate: float, stable: bool) -> None:
    """If a disturbance of 1e-4 has shrunk after sixteen periods, the chain is put back; if it has grown, it was on no
    stable orbit.

    Displacements and velocities are scaled for this member, although others have used the workspace in the meantime.
    """
    offsets = 1e-4 * rate ** np.arange(checks._TEST_ORBITS + 1)
    state = seen(1.0 + offsets, before=1.0, tested_period=1, slowest_contraction=0.9).state
    state.search.last_check[MEMBER, checks.CHECK_PERIOD] = 1.0
    state.work.scale[:] = 1e-12, 1e12
    assert checks.judge_perturbation.py_func(state, MEMBER) == stable
    assert state.search.tested_period[MEMBER] == 0 and (state.search.slowest_contraction[MEMBER] > 0.0) == stable
    assert (state.motion.y[1, MEMBER] == 1.0) == stable
    assert (state.search.last_check[MEMBER, checks.CHECK_PERIOD] == 1.0) == stable, "a state that was not on an orbit has no period"
    assert state.work.scale == pytest.approx(1.0, rel=1e-2)


@pytest.mark.parametrize(("before", "kept"), [(1e-3, True), (1e-9, False)])
def test_an_extrapolation_is_kept_only_if_the_change_after_it_is_smaller(before: float, kept: bool) -> None:
    """If it is not smaller, the chain returns to the state before the extrapolation and waits twice as long."""
    state = seen(1.0 + 1e-3 * 0.9 ** np.arange(60), before=0.25, change_before=before,
                 extrapolate_from=10_000, wait_after_undo=16).state
    assert not checks.check_coarse.py_func(state, MEMBER)
    assert state.search.change_before[MEMBER] == 0.0
    assert (state.motion.y[1, MEMBER] != 0.25) == kept and (state.search.wait_after_undo[MEMBER] == 16) == kept


@pytest.mark.parametrize(("before", "slowest"), [(1e-3, 0.9), (1e-9, 0.0)])
def test_after_an_undone_extrapolation_an_orbit_is_not_one_that_was_extrapolated_to(before: float, slowest: float) -> None:
    """Such an orbit is neither disturbed nor marked as followed: the contraction is the one before the extrapolation.
    """
    state = seen(1.0 + 1e-3 * 0.9 ** np.arange(60), change_before=before, extrapolate_from=10_000,
                 slowest_contraction=0.9, contraction_before=0.0).state
    checks.check_coarse.py_func(state, MEMBER)
    assert state.search.slowest_contraction[MEMBER] == slowest


def test_an_extrapolation_that_is_undone_leaves_no_trace_in_the_record() -> None:
    """The record ends with the state from which it was extrapolated; the periods run since then are not counted."""
    before = 1.0 + 1e-3 * 0.9 ** np.arange(60)
    batch = seen(before, before=before[-1], periods=59)
    state = batch.state
    limit = np.full((2, 4), 2.0)
    record.move_member.py_func(state, MEMBER, limit)
    assert len(batch.strobes(MEMBER)) == 1 and batch.strobes(MEMBER)[0] == pytest.approx(2.0)
    for _ in range(12):
        state.record.periods[MEMBER] += 1
        record.append_strobe.py_func(state.record, state.motion.y, MEMBER)
    assert len(batch.strobes(MEMBER)) == 13
    record.undo_extrapolation.py_func(state, MEMBER)
    assert batch.strobes(MEMBER)[:, 0, 0] == pytest.approx(before, abs=0.0)
    assert state.record.periods[MEMBER] == 59 and state.motion.y[1, MEMBER] == before[-1]


def test_a_full_record_drops_its_older_half_and_keeps_its_beginning_right() -> None:
    """Strobes before the last extrapolation are dropped first; of those since then, up to STROBES_KEPT are kept."""
    batch = seen(np.arange(1.0, 2.0 * record.STROBES_KEPT))  # one place is left
    state = batch.state
    record.move_member.py_func(state, MEMBER, np.full((2, 4), -1.0))
    for k in range(3):
        state.motion.y[1, MEMBER] = -2.0 - k
        record.append_strobe.py_func(state.record, state.motion.y, MEMBER)
    assert batch.strobes(MEMBER)[:, 0, 0].tolist() == [-1.0, -2.0, -3.0, -4.0]


def excess(power: float, r: float) -> float:
    """Return Simpson's rule over one step through the kink minus ∫ s^p over its closed part r."""
    return (r**power + 4.0 * max(r - 0.5, 0.0) ** power) / 6.0 - r ** (power + 1.0) / (power + 1.0)


@pytest.mark.parametrize("r", [1e-6, 0.05, 0.2, 0.35, 0.5, 0.65, 0.8, 0.95, 1.0])
def test_quadrature_errors_of_a_batch_step_across_an_event(r: float) -> None:
    """The errors in contact_correction.py agree with their definitions for every law; that of the next step to 3e-8."""
    half, speed, h, c = max(r - 0.5, 0.0), 0.7, 0.2, 0.3
    beside = ((r**1.5 + 4.0 * (r + 0.5) ** 1.5 + (r + 1.0) ** 1.5) / 6.0 - 0.4 * ((r + 1.0) ** 2.5 - r**2.5))
    assert contact_correction.impulse_error.py_func(r, r**1.5, half**1.5) == pytest.approx(excess(1.5, r) + beside, abs=3e-8)
    for law, scale, power in ((LinearDashpot(c), c, 1.0), (Tsuji(c), 0.8 * c, 1.25), (KuwabaraKono(c), 2.0 / 3.0 * c, 1.5)):
        found = contact_correction.displacement_error(law, r, half, speed * h, h)
        assert found == pytest.approx(scale * speed**power * h ** (power + 1.0) * excess(power, r), rel=1e-9, abs=1e-16)
