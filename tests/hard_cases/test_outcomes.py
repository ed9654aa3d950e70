"""Every computation ends with one outcome; each is provoked here, and reported by the command line and in files."""

from __future__ import annotations

import ast
import json
from pathlib import Path

import h5py
import numpy as np
import pytest

import app
import granchain_core
from app.cli import main
from granchain_core import BadInput, Cancelled, ComputationError, State, orbit, run, scene
from granchain_core.errors import FAILURES, OverBudget
from granchain_core.execution.stop import Stop
from granchain_core.integrate import Engine, MethodSetting, method_for
from granchain_core.integrate.checkpoint import Checkpoint, checkpoint, resumed
from granchain_core.kernels.error_control import run as error_control
from granchain_core.kernels.error_control.run import SampleRange
from granchain_core.kernels.status import CHATTER, EVENTS_PER_CONTACT
from granchain_core.runs import to_accuracy
from granchain_core.runs.budget import estimate
from granchain_core.runs.to_accuracy import warnings
from granchain_core.scene.validity import ONSET_OF_YIELD, YIELD_STRESS, peak_pressures
from granchain_core.store import load, save


def test_a_finished_run_has_status_done_and_its_figures() -> None:
    result = run(scene("sec2"), periods=1, record=1, samples=8)
    assert result.status == "done"
    assert result.cost.steps > 0 and result.displacement_error is not None and result.energy_residual is not None


def test_a_stopped_run_is_cancelled() -> None:
    stop = Stop()
    stop.set()
    with pytest.raises(Cancelled):
        run(scene("sec2"), periods=5, record=1, samples=8, stop=stop)


def test_accuracy_not_reached_in_chaos() -> None:
    result = run(scene("sec2").evolve(dissipation="none", N=3, f=1000.0, accuracy=1e-5), periods=40, record=2, samples=4)
    assert result.status == "accuracy-not-reached"
    assert result.displacement_error > 1e-5


@pytest.mark.parametrize("knobs", [{"N": 10_000, "f": 0.1}, {"f": 0.1, "D": 3e4}, {"N": 10_000, "f": 10.0, "A0": 1e-4}])
def test_over_budget_is_refused_before_anything_is_computed_with_what_would_fit(knobs: dict[str, float],
                                                                                monkeypatch: pytest.MonkeyPatch) -> None:
    chosen = scene("sec2").evolve(**knobs)
    monkeypatch.setattr(to_accuracy, "Engine", None)  # nothing can be integrated
    with pytest.raises(OverBudget, match=r"would fit|needed") as caught:
        run(chosen, periods=10_000, record=1, samples=8)
    assert caught.value.estimate > caught.value.budget
    assert isinstance(caught.value, BadInput)


def test_the_offered_number_of_periods_fits_into_the_budget() -> None:
    chosen = scene("sec2").evolve(f=1.0)
    with pytest.raises(OverBudget) as caught:
        run(chosen, periods=99, record=1, samples=8, budget=2.0)
    periods = int(str(caught.value).split("budget is")[1].split(": ")[1].split(" period")[0])
    assert 1 <= periods < 100
    assert estimate(chosen, method_for(chosen.accuracy), periods, 8, 1).seconds <= 2.0


@pytest.mark.parametrize("accuracy", [1e-6, 1e-11])
def test_a_coarser_accuracy_is_offered_where_the_run_would_fit_with_it(accuracy: float) -> None:
    """The estimate is for the method chosen for 1e-4, a little finer than the coarsest. A method that is chosen by name
    takes the same steps at any accuracy.
    """
    chosen = scene("sec2").evolve(f=1.0, accuracy=accuracy)
    needed = estimate(chosen, method_for(1e-4), 100, 8, 1).seconds
    with pytest.raises(OverBudget, match=r"or an accuracy of 1e-4 would fit"):
        run(chosen, periods=99, record=1, samples=8, budget=1.001 * needed)
    for method, budget in ((None, 0.999 * needed), ("rk4-split", 1.001 * needed)):
        with pytest.raises(OverBudget) as caught:
            run(chosen.evolve(accuracy=1e-6), periods=99, record=1, samples=8, method=method, budget=budget)
        assert "accuracy" not in str(caught.value)


@pytest.mark.parametrize("knobs", [{}, {"f": 50.0}, {"f": 2.0}, {"N": 1}, {"N": 40}, {"N": 200, "f": 900.0}, {"F0": 5.0}, {"D": 2e4},
                                   {"accuracy": 1e-9}, {"accuracy": 1e-3}, {"kappa": 0.001, "wall": "rigid"}])
def test_the_steps_of_a_run_are_estimated_within_a_factor_of_two(knobs: dict[str, float]) -> None:
    chosen = scene("sec2").evolve(**knobs)
    periods = 1 if chosen.f < 10.0 else 10
    found = estimate(chosen, method_for(chosen.accuracy), periods + 1, 16, 1)
    result = run(chosen, periods=periods, record=1, samples=16)
    assert 0.5 < result.cost.steps / found.steps < 2.0


def test_a_finer_computation_that_does_not_fit_is_not_begun(monkeypatch: pytest.MonkeyPatch) -> None:
    """This run needs a third computation; if that is assumed to be very long, the second one is returned."""
    monkeypatch.setattr(to_accuracy, "_REFINED_COST_RATIO", 1e9)
    result = run(scene("sec2"), periods=20, record=1, samples=8)
    assert result.status == "over-budget"
    assert result.displacement_error > result.scene.accuracy


def test_not_finite_says_bead_time_and_step() -> None:
    chosen = scene("sec2")
    engine = Engine(chosen, MethodSetting("rk4"), 8)
    engine.record(16)
    engine.y[7] = np.inf
    with pytest.raises(ComputationError, match=r"bead 7 .* in step 0 ") as caught:
        engine.record(1)
    found = caught.value
    assert (found.status, found.bead, found.step) == ("not-finite", 7, 0)
    assert found.time == pytest.approx(2 * chosen.period, rel=1e-12)


def test_a_step_in_the_middle_of_a_long_call_is_found_again() -> None:
    engine = Engine(scene("sec2"), MethodSetting("rk4-split"), 1)
    engine.periods(3)
    step = engine.grid // 3
    engine.stepper.drive[2 * step + 2] = np.nan
    with pytest.raises(ComputationError) as caught:
        engine.periods(4)
    assert (caught.value.bead, caught.value.step) == (1, step)


def test_a_step_too_small_has_a_status_of_its_own() -> None:
    """During the run, a contact becomes so stiff that no step is small enough."""
    engine = Engine(scene("sec2"), MethodSetting("dop853", 1.0, 1e-6), 8)
    engine.record(1)
    engine.scaled.slots.chain.stiffness[:] = 1e30
    engine.stepper.work.next_step[0] = 1e-14
    with pytest.raises(ComputationError, match="became too small") as caught:
        engine.record(8)
    assert caught.value.status == "step-too-small"


def bouncing() -> Engine:
    """Start an undamped bead between a slow driver and the wall, with 4600 contact events in one drive period."""
    engine = Engine(scene("sec2").evolve(N=1, dissipation="none", f=5.0), MethodSetting("dop853", 1.0, 1e-4), 1)
    engine.start(State(np.zeros(1), np.array([0.5])))
    return engine


def test_thousands_of_touches_in_one_drive_period_are_followed() -> None:
    """Contacts are compliant, so a touch takes time, and many touches are not chatter."""
    engine = bouncing()
    engine.periods(1)
    assert engine.counts.events > 2 * EVENTS_PER_CONTACT


def test_contacts_that_open_and_close_while_no_time_passes_fail_with_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    """With an infinite window, the touches of a period count as if they took no time."""
    monkeypatch.setattr(error_control, "EVENT_WINDOW", np.inf)
    monkeypatch.setattr(error_control, "EVENTS_PER_CONTACT", 20)
    engine = bouncing()
    trajectory, samples = engine.stepper.trajectory(engine.y), engine.empty_samples(0)
    status, _ = error_control.run_error_controlled.py_func(engine.stepper.method, trajectory, SampleRange(0, 1, 1, 0), samples,
                                                           engine._output())
    assert status == CHATTER
    with pytest.raises(ComputationError, match="while hardly any time passes") as caught:
        engine.raise_for(status, 0.0)
    assert caught.value.status == "chatter"


def test_a_failed_newton_iteration_has_its_residuals() -> None:
    with pytest.raises(ComputationError, match=r"residuals were \d") as caught:
        orbit(scene("rig").evolve(f=140.0, k=0.0), period=1)
    assert caught.value.status == "no-convergence"


def test_every_failure_has_a_known_name() -> None:
    """Every status in the source is in FAILURES, and FAILURES has no others."""
    calls = [node for package in (granchain_core, app) for path in Path(package.__path__[0]).rglob("*.py")
             for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.Call)
             and getattr(node.func, "id", "") == "ComputationError"]
    statuses = [status for call in calls
                for status in (*call.args[1:2], *(word.value for word in call.keywords if word.arg == "status"))]
    assert len(statuses) == len(calls)
    assert {status.value for status in statuses if isinstance(status, ast.Constant)} == set(FAILURES)


def test_pressures_outside_the_models_validity_are_a_warning() -> None:
    gentle, strong = scene("sec2"), scene("sec2").evolve(A0=1e-5, F0=1e4)
    assert warnings(run(gentle, periods=0, record=1, samples=8)) == []
    found = warnings(run(strong, periods=0, record=1, samples=64))
    assert len(found) == 2
    assert "Hertz's law" in found[0] and "yield" in found[1]


@pytest.mark.parametrize("wall", ["bead", "same-material", "rigid"])
def test_peak_pressure_is_hertzs(wall: str) -> None:
    """p0 = (1/π)(6 F E*²/R*²)^{1/3}, in terms of the force; two spheres of section 2 yield at an overlap of 14 µm."""
    chosen = scene("sec2").evolve(wall=wall)
    overlaps = np.full(chosen.N + 1, 1e-6)
    force = chosen.contact_stiffness() * overlaps**1.5
    steel = chosen.bead(1)
    modulus = np.full(chosen.N + 1, steel.young / (2 * (1 - steel.poisson**2)))
    radius = np.full(chosen.N + 1, steel.radius / 2)
    if wall != "bead":
        radius[-1] = steel.radius
    if wall == "rigid":
        modulus[-1] *= 2.0
    expected = (6.0 * force * modulus**2 / radius**2) ** (1.0 / 3.0) / np.pi
    assert peak_pressures(chosen, overlaps) == pytest.approx(expected, rel=1e-12)
    limit = 1e-6 * (ONSET_OF_YIELD * YIELD_STRESS / expected[0]) ** 2
    assert 1.3e-5 < limit < 1.5e-5


def test_files_carry_status_start_and_warnings(tmp_path) -> None:  # type: ignore[no-untyped-def]
    result = run(scene("sec2").evolve(A0=1e-4, accuracy=1e-4), periods=0, record=1, samples=8)
    save(result, tmp_path / "run.h5")
    back = load(tmp_path / "run.h5")
    assert (back.status, back.start) == (result.status, "rest")
    with h5py.File(tmp_path / "run.h5") as file:
        assert json.loads(file.attrs["warnings"]) == warnings(result)


def test_the_command_line_refuses_runs_beyond_the_budget(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "sec2", "--set", "f=1", "--budget", "0.001", "--json"]) == 2
    told = capsys.readouterr()
    outcome = json.loads(told.out)
    assert outcome["status"] == "over-budget" and outcome["estimate_s"] > outcome["budget_s"] == 0.001
    assert outcome["message"] in told.err and "the budget is 0.001 s" in told.err


def test_the_command_line_reports_place_and_cost_of_a_failure(capsys: pytest.CaptureFixture[str],
                                                                      monkeypatch: pytest.MonkeyPatch) -> None:
    """If numbers fail, here immediately by an infinite stiffness times zero overlap, there is one object with the
    outcome.
    """
    begin = Engine.start

    def spoiled(engine: Engine, state: State) -> None:
        begin(engine, state)
        engine.scaled.slots.chain.stiffness[3] = np.inf

    monkeypatch.setattr(Engine, "start", spoiled)
    assert main(["run", "sec2", "--json"]) == 3
    told = capsys.readouterr()
    outcome = json.loads(told.out)
    assert outcome["status"] == "not-finite" and outcome["bead"] == 3 and outcome["time"] == 0.0
    assert outcome["cost"]["rhs"] > 0
    assert told.err.strip() == outcome["message"]


def test_checkpoints_belong_to_their_scene_and_are_refused_inside_a_period() -> None:
    engine = Engine(scene("sec2"), MethodSetting("dop853", 1.0, 1e-6), 8)
    engine.record(4)
    with pytest.raises(BadInput, match="whole drive periods only"):
        checkpoint(engine)
    engine.record(4)
    kept = checkpoint(engine)
    with pytest.raises(BadInput, match="belongs to scene"):
        resumed(scene("rig"), kept)
    with pytest.raises(BadInput, match="not a checkpoint"):
        Checkpoint.from_bytes(b"nonsense")
