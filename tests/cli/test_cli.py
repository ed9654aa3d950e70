"""The command line: numbers in its JSON, exit statuses, and a clear sentence for every wrong input."""

from __future__ import annotations

import json
import math
import re
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from app.cli import main
from granchain_core import Curve, State, __version__, bifurcation_curves, orbit, run, save, scene
from granchain_core.steady.curve.request import CurveRequest
from granchain_core.store.parameter_maps import load_parameter_map

SHORT = ["--periods", "2", "--record", "1", "--samples", "8"]


def test_run_prints_one_json_object_and_explains_on_stderr(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "sec2", "--periods", "60", "--record", "2", "--json", "--explain"]) == 0
    out, err = capsys.readouterr()
    data = json.loads(out)
    assert data["regime"] == "periodic" and data["period"] == 1 and data["status"] == "done"
    assert data["evidence"]["distance"] <= 1e-6 and data["evidence"]["window_ratios"] is None
    assert data["max_output_force_elastic"] == pytest.approx(0.62, rel=0.01)  # docs/lecture.md, `fig3a`
    assert "absent, with no code and no array: tension cut, foundation, preload" in err


@pytest.mark.parametrize(("words", "said"), [
    (["curve", "sec2", "--from", "2000", "--to", "2010", "--points", "1"], "points that a batch computes"),
    (["map", "sec2", "--x", "f=2000:2010:2", "--y", "A0=5e-7:6e-7:2"], "cells that a batch computes")])
def test_an_accuracy_that_a_batch_does_not_use_is_reported(words: list[str], said: str, tmp_path: Path,
                                                       capsys: pytest.CaptureFixture[str]) -> None:
    for changed in ([], ["accuracy=1e-8"]):
        out = tmp_path / f"a{len(changed)}.h5"
        assert main([*words, "--set", "N=2", *(word for one in changed for word in ("--set", one)), "--out", str(out)]) == 0
        assert (f"accuracy = 1e-08 does not change {said}" in capsys.readouterr().err) == bool(changed)


def test_a_map_has_its_bifurcation_curves(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """They are in the JSON, the text and the picture, but only with the option; with a tension cut, they are refused.
    """
    words = ["map", "sec2", "--set", "N=3", "--x", "f=1860:1900:2", "--y", "A0=4.5e-7:5e-7:2", "--out", str(tmp_path / "map.h5")]
    picture = tmp_path / "map.html"
    assert main([*words, "--json"]) == 0
    plain = json.loads(capsys.readouterr().out)
    assert main([*words, "--json", "--bifurcations", "--resume", "--picture", str(picture)]) == 0
    told = json.loads(capsys.readouterr().out)
    assert set(told) - set(plain) == {"bifurcations"} and told["computed"] == 0
    curve, = told["bifurcations"]
    found = bifurcation_curves(load_parameter_map(tmp_path / "map.h5"))[0]
    assert (curve["kind"], curve["period"], curve["x"]) == ("period_doubling", 1, [point.x for point in found.points])
    assert [complex(*mu) for mu in curve["multiplier"]] == [point.multiplier for point in found.points]
    assert "bifurcation curve" in picture.read_text(encoding="utf-8")
    assert main([*words, "--bifurcations", "--resume"]) == 0
    assert found.sentence("f", "A0") in capsys.readouterr().out.splitlines()
    assert main([*words, "--bifurcations", "--set", "tension=cut"]) == 2
    assert "tension = cut" in capsys.readouterr().err


def test_curve_prints_the_content_of_its_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "curve.h5"
    words = ["curve", "sec2", "--from", "300", "--to", "400", "--points", "3", "--json", "--out", str(file)]
    assert main(words) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["frequency"] == [300.0, 350.0, 400.0]
    with h5py.File(file) as written:
        assert list(written["curve/max_output_force"][()]) == data["max_output_force"]


def test_a_naive_method_has_no_energy_account(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "sec2", "--method", "rk4-naive", *SHORT]) == 0
    assert "; no energy account; rk4-naive, " in capsys.readouterr().out


def test_run_writes_r_times_s_plus_one_rows(tmp_path: Path) -> None:
    file = tmp_path / "a.h5"
    assert main(["run", "sec2", "--periods", "0", "--record", "3", "--samples", "8", "--out", str(file)]) == 0
    with h5py.File(file) as written:
        assert written["run/displacement"].shape == (25, 11) and written["run/force"].shape == (25, 12)
        assert written["run/time"][0] == 0.0
        assert written["run/time"][-1] == pytest.approx(3 / 340.0, rel=1e-15)


def test_scenes_lists_every_preset_of_the_contract(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["scenes", "--json"]) == 0
    names = {one["name"] for one in json.loads(capsys.readouterr().out)["scenes"]}
    assert {"sec2", "fig3a", "fig3b", "rig", "fig12-60", "fig12-90", "fig12-100", "fig11-free", "fig11-founded"} <= names


def test_orbit_prints_its_multipliers(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["orbit", "fig11-free", "--observer", "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["stable"] and not data["observer_stable"]
    moduli = [abs(complex(*mu)) for mu in data["multipliers"]]
    assert moduli == sorted(moduli, reverse=True) and len(moduli) == 22


@pytest.mark.parametrize(("words", "sentence"), [
    (["rnu"], "nearest is 'run'"),
    (["run", "sec22"], "nearest is 'sec2'"),
    (["run", "sec2", "--set", "freq=3"], "Unknown knob 'freq'"),
    (["run", "sec2", "--set", "f=nan"], "from 0.1 to 1e+06 Hz, not 'nan'"),
    (["run", "sec2", "--set", "f=inf"], "from 0.1 to 1e+06 Hz"),
    (["run", "sec2", "--set", "f=ten"], "not 'ten'"),
    (["run", "sec2", "--set", "A0=1"], "nearest valid value is 0.0001"),
    (["run", "sec2", "--set", "D=-1"], "nearest valid value is 0"),
    (["run", "sec2", "--set", "N=2.5"], "whole number"),
    (["run", "sec2", "--set", "N=0"], "nearest valid value is 1"),
    (["run", "sec2", "--set", "wall=wood"], "bead, same-material, rigid, or a number"),
    (["run", "sec2", "--set", "dissipation=linaer"], "nearest is 'linear'"),
    (["run", "sec2", "--set", "tension=3"], "nearest is"),
    (["run", "sec2", "--set", "k=1", "--set", "kappa=0.1"], "give one of them"),
    (["run", "sec2", "--set", "f=3", "--set", "f=4"], "set twice"),
    (["run", "sec2", "--set", "f"], "NAME=VALUE"),
    (["run", "sec2", "--accuracy", "2"], "nearest valid value is 0.1"),
    (["run", "sec2", "--method", "euler"], "Unknown method 'euler'"),
    (["run", "sec2", "--periods", "-1"], "nearest valid value is 0"),
    (["run", "sec2", "--record", "0"], "nearest valid value is 1"),
    (["run", "sec2", "--samples", "x"], "'x' is not a whole number"),
    (["run", "sec2", *SHORT, "--out", "/no/such/folder/a.h5"], "Cannot write /no/such/folder/a.h5"),
    (["run"], "SCENE"),
    (["run", "sec2", "--colour"], "unrecognized arguments"),
    (["run", "sec2", "--perods", "5"],
     "granchain run: unrecognized arguments: --perods 5; the nearest option is --periods; see 'granchain run --help'."),
    (["scenes", "extra"], "granchain scenes: unrecognized arguments: extra; see 'granchain scenes --help'."),
    ([], "granchain needs a command, for example 'granchain serve'"),
    (["--hlep"], "Unknown option '--hlep'; the nearest is '--help'"),
    (["virtual", "sec2", "--seed", "-3"], "seed = -3 is outside 0 to 9223372036854775807; the nearest valid value is 0."),
    (["virtual", "sec2", "--kind", "curve", "--from", "2000", "--to", "1900", "--points", "1", "--seed", "-1"],
     "--from 2000 is above --to 1900; exchange them."),
    (["virtual", "sec2", "--kind", "curve", "--from", "1900", "--to", "2000", "--points", "0"], "nearest valid value is 1"),
    (["virtual", "sec2", "--periods", "0", "--out", "/no/such/folder/a.csv"], "Cannot write /no/such/folder/a.csv"),
    (["observe", "sec2", "--input", "/dev/null"], "null: The file is empty"),
    (["curve", "sec2", "--from", "500", "--to", "400", "--points", "3"], "exchange them"),
    (["curve", "sec2", "--from", "500", "--to", "600", "--points", "0"], "nearest valid value is 1"),
    (["curve", "sec2", "--from", "500", "--to", "600", "--points", "3", "--start", "left"], "Unknown start 'left'"),
    (["curve", "sec2", "--from", "0", "--to", "600", "--points", "3"], "nearest valid value is 0.1"),
    (["orbit", "sec2", "--period", "0"], "nearest valid value is 1"),
    (["serve", "--port", "70000"], "outside 0 to 65535"),
])
def test_wrong_input_gets_one_sentence_and_status_2(words: list[str], sentence: str,
                                                    capsys: pytest.CaptureFixture[str]) -> None:
    assert main(words) == 2
    out, err = capsys.readouterr()
    assert out == "" and sentence in err
    assert len(err.strip().splitlines()) == 1 and "Traceback" not in err


def test_numbers_that_fail_exit_with_3(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["orbit", "rig", "--set", "f=140", "--set", "k=0"]) == 3
    assert "residuals were" in capsys.readouterr().err


def test_help_is_no_error(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as left:
        main(["--help"])
    assert left.value.code == 0 and "serve" in capsys.readouterr().out


#: Runs the command line, and announces on stderr that the kernel is about to be called.
_ANNOUNCED = """
import sys
from app.cli import main
from granchain_core.integrate import Engine
periods = Engine.periods
def announced(engine, count, **names):
    if count > 0:
        print("running", file=sys.stderr, flush=True)
    return periods(engine, count, **names)
Engine.periods = announced
sys.exit(main(sys.argv[1:]))
"""


def test_an_interrupt_ends_a_long_run_with_130() -> None:
    words = [sys.executable, "-c", _ANNOUNCED, "run", "rig", "--periods", "1000000", "--record", "1"]
    process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                               cwd=Path(__file__).parents[2], preexec_fn=_interruptible)
    try:
        assert process.stderr is not None and process.stderr.readline() == "running\n"
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=60)
    finally:
        process.kill()
    assert process.returncode == 130 and out == "" and "Traceback" not in err


def _interruptible() -> None:
    """Make a child process react to interrupts, which the background jobs of a shell and their children ignore."""
    signal.signal(signal.SIGINT, signal.default_int_handler)


def test_a_failed_point_says_so_in_the_json_and_a_curve_of_them_in_the_exit_status(
        monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["curve", "sec2", "--set", "N=2", "--from", "1900", "--to", "2000", "--points", "2", "--json"]
    computed = CurveRequest.compute

    def failing(first: int) -> None:
        def compute(asked: CurveRequest, **how: Any) -> Curve:
            found = computed(asked)
            found.points[first:] = [replace(point, failure="Bead 2 overflowed.", status="not-finite", max_output_force=math.nan)
                                    for point in found.points[first:]]
            return found
        monkeypatch.setattr(CurveRequest, "compute", compute)

    failing(1)
    assert main(words) == 0
    said = json.loads(capsys.readouterr().out)
    assert said["status"] == ["done", "not-finite"] and said["failure"] == [None, "Bead 2 overflowed."]
    assert said["max_output_force"][1] is None
    failing(0)
    assert main(words) == 3
    assert json.loads(capsys.readouterr().out)["status"] == ["not-finite", "not-finite"]


def test_a_curve_is_compared_with_a_measured_one(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The measurement is half a newton below the computed elastic forces, so the difference is +0.5 N."""
    words = ["curve", "sec2", "--set", "N=2", "--from", "1900", "--to", "2000", "--points", "2"]
    assert main([*words, "--json"]) == 0
    forces = json.loads(capsys.readouterr().out)["max_output_force_elastic"]
    data = tmp_path / "mine.csv"
    data.write_text(f"frequency_Hz,max_output_force_N\n1900,{forces[0] - 0.5}\n2000,{forces[1] - 0.5}\n", encoding="utf-8")
    assert main([*words, "--data", str(data), "--elastic", "--json"]) == 0
    misfit = json.loads(capsys.readouterr().out)["misfit"]
    assert misfit["compared"] == 2 and misfit["rms"] == pytest.approx(0.5) and misfit["mean"] == pytest.approx(0.5)
    assert main([*words, "--data", str(data), "--elastic"]) == 0
    assert "Elastic part of the output force. Model − measured at 2 of 2 frequencies: rms 0.5 N" in capsys.readouterr().out


def test_an_undriven_chain_is_distinguished_from_an_unsettled_one(capsys: pytest.CaptureFixture[str]) -> None:
    for words, driven in (["impact", "--set", "N=3"], False), (["sec2", "--set", "N=2", "--set", "f=2000"], True):
        assert main(["run", *words, *SHORT, "--json"]) == 0
        said = json.loads(capsys.readouterr().out)
        assert (said["regime"], said["driven"]) == ("unsettled", driven)


def test_forces_before_a_motion_has_settled_are_those_of_the_record(capsys: pytest.CaptureFixture[str]) -> None:
    for words, transient in (["impact", "--set", "N=3"], False), (["sec2", "--set", "N=2", "--set", "f=2000"], True):
        assert main(["run", *words, *SHORT]) == 0
        line = capsys.readouterr().out.splitlines()[0]
        assert line.endswith("; forces and errors are those of the recorded periods") == transient


def test_words_say_whether_the_accuracy_was_reached_and_count_one_iteration(capsys: pytest.CaptureFixture[str]) -> None:
    chain = ["sec2", "--set", "N=2", "--set", "f=2000"]
    assert main(["run", *chain, "--periods", "60", "--record", "1", "--samples", "8"]) == 0
    assert capsys.readouterr().out.splitlines()[0].endswith("; accuracy reached")
    assert main(["orbit", *chain]) == 0
    count = re.search(r"after (\d+) Newton (iterations?)$", capsys.readouterr().out.splitlines()[0])
    assert count is not None and count[2] == ("iteration" if count[1] == "1" else "iterations")


def test_an_orbit_starts_in_the_last_state_of_a_run_at_its_phase(tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
                                                                 capsys: pytest.CaptureFixture[str]) -> None:
    """A run that began at phase 0.25 ends there. A run of another chain is accepted, and its values are reported."""
    chain, file = scene("sec2").evolve(N=2, f=2000.0), str(tmp_path / "run.h5")
    save(run(chain, periods=20, record=1, samples=8, start=State(np.zeros(2), np.zeros(2), 0.25)), file)
    starts = []
    monkeypatch.setattr("granchain_core.orbits.periodic_orbit", lambda *given: starts.append(given[2]) or orbit(*given))
    assert main(["orbit", "sec2", "--set", "N=2", "--set", "f=2000", "--start", file, "--period", "1"]) == 0
    assert starts[0].phase == 0.25 and capsys.readouterr().err == ""
    assert main(["orbit", "sec2", "--set", "N=2", "--set", "f=1990", "--set", "D=90", "--start", file]) == 0
    assert "was recorded with f = 2000, D = 100: its last state is only where" in capsys.readouterr().err
    assert main(["orbit", "rig", "--set", "N=2", "--set", "f=140", "--start", file]) in (0, 3)
    assert "was recorded with other beads, " in capsys.readouterr().err


def test_the_json_of_a_curve_has_the_numbers_behind_a_regime(capsys: pytest.CaptureFixture[str]) -> None:
    """For a quasi-periodic point, they are the numbers that decide the label (docs/regimes.md)."""
    assert main(["curve", "sec2", "--from", "1700", "--to", "1700", "--points", "1", "--json"]) == 0
    said = {name: values[0] for name, values in json.loads(capsys.readouterr().out).items() if isinstance(values, list)}
    assert said["regime"] == "quasi-periodic" and said["decay"] is None
    assert said["return_distance"] < said["return_limit"]
    smallest, largest = said["window_ratios"]
    assert 0.9 < smallest <= largest < 1.1
    assert abs(said["lyapunov"][0]) < 0.01 and said["lyapunov_periods"] >= 220


def test_the_json_of_a_run_has_version_digest_and_lengths(capsys: pytest.CaptureFixture[str]) -> None:
    """With the version and the scene's hash, a line of JSON can be cited without the command that produced it."""
    chain = scene("sec2").evolve(N=2, f=2000.0)
    words = ["--set", "N=2", "--set", "f=2000", "--periods", "3", "--record", "2", "--samples", "8"]
    assert main(["run", "sec2", *words, "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["granchain_version"] == __version__ and told["scene_digest"] == chain.digest
    assert (told["periods"], told["record"], told["samples"]) == (3, 2, 8)
