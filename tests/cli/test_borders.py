"""Unusual bad input: odd paths, links and files. The answer is always a sentence, never a traceback."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

from app.cli import main
from app.session.share import decode
from granchain_core import BadInput, ComputationError, run, scene
from granchain_core.hdf5 import seal
from granchain_core.kernels.batch_size import machine
from granchain_core.runs import to_accuracy
from granchain_core.store import load, save

pytestmark = pytest.mark.quick

SHORT = ["--set", "N=2", "--periods", "0", "--record", "1", "--samples", "4", "--set", "f=3000"]


@pytest.mark.parametrize("out", [".", "..", "/", "folder", "folder/", "/proc/granchain.h5", "a\nb/c.h5", "x" * 300])
def test_an_out_that_is_no_writable_file_is_bad_input(out, tmp_path, monkeypatch, capsys):
    """For example a folder, the root, a file system without files, or a name that is too long."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "folder").mkdir()
    assert main(["run", "sec2", *SHORT, "--out", out]) == 2
    said = capsys.readouterr().err
    assert "Traceback" not in said
    assert "Cannot write" in said
    assert os.listdir(tmp_path) == ["folder"]
    assert os.listdir(tmp_path / "folder") == []


def test_an_unwritable_out_is_refused_before_the_work(tmp_path, monkeypatch, capsys):
    """Hours of computing must not be lost to a misspelt folder: nothing is run if the file cannot be written."""
    def computes(*_, **__):
        pytest.fail("computed before looking at --out")

    monkeypatch.setattr(to_accuracy, "run", computes)
    assert main(["run", "sec2", *SHORT, "--out", str(tmp_path / "none" / "a.h5")]) == 2
    assert "Cannot write" in capsys.readouterr().err


@pytest.mark.parametrize("words", [["--from", "nan", "--to", "9", "--points", "3"], ["--from", "1", "--to", "inf", "--points", "3"],
                                   ["--from", "1", "--to", "9", "--points", "nan"], ["--from", "1", "--to", "9", "--points", "2.5"],
                                   ["--from", "1", "--to", "9", "--points", "-1"], ["--from", "x", "--to", "9", "--points", "1"],
                                   ["--from", "1e9", "--to", "2e9", "--points", "2"], ["--from", "5", "--points", "2"],
                                   ["--from", "1", "--to", "9", "--points", "100001"]])
def test_every_bad_number_of_a_curve_has_one_sentence(words, capsys):
    """The numbers are not finite, not whole, missing or too large."""
    assert main(["curve", "sec2", *words]) == 2
    out, said = capsys.readouterr()
    assert out == ""
    assert len(said.strip().splitlines()) == 1


@pytest.mark.parametrize(("words", "sentence"), [
    (["--samples", "0"], "nearest valid value is 1."), (["--samples", "2000000"], "nearest valid value is 1000000."),
    (["--record", "10000001"], "nearest valid value is 10000000."),
    (["--record", "100000", "--samples", "1000"], "at most 5e+07 are recorded: record 4545 periods."),
    (["--periods", "10000001"], "nearest valid value is 10000000.")])
def test_sizes_that_cannot_be_kept_are_refused(words, sentence, capsys):
    """They are refused before anything is allocated."""
    assert main(["run", "sec2", *words]) == 2
    assert sentence in capsys.readouterr().err


def test_a_long_run_keeps_only_the_states_that_decide_its_regime():
    """A million periods of ten thousand beads would be 160 GB of strobes."""
    shown = scene("sec2").evolve(N=2, f=3000.0)
    engine = to_accuracy.Engine(shown, to_accuracy.method_for(1e-3), 4)
    begun = to_accuracy.Reached(engine, 0, engine.strobe())
    kept = to_accuracy._attempt(begun, (3000, 1), None, to_accuracy.Counts(), None)
    assert len(kept.strobes) == to_accuracy.REMEMBERED + 1


def test_numbers_that_fail_in_a_run_exit_with_3_and_one_sentence(monkeypatch, capsys):
    """`run`, too, ends with status 3, and says which bead failed, when and why."""
    def fails(*_, **__):
        raise ComputationError("The motion of bead 3 stopped being a finite number at about 1 s.", "not-finite")

    monkeypatch.setattr(to_accuracy, "run", fails)
    assert main(["run", "sec2", *SHORT, "--json"]) == 3
    out, said = capsys.readouterr()
    assert json.loads(out)["status"] == "not-finite"
    assert said == "The motion of bead 3 stopped being a finite number at about 1 s.\n"


@pytest.mark.parametrize("words", [["run", "sec2", "a\nb\x1b[31m"], ["figure", "5", "--out", "a\nb\x1b[31m"],
                                   ["observe", "sec2", "--input", "a\nb\x1b[31m"]])
def test_a_sentence_repeats_no_control_characters(words, capsys):
    """A newline would split the sentence in two, and a terminal would execute escape sequences."""
    assert main(words) == 2
    assert r"a\nb\x1b[31m" in (sentence := capsys.readouterr().err) and sentence.count("\n") == 1


def test_stdout_of_a_process_is_one_json_object_and_nothing_else():
    """This is what a script reads, even with --explain: progress and explanations go to stderr."""
    words = [sys.executable, "-m", "app.cli", "run", "sec2", *SHORT, "--json", "--explain"]
    done = subprocess.run(words, capture_output=True, text=True, cwd=Path(__file__).parents[2], check=False, timeout=300)
    assert done.returncode == 0
    assert len(done.stdout.splitlines()) == 1
    assert json.loads(done.stdout)["status"] == "done"
    assert "compiled in: Hertz contact" in done.stderr


def test_explain_names_present_and_absent_effects_and_the_method(capsys):
    """It says which effects are compiled in and which are not, how the motion is computed, and why."""
    assert main(["run", "sec2", *SHORT, "--explain"]) == 0
    said = capsys.readouterr().out
    present, absent = said.splitlines()[:2]
    assert "Hertz contact" in present and "contact damping (LinearDashpot)" in present and "driver" in present
    assert all(name in absent for name in ("foundation", "preload", "tension cut"))
    assert "method:" in said and "accuracy of 1e-06" in said
    assert f"machine: {machine()}" in said


# --- share links ----------------------------------------------------------------------------------------------


def test_a_bad_kappa_does_not_take_a_good_k_with_it():
    """Each bad field is refused separately: if kappa is unreadable, k is used."""
    found, _, refused = decode("v=1&scene=sec2&k=5000&kappa=abc")
    assert found.k == 5000.0
    assert len(refused) == 1


def test_k_and_kappa_together_are_reported():
    """kappa is used, and k is refused with a sentence."""
    found, _, refused = decode("v=1&scene=sec2&kappa=0.001&k=5000")
    assert found.kappa == pytest.approx(0.001, rel=1e-12)  # k = κK√A0 and back
    assert len(refused) == 1 and "kappa was used" in refused[0]


@pytest.mark.parametrize("query", ["kappa=0.002&A0=1e-5", "A0=1e-5&kappa=0.002"])
def test_kappa_in_a_link_means_the_links_own_amplitude(query):
    """The order of the fields does not matter."""
    found, _, refused = decode("v=1&scene=rig&" + query)
    assert refused == []
    assert (found.A0, found.kappa) == (1e-5, pytest.approx(0.002, rel=1e-12))


def test_a_repeated_field_is_reported():
    """The command line refuses a knob that is set twice, and a link must not choose silently."""
    _, _, refused = decode("v=1&scene=sec2&f=300&f=400")
    assert len(refused) == 1


@pytest.mark.parametrize("field", ["f=", "f=1e400", "f=-inf", "f=0x10", "N=1e1000", "N=3.5", "wall=", "wall=-1", "tension=",
                                   "dissipation=LINEAR", "k=%00", "A0=%F0%9F%98%80", "accuracy=0", "F0=1,5"])
def test_every_bad_field_of_a_link_has_its_sentence(field):
    """The other fields of the link are used, and the refused one keeps the scene's own value."""
    found, _, refused = decode(f"v=1&scene=sec2&{field}&D=77")
    assert len(refused) == 1
    assert found == scene("sec2").evolve(D=77.0)


# --- files ----------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    """A small run in a file."""
    path = tmp_path_factory.mktemp("stored") / "a.h5"
    return save(run(scene("sec2").evolve(N=2, f=3000.0), periods=0, record=1, samples=4), path)


@pytest.mark.parametrize(("harm", "about"), [
    ("no scene", "no attribute scene"), ("scene no json", "scene is not JSON"), ("scene other", "no field"),
    ("no regime", "no attribute regime"), ("cost no json", "cost is .* not an object"), ("schema word", "granchain_schema"),
    ("time group", "/run/time is not a dataset"), ("displacement short", r"shape \(3,\), expected \(5, 2\)")])
def test_a_damaged_file_is_bad_input(harm, about, stored, tmp_path):
    """Whatever is missing or wrong in the file, `load` says that it is not a run written by granchain."""
    path = tmp_path / "b.h5"
    path.write_bytes(stored.read_bytes())
    with h5py.File(path, "a") as file:
        if harm == "no scene":
            del file.attrs["scene"]
        elif harm == "scene no json":
            file.attrs["scene"] = "{"
        elif harm == "scene other":
            file.attrs["scene"] = "{}"
        elif harm == "no regime":
            del file.attrs["regime"]
        elif harm == "cost no json":
            file.attrs["cost"] = "[1]"
        elif harm == "schema word":
            file.attrs["granchain_schema"] = "one"
        elif harm == "time group":
            del file["run/time"]
            file.create_group("run/time")
        else:
            del file["run/displacement"]
            file["run/displacement"] = np.zeros(3)
    seal(path)  # h5py removed it
    with pytest.raises(BadInput, match=f"b.h5 is not a run written by granchain: .*{about}"):
        load(path)


@pytest.mark.parametrize("option", ["--out", "--picture"])
def test_an_empty_file_name_is_refused(option, capsys):
    """With `--out "$FILE"` and an unset variable, the result used to be computed and lost."""
    assert main(["run", "sec2", *SHORT, option, ""]) == 2
    assert capsys.readouterr().err == f"{option} is empty; name a file.\n"


def test_a_negative_seed_of_an_orbit_is_bad_input(capsys):
    """It used to end in a traceback from NumPy."""
    assert main(["orbit", "sec2", "--start", "random", "--seed", "-1"]) == 2
    assert capsys.readouterr().err == "--seed -1 is outside 0 to 9223372036854775807; the nearest valid value is 0.\n"


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no device that is always full")
@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_a_standard_output_that_takes_no_more_is_a_sentence(unbuffered):
    """With stdout on a full disk, there used to be a traceback, or Python's own message and status 120."""
    with open("/dev/full", "w") as full:
        done = subprocess.run([sys.executable, "-m", "app.cli", "scenes", "--json"], stdout=full, stderr=subprocess.PIPE,
                              text=True, env={**os.environ, "PYTHONUNBUFFERED": unbuffered}, check=False)
    assert (done.returncode, done.stderr) == (2, "Cannot write to standard output: No space left on device.\n")


@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_a_reader_that_has_gone_ends_the_command_quietly(unbuffered):
    """An example is `granchain scenes | head -1`."""
    reading, writing = os.pipe()
    os.close(reading)
    done = subprocess.run([sys.executable, "-m", "app.cli", "scenes"], stdout=writing, stderr=subprocess.PIPE, text=True,
                          env={**os.environ, "PYTHONUNBUFFERED": unbuffered}, check=False)
    os.close(writing)
    assert (done.returncode, done.stderr) == (0, "")
