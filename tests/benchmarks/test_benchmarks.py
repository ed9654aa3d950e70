"""Untimed checks of the benchmarks: all rows solve the same problem."""

from __future__ import annotations

import os

import numpy as np
import pytest

from tests.benchmarks import compiled, machine, page, problem
from tests.benchmarks.peers import c_program, granchain, peer, scipy
from tests.benchmarks.trajectory import error_of

#: Frequencies at which the motion is periodic after 120 periods, so that rounding errors do not grow.
PERIODIC = np.array([340.0, 470.0, 1130.0, 1600.0])


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


def test_both_forms_are_one_motion() -> None:
    """The slope of u in the w form is the velocity, whose slope is the force of the (u, v) form between contact events.
    """
    beta, t, step, n = 0.3, 5.0, 1e-5, problem.BEADS
    w = np.random.default_rng(1).standard_normal(2 * n)
    before, now, after = (w + s * problem.slope_w_numpy(t, w, beta) for s in (-step, 0.0, step))
    v = [problem.slope_w_numpy(t + s, y, beta)[:n] for s, y in ((-step, before), (0.0, now), (step, after))]
    uv = problem.slope_uv_numpy(t, np.concatenate([now[:n], v[1]]), beta)
    # central difference: step² times a third derivative of size 10
    assert np.allclose((v[2] - v[0]) / (2.0 * step), uv[n:], rtol=0.0, atol=1e-7)


@pytest.mark.parametrize("form", problem.FORMS)
def test_scipy_and_granchain_find_the_same_motion(form: str, reference: np.ndarray) -> None:
    slope = {"uv": compiled.slope_uv, "w": compiled.slope_w}[form]
    solved = scipy.ode(slope, 1e-10)(problem.beta_of(problem.FREQUENCY), problem.trajectory_times())
    assert error_of(solved.states, reference) < 1e-6


@pytest.mark.parametrize("name", ["numbalsoda", "heyoka", "diffrax"])
def test_a_peer_finds_the_same_motion(name: str, reference: np.ndarray) -> None:
    if why := peer(name).missing():
        pytest.skip(why)
    case = next(c for c in peer(name).cases() if c.form == "w")
    assert case.prepare is not None
    assert error_of(case.prepare(1e-9)().states, reference) < 1e-6


@pytest.mark.skipif(bool(c_program.missing()), reason=c_program.missing())
class TestC:
    """The C program, where it can be compiled."""

    @pytest.mark.parametrize("case", [case for case in c_program.cases() if case.prepare], ids=lambda case: case.label)
    def test_the_program_in_c_follows_the_reference(self, case, reference: np.ndarray) -> None:
        # order 2 at contact changes: measured 7.5e-7 at 1920 steps a period
        assert error_of(case.prepare(1920)().states, reference) < 1e-6

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
