"""Numbers are read from text in the same way on the command line, in links and in files, and anything else is refused
with a sentence.
"""

from __future__ import annotations

import json
from pathlib import Path

import h5py
import pytest
from event_loop import run_async
from tornado.httpclient import AsyncHTTPClient

from app.cli import main
from app.dashboard import entry
from app.server import server_at
from app.session.share import decode
from granchain_core import BadInput, Scene, run, scene
from granchain_core.experiment import read_data
from granchain_core.inputs.text import number_in, whole_in
from granchain_core.store import load, save

#: Texts that Python's float or int accepts or fails on, but that no user means: digits joined by underscores,
#: full-width, Arabic and superscript digits, words, and far too many digits.
ODD = ["1_000", "１０００", "٣٤٠", "²", "nan", "inf", "0x10", "1e5_0", "1" * 5000, "1e999", "", "１e3"]
WHOLE = ["１", "1_0", "٣", "²", "1.0", "1e1", "", "1" * 5000]


@pytest.mark.parametrize(("text", "value"), [("340", 340.0), (" +3.4e2 ", 340.0), (".5", 0.5), ("5.", 5.0), ("-1E-3", -1e-3),
                                             ("0" * 300 + "7", 7.0)])
def test_numbers_are_read_as_people_write_them(text: str, value: float) -> None:
    assert number_in(text) == value


@pytest.mark.parametrize("text", ODD)
def test_odd_digits_are_no_number_anywhere(text: str, capsys: pytest.CaptureFixture[str]) -> None:
    """A knob, an option and a CSV file have the same rule, and each refuses such a text with one sentence."""
    assert number_in(text) is None
    for words in (["run", "sec2", "--set", f"f={text}"], ["curve", "sec2", "--points", "2", "--from", text, "--to", "900"],
                  ["map", "sec2", "--x", f"f={text}:900:2", "--y", "A0=1e-7:1e-6:2", "--out", "never.h5"],
                  ["branch", "sec2", "--knob", "f", "--from", "340", "--to", text], ["run", "sec2", "--budget", text]):
        assert main(words) == 2
        said = capsys.readouterr().err
        assert len(said.splitlines()) == 1 and "number" in said and len(said) < 300
    with pytest.raises(BadInput, match="number"):
        read_data(f"frequency_Hz;force_N\n1;2\n{text};3".encode())


@pytest.mark.parametrize("text", [text for text in ODD if len(text) < 1000])
def test_odd_digits_in_a_link_are_refused_and_the_rest_of_it_counts(text: str) -> None:
    shown, _, refused = decode(f"v=1&scene=sec2&f={text}&D=77")
    assert shown == scene("sec2").evolve(D=77.0) and len(refused) == 1


@pytest.mark.parametrize("text", WHOLE)
def test_odd_digits_are_no_whole_number(text: str, capsys: pytest.CaptureFixture[str]) -> None:
    """`serve --port １` used to listen on port 1."""
    assert whole_in(text) is None
    for words in (["serve", f"--port={text}"], ["run", "sec2", f"--periods={text}"], ["orbit", "sec2", f"--seed={text}"],
                  ["map", "sec2", "--x", f"f=300:900:{text}", "--y", "A0=1e-7:1e-6:2", "--out", "never.h5"]):
        assert main(words) == 2
        said = capsys.readouterr().err
        assert len(said.splitlines()) == 1 and "whole number" in said


@pytest.mark.parametrize("name", ["self", "changes", "cls", "scene", "f ", "__class__", "F"])
def test_an_unknown_knob_is_named(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    """`self`, for example, is an argument of the method that changes knobs."""
    assert main(["run", "sec2", "--set", f"{name}=1"]) == 2
    said = capsys.readouterr().err
    assert len(said.splitlines()) == 1 and "Unknown knob" in said
    if name != "scene":  # a field that links have
        _, _, refused = decode(f"v=1&scene=sec2&{name}=1")
        assert len(refused) == 1 and "Unknown field" in refused[0]
    with pytest.raises(BadInput, match="Unknown knob"):
        scene("sec2").evolve(**{name: 1})


@pytest.mark.parametrize("value", ["1_000", "１０００", "340", float("nan"), float("inf"), -1, True, None, [340.0], {}, 1e300])
def test_a_scene_in_a_file_goes_through_the_same_border(value: object, tmp_path: Path) -> None:
    """Its numbers must be JSON numbers: a text that looks like a number is refused as well."""
    path = save(run(scene("sec2").evolve(N=2, f=3000.0), periods=0, record=1, samples=4), tmp_path / "a.h5")
    old = tmp_path / "old.h5"
    with h5py.File(path) as new, h5py.File(old, "w") as file:
        for name in new:
            new.copy(name, file)
        file.attrs.update(new.attrs)
        told = json.loads(file.attrs["scene"])
        file.attrs["scene"] = json.dumps({**told, "f": value})
    with pytest.raises(BadInput, match=r"is not a run written by granchain: (The scene's f must be|drive frequency f)"):
        load(old)


@pytest.mark.parametrize(("field", "value"), [
    ("wall", "nowall"), ("wall", "1.5"), ("N", 2.5), ("N", 10**400), ("dissipation", "self"), ("tension", 1), ("accuracy", 0),
    ("reference_overlap", 0.0), ("pattern", []), ("pattern", [{"mass": 1.0}]), ("name", 3), ("self", 1), ("impurities", [[3, {}]]),
    ("pattern", [{"mass": -1.0, "radius": 1.0, "young": 1e9, "poisson": 0.3}]), ("start_velocity", [[3, 1.0]]),
    ("pattern", [{"mass": 1.0, "radius": 1.0, "young": 1e9, "poisson": 0.7}]), ("start_velocity", [[1, float("nan")]]),
    ("ranges", [["self", 0.0, 1.0]]), ("preset", [["f", "x"]]), ("ranges", 3), ("title", "x" * 20_000), ("start_velocity", [[1]])])
def test_no_other_value_of_a_scene_is_taken_unchecked(field: str, value: object) -> None:
    plain = scene("sec2").evolve(N=2).to_json()
    assert Scene.from_json(plain) == scene("sec2").evolve(N=2)
    refused = {"self": "Unknown field of a scene 'self'", "ranges": "scene's ranges|Unknown knob 'self'",
               "preset": "scene's f must be a number"}
    with pytest.raises(BadInput, match=refused.get(field, rf"(The scene's {field}|{field} =|beads N) ")):
        Scene.from_json({**plain, field: value})
    with pytest.raises(BadInput, match="no field f"):
        Scene.from_json({name: kept for name, kept in plain.items() if name != "f"})


@pytest.mark.parametrize("query", ["self=1", "f=" + "1" * 5000, "f=%C2%B2", "f=1_000", "f=%EF%BC%91", "N=%D9%A3"])
def test_the_page_opens_with_any_address(query: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The page is requested as by a browser; Panel's own parser answered some of these addresses with a server error.
    """
    seen: list[list[str]] = []
    monkeypatch.setattr(entry.Controller, "show_sentence", lambda self, sentence: seen.append([sentence]))

    async def asked() -> int:
        server = server_at(0, "127.0.0.1")
        server.start()
        try:
            answer = await AsyncHTTPClient().fetch(f"http://127.0.0.1:{server.port}/?{query}", raise_error=False)
            return answer.code
        finally:
            server.stop(wait=False)

    assert run_async(asked()) == 200
    assert len(seen) == 1 and seen[0][0].endswith(".")
