"""Checked access to a file: the seal, links and data that are not followed, limits of the child, and sentences."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import xarray

from app.cli import main
from granchain_core import BadInput
from granchain_core.hdf5 import checked_file, child, plain, seal
from granchain_core.store import load
from granchain_core.tables import MAXIMA
from tools.damage.harms import FORGERIES, LEADING
from tools.damage.kinds import KINDS, made, told

pytestmark = pytest.mark.quick

#: One dataset that each reader needs.
NEEDED = {"run": "run/displacement", "start of orbit": "run/velocity", "force of a run": "run/input_force",
          "branch": "branch/state", "curve": "curve/period", "map": "map/regime", "observation": "observation/displacement"}


#: Words in the refusal of each forgery. For some there are two, depending on which check comes first.
SAID = {"external link": ("is a link",), "soft link": ("is a link",), "external storage": ("is stored in another file",),
        "virtual dataset": ("is virtual",), "huge shape": ("is virtual", "bytes in a file of"),
        "circle of groups": ("is not a dataset", "is not a group")}


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[Path, Path]]:
    """A file of every kind, with and without its seal."""
    folder = tmp_path_factory.mktemp("files")
    return {name: made(kind, folder) for name, kind in KINDS.items()}


@pytest.fixture
def changed(files: dict[str, tuple[Path, Path]], tmp_path: Path) -> Callable[..., Path]:
    """Function that changes a copy of a file with h5py and seals it again."""
    def change(kind: str, by: Callable[[h5py.File], Any]) -> Path:
        path = tmp_path / "changed.h5"
        path.write_bytes(files[kind][0].read_bytes())
        with h5py.File(path, "a") as file:
            by(file)
        seal(path)
        return path
    return change


def refused(read: Callable[[Path], Any], path: Path) -> str:
    """Return the one sentence with which a file is refused."""
    with pytest.raises(BadInput) as caught:
        read(path)
    said = str(caught.value)
    assert str(path) in said and said.endswith(".") and "\n" not in said
    return said


# --- the seal ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", KINDS)
def test_no_flipped_bit_is_read_as_a_number(kind: str, files: dict[str, tuple[Path, Path]], tmp_path: Path) -> None:
    """Flips every seventh bit of the seal's line and of the first 100 bytes, and 200 random bits."""
    content = files[kind][0].read_bytes()
    end, rng = 8 * len(content), np.random.default_rng(1)
    bits = [*range(0, 800, 7), *(int(bit) for bit in rng.integers(end, size=200)), *range(end - 880, end, 7)]
    path = tmp_path / "flipped.h5"
    for bit in bits:
        flipped = bytearray(content)
        flipped[bit // 8] ^= 1 << (bit % 8)
        path.write_bytes(flipped)
        refused(KINDS[kind].read, path)


@pytest.mark.parametrize("kind", KINDS)
def test_a_file_without_a_seal_is_read_by_a_child_and_gives_the_same(kind: str, files: dict[str, tuple[Path, Path]],
                                                                     monkeypatch: pytest.MonkeyPatch) -> None:
    sealed, old = files[kind]
    true = told(KINDS[kind].read(sealed))
    monkeypatch.delattr(checked_file, "Plain")
    assert told(KINDS[kind].read(old)) == true
    monkeypatch.undo()
    monkeypatch.delattr(checked_file, "Child")
    assert told(KINDS[kind].read(sealed)) == true


def test_a_file_that_another_program_changed_is_refused_and_says_so(files: dict[str, tuple[Path, Path]], tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    path.write_bytes(files["run"][0].read_bytes())
    with h5py.File(path, "a") as file:
        file.attrs["note"] = "mine"
    assert "its checksum is missing" in refused(load, path)
    path.write_bytes(files["run"][0].read_bytes()[:-200])
    assert "checksum is missing: the file is damaged" in refused(load, path)


def test_the_seal_is_the_digest_that_everybody_computes(files: dict[str, tuple[Path, Path]]) -> None:
    *_, line = files["run"][0].read_bytes().rstrip(b"\n").split(b"\n")
    size, digest = int(line.split()[4]), line.split()[-1].decode()
    told = subprocess.run(["sha256sum"], input=files["run"][0].read_bytes()[:size], capture_output=True, check=True).stdout
    assert told.split()[0].decode() == digest


def test_other_programs_recognise_the_format_of_a_sealed_file(files: dict[str, tuple[Path, Path]]) -> None:
    """A user block would have moved the signature by which xarray recognises HDF5."""
    path, old = files["run"]
    with xarray.open_dataset(path, group="run") as data, h5py.File(path) as file, h5py.File(old) as before:
        assert data.displacement.dims == ("time", "bead")
        assert file.attrs.keys() == before.attrs.keys() and file["run"].keys() == before["run"].keys()
        assert (file["run/force"][()] == before["run/force"][()]).all()


# --- links and foreign data -------------------------------------------------------------------------------


@pytest.mark.parametrize("name", LEADING)
@pytest.mark.parametrize("kind", NEEDED)
def test_numbers_come_from_the_file_itself_alone(kind: str, name: str, files: dict[str, tuple[Path, Path]],
                                                 changed: Callable[..., Path], tmp_path: Path) -> None:
    """Links anywhere on the path, external and virtual data, and shapes that were never written are refused.

    This holds for sealed files and for those that a child reads.
    """
    for seed in range(3):
        path = changed(kind, lambda file, seed=seed: FORGERIES[name](file, NEEDED[kind], tmp_path, np.random.default_rng(seed)))
        assert any(words in refused(KINDS[kind].read, path) for words in SAID[name])
    old = tmp_path / "old.h5"
    old.write_bytes(files[kind][1].read_bytes())
    with h5py.File(old, "a") as file:
        FORGERIES[name](file, NEEDED[kind], tmp_path, np.random.default_rng(0))
    assert any(words in refused(KINDS[kind].read, old) for words in SAID[name])


def test_chunked_data_are_not_read(changed: Callable[..., Path]) -> None:
    """Chunked data may need a filter, which HDF5 would load."""
    def pieces(file: h5py.File) -> None:
        values = file["run/time"][()]
        del file["run/time"]
        file.create_dataset("run/time", data=values, chunks=values.shape)

    assert "/run/time is virtual, compressed or in pieces" in refused(load, changed("run", pieces))


@pytest.mark.parametrize(("shape", "options"), [((10**12,), {}), ((10**12,), {"chunks": True}), ((2**62, 4), {"chunks": (1, 4)})])
def test_a_size_is_bounded_before_memory_is_allocated(shape: tuple[int, ...], options: dict[str, Any], changed: Callable[..., Path],
                                                      monkeypatch: pytest.MonkeyPatch) -> None:
    def huge(file: h5py.File) -> None:
        del file["run/time"]
        file.create_dataset("run/time", shape, "f8", **options)

    path = changed("run", huge)
    monkeypatch.setattr(plain.Plain, "numbers", lambda *_: pytest.fail("read before it was bounded"))
    assert "/run/time" in refused(load, path)


@pytest.mark.parametrize(("change", "words"), [
    (lambda f: f.move("run/velocity", "run/v"), "no /run/velocity"), (lambda f: f.attrs.modify("knob_f", 341.0), "knob_f is 341.0"),
    (lambda f: f.attrs.modify("status", "fine"), "status is 'fine', not one of 'done'"),
    (lambda f: f.attrs.modify("samples_per_period", 0), "whole number from 1"),
    (lambda f: f.attrs.modify("max_output_force", float("nan")), "max_output_force is nan"),
    (lambda f: f["run/jump_contact"].write_direct(np.full(f["run/jump_contact"].shape, 99)), "jump_contact holds 99 to 99"),
    (lambda f: f.attrs.modify("cost", '{"wall_s": 1, "steps": -1}'), "cost.steps is '-1', not a whole number from 0"),
    (lambda f: f.attrs.modify("regime", "[" * 30_000), "not JSON: it is nested too deeply"),
    (lambda f: f.attrs.modify("granchain_schema", 2), "schema is 2"),
    (lambda f: f.attrs.__setitem__("cost", np.zeros(3)), "not one value"),
])
def test_kinds_and_values_are_checked(change: Callable[[h5py.File], Any], words: str, changed: Callable[..., Path]) -> None:
    assert words in refused(load, changed("run", change))


#: Datasets with a unit in each kind of file, including all that its reader uses.
DIMENSIONS = {
    "run": {"run/time": "s", "run/displacement": "m", "run/velocity": "m/s", "run/force": "N",
            "run/drive_displacement": "m", "run/jump_time": "s", "run/jump_force": "N"},
    "start of orbit": {"run/displacement": "m", "run/velocity": "m/s"},
    "force of a run": {"run/time": "s", "run/input_force": "N", "run/output_force": "N", "run/displacement": "m",
                       "run/velocity": "m/s"},
    "branch": {f"{group}/{name}": unit for group in ("branch", "special_before", "special_after")
               for name, unit in {"knob": "Hz", **dict.fromkeys(MAXIMA, "N"), "state": "1"}.items()}
              | dict.fromkeys(("special/knob", "special/knob_low", "special/knob_high"), "Hz"),
    "curve": {"curve/frequency": "Hz", **{f"curve/{name}": "N" for name in MAXIMA}, "curve/error_estimate": "1",
              "curve/decay": "1"},
    "map": {"map/f": "Hz", "map/A0": "m", **{f"map/{name}": "N" for name in MAXIMA}, "map/lyapunov": "1"},
    "observation": {"observation/time": "s", "observation/input_force": "N", "observation/output_force": "N",
                    "observation/displacement": "m", "observation/velocity": "m/s"}}


def test_every_kind_has_its_dimensions_here() -> None:
    assert DIMENSIONS.keys() == KINDS.keys()


@pytest.mark.parametrize(("kind", "name"), [(kind, name) for kind, names in DIMENSIONS.items() for name in names])
def test_another_unit_is_refused_and_a_missing_unit_means_si(kind: str, name: str, files: dict[str, tuple[Path, Path]],
                                                            changed: Callable[..., Path]) -> None:
    unit = DIMENSIONS[kind][name]
    other = changed(kind, lambda file: file[name].attrs.modify("units", f"k{unit}"))
    assert f"/{name} is in 'k{unit}', expected '{unit}'" in refused(KINDS[kind].read, other)
    unnamed = changed(kind, lambda file: file[name].attrs.__delitem__("units"))
    assert told(KINDS[kind].read(unnamed)) == told(KINDS[kind].read(files[kind][0]))


# --- every error is a sentence ----------------------------------------------------------------------------


@pytest.mark.parametrize("error", [OSError, RuntimeError, MemoryError, RecursionError, KeyError, ValueError, TypeError,
                                   OverflowError, AttributeError, IndexError, NotImplementedError, UnicodeDecodeError, AssertionError])
def test_every_error_of_a_library_is_one_sentence(error: type[Exception], files: dict[str, tuple[Path, Path]],
                                                  monkeypatch: pytest.MonkeyPatch) -> None:
    problem = error("utf-8", b"x", 0, 1, "bad") if error is UnicodeDecodeError else error("a\nb")
    for name, kind in KINDS.items():
        for part in ("__init__", "attribute", "stored", "numbers"):
            def fails(*_: object, problem: Exception = problem) -> None:
                raise problem

            with monkeypatch.context() as patch:
                patch.setattr(plain.Plain, part, fails)
                if part == "attribute" and name in ("force of a run", "observation"):
                    continue  # these read no attributes
                refused(kind.read, files[name][0])


@pytest.mark.parametrize("command", [["orbit", "sec2", "--start"], ["branch", "sec2", "--resume"], ["observe", "sec2", "--input"],
                                     ["map", "sec2", "--x", "f=300:400:2", "--y", "A0=1e-7:1e-6:2", "--resume", "--out"]])
def test_the_commands_refuse_a_damaged_file_with_status_2(command: list[str], files: dict[str, tuple[Path, Path]], tmp_path: Path,
                                                          capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "a.h5"
    content = bytearray(files["run"][0].read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)
    assert main([*command, str(path)]) == 2
    said = capsys.readouterr().err
    assert len(said.splitlines()) == 1 and "its checksum does not match" in said


def test_pipes_and_folders_are_refused_without_waiting(tmp_path: Path) -> None:
    """A pipe would keep a reader waiting forever."""
    os.mkfifo(tmp_path / "pipe")
    for name in ("pipe", ".", "missing.h5"):
        refused(load, tmp_path / name)
    with pytest.raises(BadInput, match="null"):
        load("a\0b")


# --- the child --------------------------------------------------------------------------------------------


def child_that(does: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Replace the child by a program of a few words."""
    script = tmp_path / "child.py"
    script.write_text(f"import os, sys, time\nsys.stdout.write('{{\"found\": null}}\\n'); sys.stdout.flush()\n{does}\n")
    monkeypatch.setattr(child.plain, "__file__", str(script))


@pytest.mark.parametrize(("does", "words"), [
    ("time.sleep(60)", "took more than 1 s"), ("os.abort()", "ended with status -6"), ("sys.exit(3)", "ended with status 3"),
    ("while True: pass", "took more than 1 s"), ("print('no JSON')", "is not a run written by granchain"),
    ("sys.stdin.readline(); print('[]')", "is not a run written by granchain")])
def test_a_child_that_hangs_or_ends_is_reported(does: str, words: str, files: dict[str, tuple[Path, Path]], tmp_path: Path,
                                            monkeypatch: pytest.MonkeyPatch) -> None:
    child_that(does, tmp_path, monkeypatch)
    monkeypatch.setattr(child, "_SECONDS", 1)
    begun: list[Any] = []
    real = subprocess.Popen
    monkeypatch.setattr(child.subprocess, "Popen", lambda *a, **k: begun.append(real(*a, **k)) or begun[-1])
    assert words in refused(load, files["run"][1])
    assert len(begun) == 1 and begun[0].returncode is not None


def test_a_child_has_limits_of_time_and_memory(tmp_path: Path) -> None:
    """The system enforces one second of computing time, and a memory limit on top of the file size."""
    program = ("import importlib.util, sys; spec = importlib.util.spec_from_file_location('plain', sys.argv[1]); "
               "plain = importlib.util.module_from_spec(spec); sys.modules['plain'] = plain; spec.loader.exec_module(plain); "
               "plain.limit(1, 10**6)\n")

    def ran(does: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run([sys.executable, "-c", program + does, plain.__file__], capture_output=True, text=True, check=False)

    assert ran("print(len(bytes(10**8)))").stdout == "100000000\n"
    assert "MemoryError" in ran("bytes(10**9)").stderr
    assert ran("while True: pass").returncode < 0


def test_a_child_imports_nothing_of_granchain() -> None:
    """Importing it would take a second, and it would be loaded from wherever the file is."""
    program = ("import sys; sys.path.insert(0, sys.argv[1]); import plain; "
               "print([m for m in sys.modules if 'granchain' in m or m == 'numba'])")
    command = [sys.executable, "-P", "-c", program, str(Path(plain.__file__).parent)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"
