"""The data tab, without a browser: files, questions, answers, comparisons and refusals."""

from __future__ import annotations

import base64
import gc
import re
import threading
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from headless_dashboard import Dashboard

from app.dashboard.show import show_settled
from app.frames import samples_for
from app.pages.data import page as module
from app.pages.data.page import SAMPLES, DataPage
from app.plots.measured import measured_columns
from app.serve.computing.worker_pools import LONG
from app.serve.http.limits import MOST_UPLOADED_POINTS
from granchain_core import BadInput, CurvePoint, Scene, scene, settle, settling
from granchain_core.experiment import Measured, Series, answers_of, compared, read_data
from granchain_core.experiment.formats import FORMATS
from granchain_core.hdf5 import VERSIONS, seal
from granchain_core.results.forces import ForceErrors
from granchain_core.results.regime import Regime
from granchain_core.scene.state import rest
from granchain_core.virtual_experiment import Sensors, virtual_series_csv

FILE = b"frequency_Hz,force_N\n40,5.5\n60,12.1\n"


def data_page(dashboard: Dashboard) -> DataPage:
    """Return the page of the data tab."""
    return next(page for page in dashboard.pages if isinstance(page, DataPage))


def sent(content: bytes) -> dict[str, Any]:
    """Return a message with a file."""
    return {"do": "measurement", "name": "mine.csv", "content": base64.b64encode(content).decode()}


def after(dashboard: Dashboard, message: dict[str, Any], name: str) -> Any:
    """Return `name` in the tab's state after the message is processed, or the sentence if the message is refused."""
    dashboard.received(message)
    dashboard.run_callbacks_until(lambda: bool(dashboard.session.sentence or dashboard.views.tabs.state.get(name)))
    return dashboard.views.tabs.state.get(name) or dashboard.session.sentence


def test_every_byte_of_a_file_arrives(dashboard: Dashboard) -> None:
    text = "Frequenz [kHz];Kraft [µN]\r\n0,04;5\r\n".encode("utf-16")
    assert "UTF-16" in after(dashboard, sent(text), "understood")
    dashboard.received({"do": "measurement", "content": "???"})
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
    dashboard.received(sent((tmp_path / "a.h5").read_bytes()))
    dashboard.run_callbacks_until(lambda: bool(dashboard.views.tabs.state.get("question")))
    assert dashboard.views.tabs.state["question"]["reason"].startswith("What 'F'")


def test_files_are_offered_by_the_endings_of_all_formats(dashboard: Dashboard) -> None:
    assert dashboard.views.tabs.state["endings"] == [ending for format in FORMATS for ending in format.endings]


def test_a_question_is_shown_and_its_answers_are_kept(dashboard: Dashboard) -> None:
    question = after(dashboard, sent(b"1.100;2,5\n1.200;3,5\n"), "question")
    assert question["about"] == ["columns"] and question["rows"][0] == [1, ["1.100", "2,5"]]
    assert question["columns"][0] == [1, "", "frequency", "Hz"] and "kHz" in question["units"]["frequency"]
    answer = {"do": "measurement-answer", "columns": [["frequency", 1, "Hz"], ["force", 2, "mN"]], "decimal": "", "dataset": ""}
    dashboard.received(answer)
    dashboard.run_callbacks_until(lambda: dashboard.views.tabs.state["question"]["about"] == ["decimal"])
    understood = after(dashboard, {"do": "measurement-answer", "columns": [], "decimal": "comma"}, "understood")
    assert "1100 to 1200 Hz" in understood and dashboard.views.tabs.state["question"] is None


@pytest.mark.parametrize(("message", "sentence"), [
    ({"columns": "f"}, "could not be read"), ({"columns": [["frequency", 1]]}, "could not be read"),
    ({"columns": [["frequency", True, "Hz"]]}, "not the number of a column"), ({"columns": [["frequency", 1, "N"]]}, "not a unit"),
    ({"columns": [[None, 1, "N"]]}, "Unknown quantity"), ({"columns": [], "decimal": "both"}, "Unknown decimal mark"),
])
def test_an_answer_from_a_browser_is_not_trusted(dashboard: Dashboard, message: dict[str, Any], sentence: str) -> None:
    dashboard.received({"do": "measurement-answer", **message})
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
    figure.add("rest", [point(30.0, 4.0), point(50.0, 6.0), point(70.0, 16.0)], covers=True)
    figure.finished("rest")
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
    dashboard.received({"do": "measurement-sample"})
    assert told[0]["type"] == "sample" and told[0]["text"].startswith("# Not measured")


def show(dashboard: Dashboard) -> None:
    """Show a settled picture as the worker that computes it does."""
    chain = dashboard.session.scene
    dashboard.session.settled = settle(chain, samples=samples_for(chain))
    show_settled(dashboard.views, 1, dashboard.session.settled)


def with_series(dashboard: Dashboard, chain: Scene) -> str:
    """Return the tab's sentence about a series of `chain` over the settled picture at 340 Hz."""
    text = virtual_series_csv(chain, 12, Sensors(rate=256.0 * chain.f, noise=0.005)).encode()
    show(dashboard)
    dashboard.received({"do": "measurement", "name": "mine.csv", "content": base64.b64encode(text).decode()})
    dashboard.run_callbacks_until(lambda: re.search("series|rms", str(dashboard.views.tabs.state.get("misfit"))) is not None)
    return str(dashboard.views.tabs.state["misfit"]["sentence"])


def test_a_series_goes_over_the_force_trains_and_moves_with_the_picture(dashboard: Dashboard) -> None:
    """For the same scene, the differences are the noise; the lines are drawn over both trains and removed again."""
    sentence = with_series(dashboard, scene("sec2"))
    left = [float(number) for number in re.findall(r"([0-9.e-]+) N for the", sentence)]
    assert len(left) == 2 and all(0.003 < misfit < 0.02 for misfit in left)  # the noise is 5 mN; the jumps are smoothed alike
    trains = dashboard.views.trains
    lines = [[drawn for drawn in plot.renderers if drawn.level == "overlay"] for plot in (trains.left, trains.right)]
    assert [len(overlays) for overlays in lines] == [1, 1]
    assert all(len(overlays[0].data_source.data["time"]) > 1000 for overlays in lines)
    settled = dashboard.session.settled
    assert settled is not None
    preview = replace(settled, final=False)  # for knobs that have moved
    data_page(dashboard).picture_ready(preview)
    assert dashboard.views.tabs.state["misfit"] is None
    data_page(dashboard).picture_ready(settled)
    dashboard.run_callbacks_until(lambda: "rms" in str(dashboard.views.tabs.state["misfit"]))
    dashboard.received({"do": "measurement-remove"})
    assert all(len(overlays[0].data_source.data["time"]) == 0 for overlays in lines)


def test_the_model_passes_the_low_pass_of_the_sensors(dashboard: Dashboard) -> None:
    """A record of the same scene by 2 kHz sensors differs only by noise once their bandwidth is taken into account."""
    chain = scene("sec2")

    def differences(message: dict[str, Any]) -> list[float]:
        dashboard.views.tabs.update_state(misfit=None)
        dashboard.received(message)
        dashboard.run_callbacks_until(lambda: "rms" in str(dashboard.views.tabs.state.get("misfit")))
        return [float(number) for number in re.findall(r"([0-9.e-]+) N for the", dashboard.views.tabs.state["misfit"]["sentence"])]

    show(dashboard)
    record = virtual_series_csv(chain, 12, Sensors(rate=256.0 * chain.f, noise=0.003, bandwidth=2000.0)).encode()
    without = differences(sent(record))
    given = differences({"do": "measurement-bandwidth", "value": "2000"})
    assert min(without) > 0.015 and all(0.002 < misfit < 0.004 for misfit in given)
    assert "a low-pass of 2000 Hz" in dashboard.views.tabs.state["misfit"]["sentence"]
    assert differences({"do": "measurement-bandwidth", "value": ""}) == without
    for wrong in ("2 kHz", "0.5", None):
        dashboard.received({"do": "measurement-bandwidth", "value": wrong})
        assert "bandwidth" in dashboard.session.sentence


def test_a_measured_displacement_goes_over_the_drive(dashboard: Dashboard) -> None:
    """Its zero is arbitrary; aligned by the forces, it agrees with the drive of the picture."""
    chain = scene("sec2")
    rows = virtual_series_csv(chain, 12, Sensors(rate=256.0 * chain.f)).splitlines()
    table = np.array([[float(number) for number in row.split(",")] for row in rows[3:]])
    # integral of the velocity in the second column: v = A0 ω cos(ωt + φ), u = A0 sin(ωt + φ) + offset
    omega = 2.0 * np.pi * chain.f
    phase = np.angle(np.mean((table[:, 1]) * np.exp(-1j * omega * table[:, 0])))
    swing = 3e-6 + chain.A0 * np.sin(omega * table[:, 0] + phase)
    text = "time (s),displacement (m),output force (N)\n" + "".join(
        f"{t:.9g},{u:.9g},{force:.9g}\n" for t, u, force in zip(table[:, 0], swing, table[:, 3], strict=True))
    show(dashboard)
    dashboard.received(sent(text.encode()))
    dashboard.run_callbacks_until(lambda: "rms" in str(dashboard.views.tabs.state.get("misfit")))
    trains = dashboard.views.trains
    line, = (drawn for drawn in trains.left.renderers if drawn.level == "overlay")
    drawn = {name: np.asarray(values, dtype=float) for name, values in line.data_source.data.items()}
    factor = chain.A0 / 500.0  # the axis is in nm
    model = np.interp(drawn["time"], np.asarray(trains._source.data["time"]), np.asarray(trains._source.data["drive"]))
    assert line.x_range_name == "drive" and len(drawn["time"]) > 500
    # the model's samples are interpolated linearly
    np.testing.assert_allclose(drawn["force"], model, atol=0.02 * chain.A0 / factor)


def test_a_virtual_experiment_is_recorded_of_the_present_scene_and_says_so(dashboard: Dashboard) -> None:
    show(dashboard)
    assert "virtual experiment, nothing measured" in after(dashboard, {"do": "measurement-virtual"}, "understood")
    dashboard.run_callbacks_until(lambda: "rms" in str(dashboard.views.tabs.state.get("misfit")))


def test_a_virtual_experiment_does_not_delay_files(dashboard: Dashboard, monkeypatch: pytest.MonkeyPatch) -> None:
    """It settles a chain in a queue where each visitor has a share; two threads read and write everybody's files."""
    threads: dict[str, str] = {}

    def noting(of: str, original: Any, *words: Any, **named: Any) -> Any:
        threads[of] = threading.current_thread().name.split()[0]
        return original(*words, **named)

    for name in ("settling", "read_data"):
        monkeypatch.setattr(module, name, partial(noting, name, getattr(module, name)))
    show(dashboard)
    assert "virtual experiment" in after(dashboard, {"do": "measurement-virtual"}, "understood")
    assert threads == {"settling": "long", "read_data": "files"}


def test_a_virtual_experiment_that_does_not_settle_is_given_up(dashboard: Dashboard, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "WHOLE_PICTURE", -1.0)
    show(dashboard)
    assert after(dashboard, {"do": "measurement-virtual"}, "understood").endswith("so the virtual experiment was not made.")


def test_a_file_replaces_the_virtual_experiment_under_way(dashboard: Dashboard, monkeypatch: pytest.MonkeyPatch) -> None:
    begun, read = threading.Event(), threading.Event()

    def slow(*words: Any, **named: Any) -> Any:
        begun.set()
        assert read.wait(20)
        return settling(*words, **named)

    monkeypatch.setattr(module, "settling", slow)
    dashboard.received({"do": "measurement-virtual"})
    assert begun.wait(20)
    assert after(dashboard, sent(FILE), "understood").startswith("mine.csv: ")
    read.set()
    dashboard.run_callbacks_until(lambda: not LONG.busy_threads)
    dashboard.run_callbacks_until(lambda: not dashboard.callbacks)
    assert dashboard.views.tabs.state["understood"].startswith("mine.csv: ")


def test_a_file_stays_in_memory_only_while_a_question_about_it_is_open(dashboard: Dashboard) -> None:
    def kept() -> bool:
        # by type: any weak proxy of a deleted object raises `ReferenceError` when asked for its class
        pages = [thing for thing in gc.get_objects() if type(thing) is DataPage and thing._host is dashboard]
        return any(isinstance(value, bytes) and len(value) > 0 for page in pages for value in vars(page).values())

    assert after(dashboard, sent(FILE), "understood") and not kept()
    dashboard.received({"do": "measurement-remove"})
    assert after(dashboard, sent(b"1.100;2,5\n1.200;3,5\n"), "question") and kept()
    dashboard.received({"do": "measurement-remove"})
    assert not kept()


def test_a_question_about_other_data_is_not_answered(dashboard: Dashboard) -> None:
    """Otherwise, the bytes of the file in question would be read under the name of the virtual experiment."""
    assert after(dashboard, sent(b"1.100;2,5\n1.200;3,5\n"), "question")
    show(dashboard)
    dashboard.received({"do": "measurement-virtual"})
    assert dashboard.views.tabs.state["question"] is None
    answer = {"do": "measurement-answer", "columns": [["frequency", 1, "Hz"], ["force", 2, "mN"]], "decimal": "comma"}
    assert "virtual experiment, nothing measured" in after(dashboard, answer, "understood")
    dashboard.received({"do": "measurement-remove"})
    dashboard.received(answer)
    dashboard.run_callbacks_until(lambda: not dashboard.callbacks)
    assert not dashboard.views.tabs.state["understood"] and not dashboard.session.sentence


def test_a_file_that_is_refused_leaves_the_one_that_is_asked_about(dashboard: Dashboard) -> None:
    assert after(dashboard, sent(b"1.100;2,5\n1.200;3,5\n"), "question")
    dashboard.received({"do": "measurement", "name": "other.csv", "content": "???"})
    dashboard.received({"do": "measurement-answer", "columns": [["frequency", 1, "Hz"], ["force", 2, "mN"]], "decimal": "comma"})
    dashboard.run_callbacks_until(lambda: bool(dashboard.views.tabs.state.get("understood")))
    assert dashboard.views.tabs.state["understood"].startswith("mine.csv: ")


def test_a_series_without_a_force_is_refused(dashboard: Dashboard) -> None:
    rows = "".join(f"{1e-3 * i},{0.1 * i}\n" for i in range(12)).encode()
    assert "without a force" in after(dashboard, sent(b"time_s,velocity_m_s\n" + rows), "misfit")
