"""The picture of the trade: measured rows, a reference that two solvers agree on, and the lesson of naive methods."""

from __future__ import annotations

import json

import pytest

from app.cli import main
from granchain_core import scene
from granchain_core.accuracy import WorkPrecision, work_precision


@pytest.fixture(scope="module")
def measured() -> WorkPrecision:
    return work_precision(scene("sec2"))


def error(found: WorkPrecision, method: str, place: int) -> float:
    return [row for row in found.rows if row.method == method][place].error


def test_two_solvers_agree_on_the_reference(measured: WorkPrecision) -> None:
    # SciPy's DOP853 at 1e-12 without located events: its order breaks at the kinks, which leaves some 1e-10
    assert measured.agreement < 1e-8


def test_finer_settings_err_less(measured: WorkPrecision) -> None:
    for method in ("rk4", "rk4-split", "dop853", "scipy LSODA"):
        assert error(measured, method, -1) < error(measured, method, 0)
    assert error(measured, "dop853", -1) < 1e-9


def test_naive_methods_are_a_hundred_times_worse_at_the_same_step(measured: WorkPrecision) -> None:
    # PHYSICS, traps 4 and 13: the dashpot's jump takes RK4 in (u, v) to order one
    assert error(measured, "rk4-naive", 0) > 50.0 * error(measured, "rk4", 0)
    assert error(measured, "rk4-naive", -1) > 1e-4


def test_the_cheapest_way_is_accurate_enough(measured: WorkPrecision) -> None:
    for asked in (1e-3, 1e-6, 1e-8):
        best = measured.cheapest(asked)
        assert best is not None and best.error <= asked
    assert measured.cheapest(1e-15) is None


def test_progress_reaches_the_end_and_json_has_its_keys(capsys: pytest.CaptureFixture[str]) -> None:
    told: list[float] = []
    work_precision(scene("sec2").evolve(N=2, f=2000.0), progress=told.append)
    assert told == sorted(told) and told[-1] == pytest.approx(1.0)
    assert main(["accuracy", "sec2", "--set", "N=2", "--set", "f=2000", "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert set(data) == {"reference", "rows"} and set(data["reference"]) == {"method", "agreement"}
    assert all(set(row) == {"method", "setting", "error", "wall_s", "rhs"} for row in data["rows"])
