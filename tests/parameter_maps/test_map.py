"""Parameter maps: cells agree with points of curves, and no finished cell is lost or computed twice."""

from __future__ import annotations

import json
import os
import pickle
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import xarray

from app.cli import main
from granchain_core import BadInput, resonance_curve, scene, settle
from granchain_core.execution.checkpoints import folder_of
from granchain_core.execution.stop import Stop
from granchain_core.parameter_maps import Axis, Grid, ParameterMap, parameter_map
from granchain_core.parameter_maps.blocks import Blocks
from granchain_core.parameter_maps.cells import CELL_REGIMES, empty_cells
from granchain_core.parameter_maps.scheduled import describe, work_on
from granchain_core.scheduler import dealt
from granchain_core.store.parameter_maps import load_parameter_map, save_parameter_map

ROOT = Path(__file__).resolve().parents[2]
FREQUENCIES = np.linspace(300.0, 1700.0, 8)
AMPLITUDES = np.geomspace(2e-7, 2e-6, 4)


@pytest.fixture(scope="module")
def found() -> ParameterMap:
    return parameter_map(scene("sec2"), ("f", FREQUENCIES), ("A0", AMPLITUDES))


def test_every_cell_is_the_curves_point_at_its_amplitude(found: ParameterMap) -> None:
    assert found.complete
    for i, amplitude in enumerate(AMPLITUDES):
        curve = resonance_curve(scene("sec2").evolve(A0=amplitude), FREQUENCIES)
        for j, point in enumerate(curve.points):
            number = i * len(FREQUENCIES) + j
            regime = found.regime(number)
            assert regime is not None
            assert (regime.name, regime.period) == (point.regime.name, point.regime.period)
            cell = found.cells[number]
            # the same numbers up to rounding in the batch, far below the stated error
            assert cell["max_output_force"] == pytest.approx(point.max_output_force, rel=1e-7)
            assert np.isnan(cell["error_estimate"]) == (point.force_errors.output is None)


def test_a_scaled_chain_has_the_same_cells(found: ParameterMap) -> None:
    # along a tilted line of the map
    s = AMPLITUDES[1] / AMPLITUDES[0]
    other = parameter_map(scene("sec2").scaled(s), ("f", s**0.25 * FREQUENCIES), ("A0", s * AMPLITUDES))
    assert (other.cells["regime"] == found.cells["regime"]).mean() > 0.9  # chaos from rest amplifies rounding
    both = (other.cells["regime"] == 0) & (found.cells["regime"] == 0) & (other.cells["period"] == found.cells["period"])
    assert both.sum() >= 20
    ratio = other.cells["max_output_force"][both] / found.cells["max_output_force"][both]
    assert np.abs(ratio / s**1.5 - 1.0).max() < 2.0 * found.cells["error_estimate"][both].max() + 1e-6


def test_an_axis_that_reaches_zero_switches_its_effect_off_there() -> None:
    found = parameter_map(scene("sec2"), ("k", [0.0, 1e4]), ("D", [0.0, 100.0]))
    assert found.complete
    for number, (k, D) in enumerate([(0.0, 0.0), (1e4, 0.0), (0.0, 100.0), (1e4, 100.0)]):
        at = found.grid.cell(number)
        assert (at.k, at.D) == (k, D)
    single = resonance_curve(scene("sec2").evolve(k=1e4), [340.0]).points[0]
    assert found.cells["max_output_force"][3] == pytest.approx(single.max_output_force, rel=1e-7)


def test_scenes_that_batches_cannot_run_are_settled_one_by_one() -> None:
    found = parameter_map(scene("sec2").evolve(tension="cut"), ("f", [340.0]), ("A0", [5e-7, 6e-7]))
    assert [CELL_REGIMES[code] for code in found.cells["regime"]] == ["periodic", "periodic"]
    for number, cell in enumerate(found.cells):
        assert cell["max_output_force"] == pytest.approx(settle(found.grid.cell(number)).run.max_output_force,
                                                         rel=2.0 * cell["error_estimate"])


def test_the_first_cells_are_spread_over_the_whole_map() -> None:
    grid = Grid(scene("sec2"), Axis.of("f", np.linspace(30, 3000, 33)), Axis.of("A0", np.linspace(1e-7, 1e-6, 17)))
    order = grid.coarse_first()
    assert sorted(order) == list(range(grid.size))
    first = order[:15]
    assert {(n // 33, n % 33) for n in first} == {(i, j) for i in (0, 8, 16) for j in (0, 8, 16, 24, 32)}
    assert (np.diff(grid.spacing()[order]) <= 0).all()


def test_a_stopped_map_says_how_many_cells_are_missing() -> None:
    count, stop = [0], Stop()

    def look(_: ParameterMap, __: float) -> None:
        count[0] += 1
        if count[0] >= 10:
            stop.set()

    found = parameter_map(scene("sec2"), ("f", np.linspace(300, 2000, 20)), ("A0", AMPLITUDES), stop=stop,
                    progress=look)
    assert not found.complete and (found.cells["regime"] >= 0).sum() == count[0] >= 10
    missing = found.cells["regime"] < 0
    assert np.isnan(found.cells["max_output_force"][missing]).all()


@pytest.mark.parametrize(("x", "y", "words"), [
    (("f", [300.0]), ("f", [400.0]), "two different knobs"),
    (("N", [3.0]), ("f", [400.0]), "Unknown knob for an axis 'N'"),
    (("k", [3.0]), ("kappa", [0.1]), "k and kappa are the same quantity"),
    (("f", [300.0, 200.0]), ("A0", [1e-7]), "must ascend"),
    (("f", [1e9]), ("A0", [1e-7]), "nearest valid value is 1e\\+06"),
    (("f", []), ("A0", [1e-7]), "has no values"),
    (("wall", ["rigid"]), ("A0", [1e-7]), "takes numbers, not words"),
    (("f", [0.1]), ("A0", [1e-4]), "nearest valid frequency"),
])
def test_a_wrong_grid_is_one_clear_sentence(x: tuple, y: tuple, words: str) -> None:
    with pytest.raises(BadInput, match=words):
        parameter_map(scene("sec2").evolve(D=1e5), x, y)


# Files


def test_a_map_is_read_back_and_labelled_in_xarray(found: ParameterMap, tmp_path: Path) -> None:
    file = save_parameter_map(found, tmp_path / "map.h5")
    again = load_parameter_map(file)
    assert again.cells.tobytes() == found.cells.tobytes() and again.grid.digest == found.grid.digest
    with xarray.open_dataset(file, engine="h5netcdf", group="map") as data:
        assert data.max_output_force.dims == ("A0", "f") and data.max_output_force.attrs["units"] == "N"
        assert data.f.attrs == {"units": "Hz", "long_name": "drive frequency"} and data.A0.attrs["units"] == "m"
        assert data.regime.attrs["flag_meanings"].split()[1:] == list(CELL_REGIMES)
        at = data.sel(f=FREQUENCIES[2], A0=AMPLITUDES[1])
        assert float(at.max_output_force) == found.column("max_output_force")[1, 2]


def words(out: Path, *more: str) -> list[str]:
    """Return the command line of a map of 20 × 20 cells: one or two seconds of work, and more than two blocks."""
    return ["map", "sec2", "--x", "f=200:3000:20", "--y", "A0=2e-7:1e-5:20:log", "--out", str(out), "--json", *more]


@pytest.mark.long
def test_a_killed_map_resumes_and_computes_nothing_again(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "map.h5"
    running = subprocess.Popen([sys.executable, "-m", "app.cli", *words(out)], cwd=ROOT, stdout=subprocess.DEVNULL,
                               stderr=subprocess.DEVNULL)
    end = time.monotonic() + 60
    while len(list(folder_of(out).glob("*.block"))) < 2 and time.monotonic() < end:
        time.sleep(0.01)
    running.send_signal(signal.SIGKILL)
    running.wait()
    assert not out.exists()
    grid = Grid(scene("sec2"), Axis.of("f", np.linspace(200, 3000, 20)), Axis.of("A0", np.geomspace(2e-7, 1e-5, 20)))
    before = Blocks(grid, out).cells()
    there = int((before["regime"] >= 0).sum())
    assert 2 <= there < 400

    assert main(words(out)) == 2  # not without --resume
    assert "continue with --resume" in capsys.readouterr().err
    assert main([*words(out, "--resume"), "--set", "D=90"]) == 2
    assert "holds another map" in capsys.readouterr().err

    assert main(words(out, "--resume")) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed["cells"] == 400 and printed["computed"] == 400 - there
    assert not folder_of(out).exists()
    found = load_parameter_map(out)
    kept = before["regime"] >= 0
    assert found.complete and found.cells[kept].tobytes() == before[kept].tobytes()

    assert main(words(out, "--resume")) == 0  # again: the map is finished
    assert json.loads(capsys.readouterr().out)["computed"] == 0
    assert main([*words(out, "--resume"), "--set", "D=90"]) == 2
    assert "finished map that was computed with other options" in capsys.readouterr().err


def test_a_damaged_block_is_computed_again(tmp_path: Path) -> None:
    grid = Grid(scene("sec2"), Axis.of("f", [340.0, 615.0]), Axis.of("A0", [5e-7]))
    blocks = Blocks.open(grid, tmp_path / "map.h5", resume=False)
    rows = empty_cells(grid)
    rows["regime"] = 0
    for one in rows:
        blocks.add(np.array([one]))
        blocks.folder.write()
    first, second = sorted(blocks.folder.path.glob("*.block"))
    content = bytearray(first.read_bytes())
    content[-1] ^= 1
    first.write_bytes(content)
    second.write_bytes(second.read_bytes()[:40])
    again = Blocks.open(grid, tmp_path / "map.h5", resume=True).cells()
    assert (again["regime"] == -1).all()
    assert not [name for name in os.listdir(blocks.folder.path) if name.endswith(".tmp")]


@pytest.mark.parametrize(("option", "value", "said"), [
    ("--x", "f=30:3000", "must have the form KNOB=a:b:n"),
    ("--x", "f=30:3000:x", "must be a whole number"),
    ("--x", "f=a:3000:5", "'a' is not a number"),
    ("--x", "f=30:3000:1", "there are at least two points"),
    ("--y", "D=0:100:5:log", "needs both ends above 0"),
    ("--y", "D=0:100:99999999", "nearest valid value is 4000000"),
    ("--scheduler", "tcp://127.0.0.1:9", "scheduler"),
])
def test_wrong_words_are_one_clear_sentence(option: str, value: str, said: str, tmp_path: Path,
                                            capsys: pytest.CaptureFixture[str]) -> None:
    arguments = {"--x": "f=300:400:2", "--y": "A0=5e-7:6e-7:2", "--out": str(tmp_path / "a.h5"), option: value}
    assert main(["map", "sec2", *(word for pair in arguments.items() for word in pair)]) == 2
    err = capsys.readouterr().err
    assert said in err and len(err.strip().splitlines()) == 1
    assert list(tmp_path.iterdir()) == []


# Schedulers


def test_without_distributed_a_scheduler_is_refused_in_one_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
                                                                    capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    assert main(["map", "sec2", "--x", "f=300:400:2", "--y", "A0=5e-7:6e-7:2", "--out", str(tmp_path / "a.h5"),
                 "--scheduler", "tcp://host:8786"]) == 2
    assert "--scheduler needs the package distributed" in capsys.readouterr().err


def test_a_block_can_be_sent_to_another_process_and_its_cells_back(found: ParameterMap) -> None:
    sent = pickle.loads(pickle.dumps((work_on, describe(found.grid), [3, 17])))
    rows = pickle.loads(pickle.dumps(sent[0](*sent[1:])))
    assert sorted(rows["number"]) == [3, 17]
    for row in rows:
        cell = found.cells[row["number"]]
        assert row["regime"] == cell["regime"]
        assert row["max_output_force"] == pytest.approx(cell["max_output_force"], rel=1e-7)


def test_blocks_hold_every_cell_once() -> None:
    blocks = dealt(list(range(1000)), 256)
    assert sorted(n for block in blocks for n in block) == list(range(1000)) and max(map(len, blocks)) <= 256
    assert dealt([], 256) == []


def test_an_axis_may_pass_through_equal_beads() -> None:
    """Equal beads use different kernels from unequal ones, but each cell agrees with that of its own chain."""
    chain = scene("sec2").evolve(N=3, f=1500.0)
    found = parameter_map(chain, ("dimer", [0.5, 1.0, 2.0]), ("D", [100.0])).column("max_output_force")[0]
    for ratio, force in zip((0.5, 1.0, 2.0), found, strict=True):
        assert force == resonance_curve(chain.evolve(dimer=ratio), [1500.0]).points[0].max_output_force
    assert len(set(found)) == 3
