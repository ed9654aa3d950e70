"""Measured forces from files are read as meant or refused with a line number, and saved observations can be read again.
"""

from __future__ import annotations

import json
from pathlib import Path

import h5py
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from recorded import error, recorded

from app import cli
from granchain_core import BadInput, observe, run, scene
from granchain_core.experiment import Unclear, answers_of
from granchain_core.observers import ForceRecord, force_record, read_force, read_force_csv
from granchain_core.store import save, save_observation

pytestmark = pytest.mark.quick

CHAIN = scene("fig11-founded").evolve(f=340.0)
STEP = 1e-5


def csv(force: np.ndarray, step: float = STEP, header: str = "time_s,force_N") -> str:
    return "\n".join([header, *(f"{i * step:.9g},{value:.9g}" for i, value in enumerate(force))])


def pulse(samples: int = 60) -> np.ndarray:
    return np.maximum(0.0, np.sin(np.arange(samples) * 0.1)) * 0.5


@pytest.mark.parametrize(("header", "time_unit", "force_unit", "factor"), [
    ("time_s,force_N", None, None, 1.0), ("t,input_force", "s", "N", 1.0), ("time_ms,force_mN", None, None, 1e-3),
    ("time,force", "ms", "mN", 1e-3), ("time_ms,force_kN", "ms", None, 1e3),
])
def test_units_are_the_headers_or_those_asked_for(header, time_unit, force_unit, factor) -> None:  # type: ignore[no-untyped-def]
    record = read_force_csv(csv(pulse(), header=header), time_unit, force_unit)
    milli = "ms" in header or time_unit == "ms"
    assert record.time[1] == pytest.approx(STEP * (1e-3 if milli else 1.0))
    assert record.force == pytest.approx(factor * pulse())
    assert ("ms" if milli else "time in s") in record.understood


@pytest.mark.parametrize("header", ["time_s,force_N,output_N", "t (s),Fin (N),Fout (N)", "time (ms),input (N),output (lbf)",
                                    "time_s,in_N,out_N", "time_s,input_N,fout_mN"])
def test_short_names_with_a_unit_of_force_are_the_two_forces(header: str) -> None:
    rows = "\n".join(f"{i},{value:.9g},{2.0 * value:.9g}" for i, value in enumerate(pulse()))
    record = read_force_csv(f"{header}\n{rows}")
    assert record.output is not None and record.output.max() > 0.0 and "left out" not in record.understood


def test_an_omitted_comparison_is_stated_first() -> None:
    rows = "\n".join(f"{i * STEP:.9g},{value:.9g},{2.0 * value:.9g}" for i, value in enumerate(pulse()))
    record = read_force_csv(f"time_s,force_N,wall sensor\n{rows}")
    assert record.output is None
    assert record.understood.startswith("No comparison with a measured output force, as no column is known as one (left "
                                        "out: wall sensor); 60 samples")
    named = read_force_csv(f"time_s,force_N,wall sensor\n{rows}", answers=answers_of(["t=1:s", "Fin=2:N"]))
    assert named.understood.startswith("60 samples") and read_force_csv(csv(pulse())).understood.startswith("60 samples")


def lines(changes: dict[int, str]) -> str:
    """Return sixty samples with some lines replaced; line 1 is the header, line 2 the first sample."""
    text = csv(pulse()).splitlines()
    return "\n".join(changes.get(number, line) for number, line in enumerate(text, 1))


@pytest.mark.parametrize(("text", "sentence"), [
    (lines({12: "1e-4,nan"}), "Line 12: 'nan' is not a number"), (lines({12: "1e-4,inf"}), "Line 12: 'inf'"),
    (lines({12: "5e-5,0.1"}), "Line 12: time 5e-05 s does not come after that of the line before"),
    (lines({12: "9e-5,0.1"}), "Line 12: time 9e-05 s does not come after"), (lines({12: "1e-4"}), "Line 12 has 1 columns"),
    (lines({12: ""}), "Line 13: 2e-05 s after the sample before, where 1e-05 s is usual: a gap"),
    (csv(pulse(), header="time_s,pressure"), "What 'pressure' holds is not clear"), ("time_s,force_N\n0,1\n1e-5,1", "at least 8"),
    ("0;0\n0.125;1,5", "Line 2: '1,5' does not have a decimal point, and '0.125' in line 2 no decimal comma"),
    ("time_ms;force_mN\n0;1,500\n0.1;1", "Line 2: '1,500' is 1500 with a decimal point and 1.5 with a decimal comma"),
    (csv(pulse(), header="time_s,force_MN"), "What 'force_MN' holds is not clear"),
    (csv(pulse(), header="time_s,force [pdl]"), "unit 'pdl' of column 'force .pdl.' is not known"),
    (csv(0.0 * pulse()), "zero at every sample"), ("", "empty"),
    (csv(pulse(), step=1e-3), r"Line 18: a pulse of 0.5 N may be as short as .* nearest valid spacing"),
])
def test_invalid_numbers_are_refused_with_their_line(text: str, sentence: str) -> None:
    with pytest.raises(BadInput, match=sentence):
        observe(CHAIN, read_force_csv(text))


def test_units_that_contradict_the_header_are_refused() -> None:
    with pytest.raises(BadInput, match="header says the input force is in mN, and N was asked for"):
        read_force_csv(csv(pulse(), header="time_s,force_mN"), force_unit="N")


def test_an_ambiguous_number_is_asked_for_and_read_as_answered() -> None:
    """The command's option --decimal gives the answer."""
    text = "\n".join(f"{row}.100;0,5" for row in range(1, 13))
    with pytest.raises(Unclear, match=r"'1\.100' is 1\.1 with a decimal point and 1100 with a decimal comma"):
        read_force_csv(text.replace("0,5", "5"))
    assert read_force_csv(text, answers=answers_of(decimal="comma")).time[0] == 1100.0


def test_times_stay_those_of_the_file() -> None:
    """A recording may begin at any time; lines are counted with the header and comments."""
    rows = "".join(f"{2.5 + i * STEP:.9g},{value:.9g}\n" for i, value in enumerate(pulse()))
    record = read_force_csv(f"# rig\ntime_s,force_N\n{rows}")
    assert record.time[0] == 2.5 and record.place(0) == "Line 3"


@pytest.mark.parametrize(("time", "force", "sentence"), [
    ([0.0, 1.0], [1.0], "equally long"), ("abc", [1.0], "must be numbers"), (np.zeros((2, 2)), [1.0], "one row"),
    (np.arange(20) * STEP, [*[0.1] * 7, np.nan, *[0.1] * 12], "Sample 7: force is nan"),
])
def test_arrays_that_are_no_record_are_refused(time, force, sentence: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(BadInput, match=sentence):
        force_record(time, force)


@given(st.one_of(st.text(max_size=300), st.binary(max_size=300)))
def test_any_file_is_read_or_refused(text: str | bytes) -> None:
    try:
        assert isinstance(read_force_csv(text), ForceRecord)
    except BadInput as refused:
        assert str(refused).endswith((".", "?"))


def test_a_gap_is_bridged_only_as_chosen_and_is_reported() -> None:
    time, force = np.arange(200) * STEP, 0.2 + 0.1 * np.sin(np.arange(200) * 0.05)
    kept = np.r_[0:80, 100:200]
    with pytest.raises(BadInput, match="choose zero"):
        observe(CHAIN, time[kept], force[kept])
    zero = observe(CHAIN, time[kept], force[kept], gap="zero")
    smooth = observe(CHAIN, time[kept], force[kept], gap="interpolate")
    assert any("1 gap taken as zero" in note for note in zero.record.notes)
    assert any("1 gap interpolated" in note for note in smooth.record.notes)
    assert (zero.record.force == 0.0).sum() == 2 and len(smooth.time) == len(kept)
    true = observe(CHAIN, time, force)
    # across 20 samples of a slow force, a cubic is accurate to a few per cent; zero is a different force
    assert error(smooth.displacement[-1], true.displacement[-1]) < 0.1 * error(zero.displacement[-1], true.displacement[-1])


def test_the_error_beside_a_gap_does_not_depend_on_which_sample_is_the_last_before_it() -> None:
    """Zero force was inserted into the gap; with half the sampling rate, it is at twice the distance, whatever the
    parity.
    """
    shown, step, finer = scene("sec2").evolve(N=3, k=1e5), 2e-6, 4
    dense = np.arange(finer * 1000) * step / finer
    force = np.maximum(0.0, np.sin(2.0 * np.pi * 800.0 * dense)) ** 2
    stated = []
    for last in (500, 501, 502):
        outside = (np.arange(len(dense)) <= finer * last) | (np.arange(len(dense)) >= finer * 700)
        coarse = outside & (np.arange(len(dense)) % finer == 0)
        seen = observe(shown, dense[coarse], force[coarse], gap="zero")
        better = observe(shown, dense[outside], force[outside], gap="zero")
        common = np.searchsorted(better.time, dense[coarse])
        mine = seen.displacement[np.searchsorted(seen.time, dense[coarse])]
        assert error(mine, better.displacement[common]) <= seen.displacement_error
        stated.append(seen.interpolation_error)
    assert max(stated) < 0.01 and max(stated) < 1.05 * min(stated)


def test_a_sample_beside_a_gap_is_named_as_in_its_source() -> None:
    """A record that is too coarse is refused with the place of its largest force; zeros in gaps are not counted."""
    time, force = np.arange(60) * 1e-3, np.zeros(60)
    force[50] = 1.0
    with pytest.raises(BadInput, match="Sample 45: a pulse of 1 N"):
        observe(CHAIN, np.delete(time, np.s_[20:25]), np.delete(force, np.s_[20:25]), gap="zero")


def test_an_offset_is_subtracted_only_if_asked() -> None:
    time, force = np.arange(400) * STEP, np.maximum(0.0, np.sin(np.arange(400) * 0.03) - 0.3)
    true = observe(CHAIN, time, force)
    for offset in (0.05, "0.05", "median"):
        seen = observe(CHAIN, time, force + 0.05, offset=offset)
        assert seen.displacement == pytest.approx(true.displacement, abs=1e-9 * np.abs(true.displacement).max())
        assert "offset of 0.05 N subtracted" in seen.record.notes
    with_offset = observe(CHAIN, time, force + 0.05)
    assert error(with_offset.displacement, true.displacement) > 0.01
    assert any("sensor's offset" in note for note in with_offset.record.notes)
    with pytest.raises(BadInput, match="neither a force"):
        observe(CHAIN, time, force, offset="mean")


def test_a_record_is_not_given_together_with_forces() -> None:
    time, force = np.arange(400) * STEP, np.zeros(400)
    with pytest.raises(BadInput, match="A record has its own forces"):
        observe(CHAIN, force_record(time, force), force)


def test_a_run_written_by_granchain_is_observed_and_comes_round(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    known, seen = tmp_path / "known.h5", tmp_path / "seen.h5"
    save(run(CHAIN, periods=60, record=2, samples=1000), known)
    words = ["observe", "fig11-founded", "--set", "f=340", "--set", "accuracy=0.1", "--start", "input", "--json"]
    assert cli.main([*words, "--input", str(known), "--out", str(seen)]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed["status"] == "done" and printed["residual"]["relative"] < 0.01
    assert printed["error_estimate"] == pytest.approx(printed["integration_error"] + printed["interpolation_error"])
    assert "given force" in printed["effects"] and "driver" not in printed["effects"]
    assert cli.main([*words, "--input", str(seen)]) == 0
    again = json.loads(capsys.readouterr().out)
    assert again["max_output_force"] == printed["max_output_force"]
    assert again["residual"]["relative"] < 1e-12
    with h5py.File(seen) as file:
        assert file["observation/displacement"].attrs["units"] == "m"
        assert file["observation/measured_output_force"].shape == file["observation/time"].shape


def test_a_difference_from_an_output_of_zeros_has_no_per_cent(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """There is nothing to divide by, so the key has the value null, in the JSON and in the file."""
    table, out = tmp_path / "force.csv", tmp_path / "seen.h5"
    table.write_text("time_s,force_N,output_force_N\n" + "".join(f"{i * STEP:.9g},{one:.9g},0\n" for i, one in enumerate(pulse())))
    words = ["observe", "fig11-founded", "--input", str(table)]
    assert cli.main([*words, "--out", str(out), "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed["residual"]["relative"] is None and printed["residual"]["rms"] > 0.0
    assert printed["residual_elastic"]["relative"] is None
    with h5py.File(out) as file:
        stored = json.loads(file.attrs["residual"], parse_constant=pytest.fail)
    assert stored["relative"] is None and stored["rms"] == printed["residual"]["rms"]
    assert cli.main(words) == 0
    said = capsys.readouterr().out
    assert "model − measured at 60 samples: rms" in said and "%" not in said and "inf" not in said


def test_saved_arrays_are_those_of_the_observation(tmp_path: Path) -> None:
    r = recorded(CHAIN, 500, 1)
    seen = observe(CHAIN, r.time, r.force, start=r.start)
    again = read_force(save_observation(seen, tmp_path / "seen.h5"))
    assert np.array_equal(again.time, r.time) and np.array_equal(again.force, r.force)
    assert again.output is not None and np.array_equal(again.output, seen.output_force)


@pytest.mark.parametrize(("words", "sentence"), [
    (["--input", "/no/such.csv"], "Cannot read"), ([], "--input"), (["--input", "FILE", "--gap", "fill"], "gap 'fill'"),
    (["--input", "FILE", "--start", "input"], "no state to start from"), (["--input", "FILE", "--time-unit", "m"], "unit"),
    (["--input", "FILE", "--start", "end"], "rest, input"), (["--input", "FILE", "--offset", "x"], "neither a force"),
    (["--input", "FILE", "--set", "kapa=1"], "kappa"),
])
def test_the_command_refuses_in_one_sentence(words, sentence: str, tmp_path: Path,  # type: ignore[no-untyped-def]
                                             capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "force.csv"
    file.write_text(csv(pulse()))
    assert cli.main(["observe", "sec2", *(str(file) if w == "FILE" else w for w in words)]) == 2
    said = capsys.readouterr()
    assert sentence in said.err and said.out == "" and "Traceback" not in said.err


def test_external_data_of_a_file_are_not_read(tmp_path: Path) -> None:
    secret, crafted = tmp_path / "secret.bin", tmp_path / "crafted.h5"
    secret.write_bytes(np.arange(100.0).tobytes())
    with h5py.File(crafted, "w") as file:
        group = file.create_group("run")
        group["input_force"] = np.ones(100)
        group.create_dataset("time", (100,), "f8", external=[(str(secret), 0, 800)])
    with pytest.raises(BadInput, match="only data in the file itself are read"):
        read_force(crafted)
