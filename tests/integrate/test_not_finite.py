"""Compiled code that tests for finite numbers must not be compiled under the assumption that all are finite."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from granchain_core import ComputationError, scene
from granchain_core.integrate import Engine, MethodSetting
from granchain_core.integrate.scaling import scale_chain
from granchain_core.kernels.samples import first_not_finite


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("bead", [1, 3, 5])
@pytest.mark.parametrize("row", [0, 7])
def test_the_first_bead_that_is_not_finite(value: float, bead: int, row: int) -> None:
    """It is found in displacements and in w."""
    y = np.ones(14)
    assert first_not_finite(y, 7) == 0
    y[bead + row] = value
    assert first_not_finite(y, 7) == bead


@pytest.mark.parametrize("method", ["rk4", "dop853"])
def test_the_kernel_reports_a_contact_that_is_not_a_number(method: str) -> None:
    """The state is finite when the call begins; a failure within a step ends the run with a sentence."""
    engine = Engine(scene("sec2").evolve(N=3), MethodSetting(method, tolerance=1e-6), 4)
    engine.record(8)
    engine.scaled.slots.chain.stiffness[1] = np.nan
    with pytest.raises(ComputationError, match=r"bead [12] ") as caught:
        engine.record(4)
    assert caught.value.status == "not-finite"


def test_the_time_of_a_failure_inside_a_call_counts_from_the_start() -> None:
    """The drive fails in the twenty-first period, the first one of the current call."""
    engine = Engine(scene("sec2").evolve(N=3), MethodSetting("rk4"), 1)
    engine.periods(20)
    engine.stepper.drive[40] = np.nan
    with pytest.raises(ComputationError, match=r"\(20 drive periods\)") as caught:
        engine.periods(2)
    assert caught.value.time == pytest.approx(20.0 * engine.scaled.scene.period, rel=1e-12)


def test_an_overflow_in_velocities_is_found_by_the_equations_in_velocities() -> None:
    """The bead reported is the one in which a stage of the method overflows first; each call makes one step, so that
    its stages remain available.

    The equations in (u, w) overflow at another bead of this state.
    """
    chain = scene("sec2").evolve(f=340.0)
    setting = MethodSetting("rk4-naive")
    grid = setting.steps_per_period(scale_chain(chain), 8)
    engine = Engine(chain, setting, grid)
    engine.record(31 * grid // 8)
    slots = engine.scaled.slots
    stiff = slots._replace(dissipation=type(slots.dissipation)(1e305))  # type: ignore[call-arg, union-attr]
    engine.use(replace(engine.scaled, slots=stiff))
    with pytest.raises(ComputationError) as caught:
        for _ in range(grid):
            engine.record(1)
    stages = [first_not_finite(slope, engine.scaled.bodies) for slope in engine.stepper.work.k[1:]]
    assert caught.value.bead == next(bead for bead in stages if bead) == 4
