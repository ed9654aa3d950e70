"""The data tab, without a browser: files, questions, answers, measured curves and refusals."""

from __future__ import annotations

import gc
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from data_tab import FILE, after, data_page, sent, show
from headless_dashboard import Dashboard

from app.pages.data import page as module
from app.pages.data.page import SAMPLES, DataPage
from app.plots.measured import measured_columns
from app.serve.http.limits import MOST_UPLOADED_POINTS
from granchain_core import BadInput, CurvePoint, scene
from granchain_core.experiment import Measured, Series, answers_of, compared, read_data
from granchain_core.experiment.formats import FORMATS
from granchain_core.hdf5 import VERSIONS, seal
from granchain_core.results.forces import ForceErrors
from granchain_core.results.regime import Regime
from granchain_core.scene.state import rest


def test_every_byte_of_a_file_arrives(dashboard: Dashboard) -> None:
    text = "Frequenz [kHz];Kraft [µN]\r\n0,04;5\r\n".encode("utf-16")
    assert "UTF-16" in after(dashboard, sent(text), "understood")
    dashboard.receive({"do": "measurement", "content": "???"})
    assert "did not arrive" in dashboard.session.sentence


@pytest.mark.parametrize("sealed", [True, False])
def test_hdf5_never_parses_an_upload_in_the_server(sealed: bool, dashboard: Dashboard, tmp_path: Path,
                                                   monkeypatch: pytest.MonkeyPatch) -> None:
    """A seal is not a signature: a stranger can seal a file as well."""
    path = tmp_path / "data.h5"
    with h5py.File(path, "w", libver=VERSIONS if sealed else None) as file:
        for name, unit in (("frequency", "Hz"), ("force", "N")):
            file[name] = [40.0, 60.0]
            file[name].attrs["units"] = unit
    if sealed:
        seal(path)
    monkeypatch.setattr(h5py, "File", lambda *_: pytest.fail("parsed in the server's process"))
    assert "2 points" in after(dashboard, sent(path.read_bytes()), "understood")


def many_samples(name: str, count: int, folder: Path) -> bytes:
    """Return a series of this many samples in a format of the table; a digitiser's project contains a curve."""
    time, force = 1e-6 * np.arange(count), np.ones(count)
    if "HDF5" in name:
        with h5py.File(folder / "long.h5", "w") as file:
            for row, values, unit in (("time", time, "s"), ("output_force", force, "N")):
                file[row] = values
                file[row].attrs["units"] = unit
        return (folder / "long.h5").read_bytes()
    if "project" in name:
        points = ",".join(f'{{"value":[{i},1]}}' for i in range(1, count + 1))
        return f'{{"datasetColl":[{{"name":"curve","data":[{points}]}}]}}'.encode()
    return ("time_s,output_force_N\n" + "".join(f"{at:.6f},1\n" for at in time)).encode()


@pytest.mark.parametrize("name", [format.name for format in FORMATS])
def test_a_measurement_of_too_many_points_is_refused_in_every_format(name: str, tmp_path: Path) -> None:
    """Of a text, lines are counted, and its heading is one of them."""
    most = MOST_UPLOADED_POINTS - (name == "table in text")
    for count, refused in ((most, False), (most + 1, True)):
        content = many_samples(name, count, tmp_path)
        answers = answers_of(["f=1:Hz", "F=2:N"] if "project" in name else [])
        if refused:
            with pytest.raises(BadInput, match=f"at most {MOST_UPLOADED_POINTS} are read"):
                module._found(content, answers, "mine")
        else:
            found = module._found(content, answers, "mine")
            assert count == len(found.time if isinstance(found, Series) else found.frequency)


def test_an_hdf5_file_keeps_the_visitors_name(dashboard: Dashboard, tmp_path: Path) -> None:
    """Messages about the file do not name a folder of the server."""
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["frequency"] = [40.0]
    sentence = after(dashboard, sent((tmp_path / "a.h5").read_bytes()), "understood")
    assert sentence == "The file is not a measurement that can be read: it has no two rows of numbers of one length."
    with h5py.File(tmp_path / "a.h5", "a") as file:
        file["f"] = file["F"] = [40.0, 60.0]
    dashboard.receive(sent((tmp_path / "a.h5").read_bytes()))
    dashboard.run_callbacks_until(lambda: bool(dashboard.views.tabs.state.get("question")))
    assert dashboard.views.tabs.state["question"]["reason"].startswith("What 'F'")


def test_files_are_offered_by_the_endings_of_all_formats(dashboard: Dashboard) -> None:
    assert dashboard.views.tabs.state["endings"] == [ending for format in FORMATS for ending in format.endings]


def test_a_question_is_shown_and_its_answers_are_kept(dashboard: Dashboard) -> None:
    question = after(dashboard, sent(b"1.100;2,5\n1.200;3,5\n"), "question")
    assert question["about"] == ["columns"] and question["rows"][0] == [1, ["1.100", "2,5"]]
    assert question["columns"][0] == [1, "", "frequency", "Hz"] and "kHz" in question["units"]["frequency"]
    answer = {"do": "measurement-answer", "columns": [["frequency", 1, "Hz"], ["force", 2, "mN"]], "decimal": "", "dataset": ""}
    dashboard.receive(answer)
    dashboard.run_callbacks_until(lambda: dashboard.views.tabs.state["question"]["about"] == ["decimal"])
    understood = after(dashboard, {"do": "measurement-answer", "columns": [], "decimal": "comma"}, "understood")
    assert "1100 to 1200 Hz" in understood and dashboard.views.tabs.state["question"] is None


@pytest.mark.parametrize(("message", "sentence"), [
    ({"columns": "f"}, "could not be read"), ({"columns": [["frequency", 1]]}, "could not be read"),
    ({"columns": [["frequency", True, "Hz"]]}, "not the number of a column"), ({"columns": [["frequency", 1, "N"]]}, "not a unit"),
    ({"columns": [[None, 1, "N"]]}, "Unknown quantity"), ({"columns": [], "decimal": "both"}, "Unknown decimal mark"),
])
def test_an_answer_from_a_browser_is_not_trusted(dashboard: Dashboard, message: dict[str, Any], sentence: str) -> None:
    dashboard.receive({"do": "measurement-answer", **message})
    assert sentence in dashboard.session.sentence


def test_a_series_is_not_drawn_as_a_curve(dashboard: Dashboard) -> None:
    text = b"time_s,velocity_m_s\n" + b"".join(b"%d,1\n" % i for i in range(12))
    assert "is a time series" in after(dashboard, sent(text), "understood")


def point(f: float, force: float) -> CurvePoint:
    """Return a point of a curve."""
    return CurvePoint(f, force, force, force, Regime("periodic", 1, None, None, 9), ForceErrors(), rest(scene("sec2")))


def test_the_misfit_is_in_newtons_and_comes_with_the_whole_curve(dashboard: Dashboard) -> None:
    assert after(dashboard, sent(FILE), "understood").startswith("mine.csv: 2 points")
    assert dashboard.views.tabs.state["misfit"] is None
    figure = dashboard.views.curve
    figure.add("rest", [point(30.0, 4.0), point(50.0, 6.0), point(70.0, 16.0)], covers_range=True)
    figure.note_complete("rest")
    data_page(dashboard).curve_compared(figure.difference)
    misfit: Any = dashboard.views.tabs.state["misfit"]
    # the model has 5 N at 40 Hz and 11 N at 60 Hz: −0.5 and −1.1 N
    assert "rms 0.854 N" in misfit["sentence"] and "largest -1.1 N at 60 Hz" in misfit["sentence"]
    assert misfit["rows"][0] == ["40 Hz", "5.5 N", "5.000 N", "−500 mN"]
    figure.begin(["rest"])
    assert figure.difference is None


def test_residuals_are_nan_where_there_is_no_curve() -> None:
    measured = read_data(b"f [Hz],F [N],error [N]\n10,1,0.1\n50,3,0.5\n")
    assert isinstance(measured, Measured)
    found = compared(measured, np.array([40.0, 60.0]), np.array([1.0, 3.0]))
    assert list(found.compared) == [False, True] and found.residuals[1] == pytest.approx(-1.0)
    assert found.sentence.endswith("rms 2 stated errors.") and "1 of 2 frequencies" in found.sentence
    assert measured_columns(measured, 1.0, found.residuals)["residual"] == ["no model here", "−1.00 N"]


def test_bars_are_errors_or_the_extremes_of_repeats() -> None:
    stated = read_data(b"f [Hz],F [N],error [N]\n50,3,0.5\n")
    repeated = read_data(b"f [Hz],F [N]\n50,3\n50,4\n")
    assert isinstance(stated, Measured) and isinstance(repeated, Measured)
    assert [measured_columns(stated, 1.0)[name] for name in ("low", "high")] == [[2.5], [3.5]]
    assert [measured_columns(repeated, 0.5)[name] for name in ("low", "high")] == [[6.0], [8.0]]


def test_the_sample_file_is_read_and_marked_as_not_measured(dashboard: Dashboard) -> None:
    found = read_data((SAMPLES / "curve.csv").read_bytes())
    assert isinstance(found, Measured) and found.note.startswith("Not measured: computed by granchain")
    assert found.repeats is not None and found.repeats.max() == 3
    told: list[dict[str, Any]] = []
    dashboard.views.tabs.send = lambda **message: told.append(message)  # type: ignore[method-assign]
    dashboard.receive({"do": "measurement-sample"})
    assert told[0]["type"] == "sample" and told[0]["text"].startswith("# Not measured")


def test_a_file_stays_in_memory_only_while_a_question_about_it_is_open(dashboard: Dashboard) -> None:
    def kept() -> bool:
        # by type: any weak proxy of a deleted object raises `ReferenceError` when asked for its class
        pages = [thing for thing in gc.get_objects() if type(thing) is DataPage and thing._host is dashboard]
        return any(isinstance(value, bytes) and len(value) > 0 for page in pages for value in vars(page).values())

    assert after(dashboard, sent(FILE), "understood") and not kept()
    dashboard.receive({"do": "measurement-remove"})
    assert after(dashboard, sent(b"1.100;2,5\n1.200;3,5\n"), "question") and kept()
    dashboard.receive({"do": "measurement-remove"})
    assert not kept()


def test_a_question_about_other_data_is_not_answered(dashboard: Dashboard) -> None:
    """Otherwise, the bytes of the file in question would be read under the name of the virtual experiment."""
    assert after(dashboard, sent(b"1.100;2,5\n1.200;3,5\n"), "question")
    show(dashboard)
    dashboard.receive({"do": "measurement-virtual"})
    assert dashboard.views.tabs.state["question"] is None
    answer = {"do": "measurement-answer", "columns": [["frequency", 1, "Hz"], ["force", 2, "mN"]], "decimal": "comma"}
    assert "virtual experiment, nothing measured" in after(dashboard, answer, "understood")
    dashboard.receive({"do": "measurement-remove"})
    dashboard.receive(answer)
    dashboard.run_callbacks_until(lambda: not dashboard.callbacks)
    assert not dashboard.views.tabs.state["understood"] and not dashboard.session.sentence


def test_a_file_that_is_refused_leaves_the_one_that_is_asked_about(dashboard: Dashboard) -> None:
    assert after(dashboard, sent(b"1.100;2,5\n1.200;3,5\n"), "question")
    dashboard.receive({"do": "measurement", "name": "other.csv", "content": "???"})
    dashboard.receive({"do": "measurement-answer", "columns": [["frequency", 1, "Hz"], ["force", 2, "mN"]], "decimal": "comma"})
    dashboard.run_callbacks_until(lambda: bool(dashboard.views.tabs.state.get("understood")))
    assert dashboard.views.tabs.state["understood"].startswith("mine.csv: ")
