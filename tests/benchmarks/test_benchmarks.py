"""Untimed checks of the benchmarks: all rows solve the same problem."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
import pytest

from tests.benchmarks import compiled, curve, machine, page, problem, trajectory
from tests.benchmarks.case import Case, Peaks
from tests.benchmarks.peers import PEERS, c_program, granchain, peer
from tests.benchmarks.trajectory import error_of

#: Frequencies at which the motion is periodic after 120 periods, so that rounding errors do not grow.
PERIODIC = np.array([340.0, 470.0, 1130.0, 1600.0])
#: The settings of rows whose ladder is not one of tolerances, by its unit.
SETTINGS = {"steps a period": 1920, "refine": 12.0}


@pytest.fixture(scope="module")
def reference() -> np.ndarray:
    """The trajectory from granchain's dop853."""
    return granchain.reference().states


@pytest.mark.parametrize("form", problem.FORMS)
def test_the_compiled_equations_are_those_in_numpy(form: str) -> None:
    in_numpy = {"uv": problem.slope_uv_numpy, "w": problem.slope_w_numpy}[form]
    in_numba = {"uv": compiled.slope_uv, "w": compiled.slope_w}[form]
    rng = np.random.default_rng(0)
    for t in rng.uniform(0.0, 100.0, 20):
        y = rng.standard_normal(2 * problem.BEADS)
        # rounding of sums of a few numbers between 1 and 10
        assert np.allclose(in_numba(t, y, 0.3), in_numpy(t, y, 0.3), rtol=0.0, atol=1e-13)


def test_both_forms_of_the_equations_are_one_motion() -> None:
    """The slope of u in the w form is the velocity, whose slope is the force of the (u, v) form between contact events.
    """
    beta, t, step, n = 0.3, 5.0, 1e-5, problem.BEADS
    w = np.random.default_rng(1).standard_normal(2 * n)
    before, now, after = (w + s * problem.slope_w_numpy(t, w, beta) for s in (-step, 0.0, step))
    v = [problem.slope_w_numpy(t + s, y, beta)[:n] for s, y in ((-step, before), (0.0, now), (step, after))]
    uv = problem.slope_uv_numpy(t, np.concatenate([now[:n], v[1]]), beta)
    # central difference: step² times a third derivative of size 10
    assert np.allclose((v[2] - v[0]) / (2.0 * step), uv[n:], rtol=0.0, atol=1e-7)


def rows() -> list[Any]:
    """Return every row with a trajectory of every peer; a peer that cannot run here is skipped with its reason."""
    found = []
    for name in PEERS:
        if why := peer(name).missing():
            found.append(pytest.param(None, id=name, marks=pytest.mark.skip(reason=why)))
        else:
            found += [pytest.param(case, id=f"{name}-{case.label}-{case.form}") for case in peer(name).cases() if case.prepare]
    return found


@pytest.mark.parametrize("case", rows())
def test_every_row_of_every_peer_finds_the_same_motion(case: Case, reference: np.ndarray) -> None:
    assert case.prepare is not None
    # fixed steps have order 2 at contact changes: 7.5e-7 was measured for the C program; the force of the (u, v) form
    # jumps there: 7e-6 for SciPy's RK45
    assert error_of(case.prepare(SETTINGS.get(case.unit, 1e-9))().states, reference) < {"uv": 1e-4, "w": 1e-6}[case.form]


def test_a_wrong_reference_stops_the_benchmark(reference: np.ndarray) -> None:
    distances = trajectory.second_opinion(reference)
    assert "scipy DOP853 in w at 1e-13" in trajectory.confirmation(distances)
    wrong = {name: error_of(1.000001 * reference, reference) for name in distances}
    with pytest.raises(SystemExit, match="No other integrator confirms the reference to 1e-09: scipy"):
        trajectory.confirmation(wrong)
    assert trajectory.confirmation({"a": 2.5e-10}) == "a: 2.5e-10 (!: not confirmed to 1e-10)"
    assert trajectory.confirmation({"a": 2.5e-10, "b": 8e-13}) == "a: 2.5e-10; b: 8.0e-13"


def test_the_unit_of_the_curve_is_a_row_with_equal_answers() -> None:
    def answer(label: str, worst: float, seconds: float) -> curve.Answer:
        return curve.Answer(Case(label, "w"), 1.0, Peaks(np.zeros(1), seconds), 1, 1, worst, seconds, None, 1)

    answers = [answer("granchain, given up", 1e-3, 1.0), answer("granchain batches", 1e-5, 2.0), answer("C", 1e-5, 0.5)]
    assert curve.fastest_of_ours(answers) == 2.0
    assert np.isnan(curve.fastest_of_ours(answers[::2]))


@pytest.mark.skipif(bool(c_program.missing()), reason=c_program.missing())
class TestC:
    """The C program, where it can be compiled."""

    @pytest.mark.parametrize("shape", [c_program.SHAPES[0], (2, 3), (1, 12)])
    def test_the_peaks_are_those_of_the_lanes(self, shape: tuple[int, int]) -> None:
        """The C program is plain RK4 in w, of order 2 at contact events: at a twelfth of the step, its error is 1e-5.
        """
        lanes = granchain.batch_peaks(PERIODIC, 6).values
        ours = c_program.sweep_peaks(PERIODIC, c_program.STEP / 12.0, shape).values
        assert np.allclose(ours, lanes, rtol=1e-5, atol=0.0)


def test_peaks_are_equal_to_the_accurate_ones() -> None:
    accurate, periodic = granchain.reference_peaks(PERIODIC)
    assert periodic.all()
    # order 2 at contact changes; the curve calls answers equal at 1e-4
    assert np.allclose(granchain.batch_peaks(PERIODIC, 3).values, accurate, rtol=1e-4, atol=0.0)


def test_the_page_has_one_section_for_each_machine() -> None:
    """If a machine is measured again, its section is replaced where it is; the others stay unchanged."""
    one = page.replaced("# Benchmarks\n\nWords.\n", "## one, 2 cores", "first\n")
    both = page.replaced(one, "## other, 4 cores", "second")
    assert both == "# Benchmarks\n\nWords.\n\n## one, 2 cores\n\nfirst\n\n## other, 4 cores\n\nsecond\n"
    again = page.replaced(both, "## one, 2 cores", "third")
    assert again == both.replace("first", "third")
    assert page.replaced(again, "## one, 2 cores", "third") == again


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="the system does not pin processes")
def test_an_unpinned_process_has_the_cores_that_it_was_allowed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Under taskset or in a cpuset, these are fewer than the machine has."""
    now = {1, 3}
    monkeypatch.setattr(machine, "_allowed", set())
    monkeypatch.setattr(machine.os, "cpu_count", lambda: 8)
    monkeypatch.setattr(machine.os, "sched_getaffinity", lambda _: set(now))
    monkeypatch.setattr(machine.os, "sched_setaffinity", lambda _, cores: (now.clear(), now.update(cores)))
    assert machine.unpin() == 2 and now == {1, 3}
    assert machine.pin() == 3 and now == {3}
    assert machine.pin() == 3 and machine.unpin() == 2 and now == {1, 3}


def test_a_load_beside_other_work_is_marked(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(machine.os, "getloadavg", lambda: (0.4, 9.0, 9.0), raising=False)
    assert machine.load() == "0.4"
    monkeypatch.setattr(machine.os, "getloadavg", lambda: (1.3, 0.0, 0.0))
    assert machine.load().startswith("1.3 (!")
