"""Work against precision: measured rows, a reference on which two solvers agree, and the lesson of naive methods."""

from __future__ import annotations

import itertools
import threading
import time
from collections.abc import Callable, Iterator
from importlib import import_module
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import scipy.integrate

import granchain_core.accuracy
from app.cli import main
from granchain_core import Cancelled, ComputationError, scene, settle
from granchain_core.accuracy import Row, WorkPrecision, cheapest, compared_methods, work_precision
from granchain_core.accuracy import work_precision as entry
from granchain_core.accuracy.compared_methods import measured_settings
from granchain_core.accuracy.limit import Limited
from granchain_core.accuracy.naive import NATURAL_STEPS, naive_comparison
from granchain_core.accuracy.scipy_methods import solve
from granchain_core.execution.stop import Stop
from granchain_core.integrate import METHODS, MethodSetting
from granchain_core.precompile.pieces import ACCURACY_KERNELS
from granchain_core.precompile.warm import compile_piece

SHORT = scene("sec2").evolve(N=2, f=2000.0)
#: The module, whose function has the same name.
MEASURING = import_module("granchain_core.accuracy.work_precision")


@pytest.fixture(scope="module", autouse=True)
def timed_briefly() -> Iterator[None]:
    """Run each setting once per round instead of up to nine times: no test here needs accurate times."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(MEASURING, "_MOST_RUNS", 1)
        yield


@pytest.fixture(scope="module")
def measured(timed_briefly: None) -> WorkPrecision:
    return work_precision(scene("sec2"))


def error(found: WorkPrecision, method: str, place: int) -> float:
    return [row for row in found.rows if row.method == method][place].error


def test_two_solvers_agree_on_the_reference(measured: WorkPrecision) -> None:
    # SciPy's DOP853 at 1e-14, restarted at contact events; 7e-12 was measured
    assert measured.agreement < 1e-10 and measured.disagreement == ""


def test_every_method_of_the_table_is_measured(measured: WorkPrecision) -> None:
    assert {row.method for row in measured.rows} == set(compared_methods()) >= set(METHODS)
    assert len(measured.rows) == len(list(measured_settings()))
    assert {row.method: row.failure for row in measured.rows if row.failure} == {}
    assert all(row.error > 0.0 and row.wall_s > 0.0 and row.rhs > 0 for row in measured.rows)


def test_finer_settings_err_less(measured: WorkPrecision) -> None:
    for method in ("rk4", "rk4-split", "dop853", "scipy LSODA"):
        assert error(measured, method, -1) < error(measured, method, 0)
    assert error(measured, "dop853", -1) < 1e-9


def test_naive_methods_are_a_hundred_times_worse_at_the_same_step(measured: WorkPrecision) -> None:
    # docs/method.md, w-variables: the dashpot's jump reduces RK4 in (u, v) to order one
    assert error(measured, "rk4-naive", 0) > 50.0 * error(measured, "rk4", 0)
    assert error(measured, "rk4-naive", -1) > 1e-4


def test_the_cheapest_way_is_accurate_enough(measured: WorkPrecision) -> None:
    for asked in (1e-3, 1e-6, 1e-8):
        best = measured.cheapest(asked)
        assert best is not None and best.error <= asked
        assert all(row.wall_s >= best.wall_s for row in measured.rows if not row.failure and row.error <= asked)
    assert measured.cheapest(1e-15) is None


def test_a_failed_row_is_never_the_cheapest() -> None:
    failed = Row("a", "", 0.0, 0.0, 0, failure="no")
    good = Row("b", "", 1e-7, 2.0, 10)
    assert cheapest([failed, good], 1e-6) is good
    assert cheapest([failed], 1e-6) is None


def test_progress_reaches_the_end_while_rows_are_added(monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[float] = []
    grown: list[int] = []
    monkeypatch.setattr(granchain_core.accuracy, "work_precision", lambda chosen, stop, progress: entry(
        chosen, stop, told.append, lambda found: grown.append(len(found.rows))))
    assert main(["accuracy", "sec2", "--set", "N=2", "--set", "f=2000", "--json"]) == 0
    assert told == sorted(told) and told[-1] == pytest.approx(1.0)
    assert grown == sorted(grown) and grown[-1] == len(list(measured_settings()))


@pytest.mark.long
def test_failed_rows_are_named_and_kept(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """One solver gives up and another is too slow once: their rows have sentences, and the others continue."""
    slow = iter([True])

    def solver(shown, name, tolerance, periods, samples, stop, located=False):
        if name == "LSODA":
            raise ComputationError("SciPy's LSODA lost the motion.", "not-finite")
        if name == "RK45" and next(slow, False):
            while not stop:
                time.sleep(0.005)
            raise Cancelled
        return solve(shown, name, tolerance, periods, samples, stop, located)

    monkeypatch.setattr(MEASURING, "solve", solver)
    monkeypatch.setattr(MEASURING, "_ROW_LIMIT", 5.0)  # the other rows take tenths of a second on an idle machine
    kept: list[WorkPrecision] = []

    def measuring(*words: Any) -> WorkPrecision:
        kept.append(entry(*words))
        return kept[-1]

    monkeypatch.setattr(granchain_core.accuracy, "work_precision", measuring)
    assert main(["accuracy", "sec2", "--set", "N=2", "--set", "f=2000"]) == 0
    assert "failed: SciPy's LSODA lost the motion." in capsys.readouterr().out
    (found,) = kept
    failures = {row.method: row.failure for row in found.rows if row.failure}
    assert "lost the motion" in failures["scipy LSODA"] and "stopped" in failures["scipy RK45"]
    assert "scipy DOP853" not in failures
    assert all(np.isinf(row.error) for row in found.rows if row.failure)


def cancelled_in_the_middle(work: Callable[[Stop], object], reached: threading.Event) -> None:
    """Run `work(stop)`, raise the flag as soon as `reached` is set, and check that it ends as cancelled."""
    stop = Stop()
    ended: list[BaseException] = []

    def target() -> None:
        try:
            work(stop)
        except Cancelled as cancelled:
            ended.append(cancelled)

    thread = threading.Thread(target=target)
    thread.start()
    assert reached.wait(60.0)
    stop.set()
    thread.join(60.0)
    assert not thread.is_alive() and len(ended) == 1


@pytest.mark.parametrize("solver", ["LSODA", "RK45", "DOP853"])
def test_a_solver_of_scipy_stops_between_two_steps(solver: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The run would take minutes; the flag is raised after five steps."""
    reached, steps = threading.Event(), itertools.count()
    step = getattr(scipy.integrate, solver).step

    def counted(self: Any) -> Any:
        if next(steps) == 5:
            reached.set()
        return step(self)

    monkeypatch.setattr(getattr(scipy.integrate, solver), "step", counted)
    cancelled_in_the_middle(lambda stop: solve(scene("rig"), solver, 1e-9, 1000, 16, stop), reached)


def test_a_measurement_is_cancelled_in_its_middle() -> None:
    """This happens while rows of SciPy's solvers are measured, which takes minutes for the rig."""
    compile_piece(scene("rig"), ACCURACY_KERNELS)
    reached = threading.Event()
    cancelled_in_the_middle(lambda stop: entry(scene("rig"), stop, lambda part: reached.set() if part > 0.0 else None), reached)


def test_a_limit_raises_its_flag_after_its_time_and_with_the_outer_flag() -> None:
    outer = Stop()
    with Limited(outer, 0.05) as limit:
        wait_for(limit.stop)
        assert not outer
    with Limited(outer, 3600.0) as limit:
        assert not limit.stop
        outer.set()
        wait_for(limit.stop)


def wait_for(stop: Stop) -> None:
    """Wait until a flag is raised."""
    end = time.monotonic() + 60.0
    while not stop:
        assert time.monotonic() < end, "the flag was not raised"
        time.sleep(0.001)


def test_the_naive_force_is_wrong_and_names_where_it_blows_up() -> None:
    """At natural steps, the rig's naive force is wrong by a large fraction, or the motion fails."""
    found = naive_comparison(scene("rig"), Stop())
    drawn = {(one.method, one.steps): one for one in found.lines}
    assert set(drawn) == {(m.name, n) for m in METHODS.values() if m.variables == "uv" for n in NATURAL_STEPS}
    assert "stopped being a finite number" in drawn["rk4-naive", 100].failure
    assert drawn["rk4-naive", 200].error > 0.1  # 0.49 was measured
    assert drawn["rk4-naive", 2000].error < drawn["rk4-naive", 500].error < drawn["rk4-naive", 200].error
    assert all(one.force.shape == found.force.shape for one in found.lines if not one.failure)


def test_the_error_of_the_naive_force_is_that_of_the_largest_pulse_which_is_shown() -> None:
    """At 1130 Hz, the wall is pressed hard once in three drive periods."""
    found, whole = naive_comparison(scene("sec2").evolve(f=1130.0), Stop()), settle(scene("sec2").evolve(f=1130.0)).run
    assert np.abs(found.force).max() == pytest.approx(whole.max_output_force, rel=0.1)  # ten periods from rest
    for one in found.lines:
        if not one.failure:
            told = np.abs(one.force - found.force).max() / one.error
            assert told >= np.abs(found.force).max() * (1.0 - 1e-12)


def test_the_second_reference_needs_neither_preload_nor_damping() -> None:
    """The overlaps at which SciPy's solver restarts include the preload; without damping, there is no G."""
    for shown in (SHORT.evolve(F0=1.0), SHORT.evolve(dissipation="none"), SHORT.evolve(tension="cut")):
        plain, _ = solve(shown, "DOP853", 1e-12, 2, 16)
        located, _ = solve(shown, "DOP853", 1e-13, 2, 16, located=True)
        assert np.abs(plain - located).max() < 1e-6 * np.abs(located).max()  # each is more accurate than 1e-8


def test_the_time_of_a_method_is_that_of_its_own_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    """A visitor who computes at the same time does not make a method appear slower."""
    times = iter((1.0, 1.25))
    monkeypatch.setattr(MEASURING.time, "thread_time", lambda: next(times))
    monkeypatch.setattr(MEASURING, "Engine", lambda *_, **__: SimpleNamespace(
        record=lambda rows: SimpleNamespace(displacement=np.zeros((rows, 1))), counts=SimpleNamespace(rhs=5)))
    assert MEASURING._ours(scene("sec2"), MethodSetting("rk4"), Stop()).seconds == 0.25
