"""The visitor's measurement: read in the background, with questions if it is unclear, and compared with the model."""

from __future__ import annotations

import base64
import binascii
import math
import time
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

from granchain_core import BadInput, Run, Scene, Settled, settling
from granchain_core.execution.stop import Stop
from granchain_core.experiment import (
    Answers,
    Difference,
    Measured,
    Question,
    Series,
    Shaker,
    Unclear,
    answers_of,
    read_data,
)
from granchain_core.experiment.formats import TEXT, format_of
from granchain_core.experiment.reader import TABLE_KINDS
from granchain_core.experiment.sensors import Sensors
from granchain_core.experiment.units import QUANTITIES, UNITS
from granchain_core.inputs.text import number_in
from granchain_core.scene import ASSETS
from granchain_core.scene.refusals import refuse_undriven

from ...format import given_in_words, in_words, signed_in_words
from ...parts.toolkit.component import Component
from ...serve.compiling.compiler import PICTURE_PIECES
from ...serve.computing.worker_pools import ANALYSES, FILES, LONG
from ...serve.http.limits import LARGEST_UPLOAD, MOST_UPLOADED_POINTS
from ...serve.http.message_rules import UPLOAD
from ...session.budget import WHOLE_PICTURE, check_first_picture
from ...session.host import PageHost
from ...session.page import Actions, Page
from ...session.task import Job, Task, report_nothing

if TYPE_CHECKING:
    from granchain_core.fitting.overlay import Overlay

#: The quantities that a column of a curve or of a series may contain.
CHOICES = {"frequency": "frequency", "force": "largest force", "error": "error of the force", "time": "time",
           "input_force": "input force", "output_force": "output force", "velocity": "shaker velocity"}
#: The name of a virtual experiment's data on the page.
VIRTUAL_FILE = "virtual.csv"
#: The length of a virtual experiment in drive periods.
_VIRTUAL_PERIODS = 12
#: Its samples per drive period.
_VIRTUAL_RATE = 256
#: Its noise, as a fraction of the largest output force.
_VIRTUAL_NOISE = 0.02
#: Most rows in the table of differences.
_MOST_ROWS = 100
#: Sample files, computed by granchain with noise; their comments say so.
SAMPLES = ASSETS / "samples"

_TOO_LARGE = (f"The measurement is larger than {LARGEST_UPLOAD / 1e6:g} MB; a curve of frequency and force takes a few "
              "kB.")


class DataPage(Page):
    """The tab that shows how the file was read, the open questions, and the misfit of `Session.measured`."""

    def __init__(self, host: PageHost, tabs: Component) -> None:
        self._host = host
        self._tabs = tabs
        self._moving = Task(host, ANALYSES, report_nothing, "Moving the series to the picture", report_to_host=True)
        self._reading = Task(host, FILES, report_nothing, "Reading the measurement", report_to_host=True,
                             outlives_knobs="a measurement does not depend on the knobs")
        self._recording = Task(host, LONG, report_nothing, "The virtual experiment", report_to_host=True,
                               outlives_knobs="it is made at the knobs' values when it was started")
        self._name, self._answers = "", Answers()
        #: The sensors of a series, whose low-pass is applied to the model's forces.
        self._sensors = Sensors()
        #: The file, for as long as a question about it is open.
        self._content = b""
        self.actions: Actions = {UPLOAD: self._read, "measurement-answer": self._answer,
                                 "measurement-too-large": self._too_large, "measurement-remove": self._remove,
                                 "measurement-sample": self._sample, "measurement-virtual": self._virtual,
                                 "measurement-bandwidth": self._set_bandwidth}

    def picture_ready(self, settled: Settled) -> None:
        """Draw the series over the new picture; a preview has no misfit."""
        series = self._host.session.measured
        if not isinstance(series, Series):
            return
        if settled.final:
            self._moving.start(partial(self._overlay_in_thread, series, settled.run, self._sensors))
        else:
            self._tabs.update_state(misfit=None)

    def _read(self, message: dict[str, Any]) -> None:
        content = _content(message)
        self._recording.cancel()
        self._replace(str(message.get("name", "data"))[:60])
        self._reading.start(partial(self._read_in_thread, content, self._name, self._answers))

    def _replace(self, name: str) -> None:
        """Withdraw a question about earlier data, which new data replace."""
        self._name, self._content, self._answers = name, b"", Answers()
        if self._tabs.state.get("question"):
            self._tabs.update_state(question=None)

    def _answer(self, message: dict[str, Any]) -> None:
        """Read again with the visitor's choices: columns as [quantity, number, unit], and words."""
        columns = message.get("columns", [])
        if not isinstance(columns, list) or not all(isinstance(column, list) and len(column) == 3
                                                    for column in columns):
            raise BadInput("The choice of columns could not be read; choose the file again.")
        words = [f"{str(quantity)[:20]}={str(number)[:6]}:{str(unit)[:30]}" for quantity, number, unit in columns]
        given = answers_of(words, _word(message, "decimal"), None, _word(message, "dataset"))
        if not self._tabs.state.get("question"):
            return  # the question was about data that have since been replaced or removed
        before = self._answers
        self._answers = replace(before, columns=given.columns or before.columns,
                                decimal=given.decimal or before.decimal, dataset=given.dataset or before.dataset)
        self._reading.start(partial(self._read_in_thread, self._content, self._name, self._answers))

    def _read_in_thread(self, content: bytes, name: str, answers: Answers, job: Job) -> None:
        """In a worker thread, read the file. A `BadInput` names the line that cannot be read."""
        try:
            data = _found(content, answers, name)
        except Unclear as unclear:
            job.next_tick(self._ask, content, unclear.question)
            return
        job.next_tick(self._show, data)

    def _ask(self, content: bytes, question: Question) -> None:
        self._content = content
        self._tabs.update_state(question={
            "reason": question.reason, "about": list(question.about), "datasets": list(question.datasets),
            "columns": [[column.number, column.title, column.quantity if column.quantity in CHOICES else "",
                         column.likely_unit]
                        for column in question.columns],
            "rows": [[line, list(fields)] for line, fields in question.rows],
            "quantities": list(CHOICES.items()),
            "units": {name: list(UNITS[QUANTITIES[name]]) for name in CHOICES}})

    def _set_bandwidth(self, message: dict[str, Any]) -> None:
        """Set the bandwidth of the force sensors [Hz], or none if the field is empty, and compare again."""
        given = message.get("value")
        text = given.strip() if isinstance(given, str) else "?"
        value = number_in(text) if text else math.inf
        if value is None:
            raise BadInput(f"The bandwidth {text[:40]!r} is not a number of Hz; leave the field empty if it is not "
                           "known.")
        self._sensors = Sensors(bandwidth=value)
        self._tabs.update_state(bandwidth=text)
        if self._host.session.settled is not None:
            self.picture_ready(self._host.session.settled)

    def _overlay_in_thread(self, series: Series, run: Run, sensors: Sensors, job: Job) -> None:
        """In a worker thread, align the series with the run."""
        from granchain_core.fitting.overlay import overlay  # imported late: only a fit needs it

        job.next_tick(self._show_overlay, overlay(series, run, sensors))

    def _show_overlay(self, overlay: Overlay | None) -> None:
        self._host.show_measured_series(overlay)
        self._tabs.update_state(misfit=None if overlay is None else
                                {"sentence": overlay.sentence, "rows": [], "left": 0})

    def _show(self, measured: Measured | Series) -> None:
        """Draw a measured curve over the resonance curve, or a measured series over the force trains."""
        self._content = b""
        self._host.session.measured = measured
        difference = self._host.show_measured_curve(measured if isinstance(measured, Measured) else None)
        self._host.show_measured_series(None)
        word = measured.word if isinstance(measured, Series) else ""
        self._tabs.update_state(understood=f"{self._name}: {measured.understood}", question=None, series=word,
                                misfit=_misfit(difference))
        settled = self._host.session.settled
        if settled is not None:
            self.picture_ready(settled)

    def curve_compared(self, difference: Difference | None) -> None:
        """Show how a measured curve differs from the curve from rest; None means that a new curve was started."""
        if not isinstance(self._host.session.measured, Series):
            self._tabs.update_state(misfit=_misfit(difference))

    def _sample(self, _: dict[str, Any]) -> None:
        path = SAMPLES / "curve.csv"
        self._tabs.send(type="sample", name=path.name, text=path.read_text(encoding="utf-8"))

    def _virtual(self, _: dict[str, Any]) -> None:
        """Make a series of the present scene with simulated sensors instead of reading a file."""
        refuse_undriven(self._host.session.scene)
        self._reading.cancel()
        self._replace(VIRTUAL_FILE)
        self._recording.start(partial(self._record_in_thread, self._host.session.scene))

    def _record_in_thread(self, scene: Scene, job: Job) -> None:
        from granchain_core.virtual_experiment import virtual_series_csv  # imported late: only a fit needs it

        check_first_picture(scene)
        job.give_way()
        job.compile(scene, *PICTURE_PIECES)
        largest = _settled(scene, job.stop).run.max_output_force
        rate = _VIRTUAL_RATE * scene.f
        sensors = Sensors(noise=_VIRTUAL_NOISE * largest, velocity_noise=_VIRTUAL_NOISE * scene.A0 * scene.f,
                          bandwidth=0.1 * rate, rate=rate)
        content = virtual_series_csv(scene, _VIRTUAL_PERIODS, sensors, stop=job.stop).encode()
        job.next_tick(self._recorded, content)

    def _recorded(self, content: bytes) -> None:
        self._reading.start(partial(self._read_in_thread, content, VIRTUAL_FILE, Answers()))

    def _too_large(self, _: dict[str, Any]) -> None:
        raise BadInput(_TOO_LARGE)

    def _remove(self, _: dict[str, Any]) -> None:
        for task in (self._recording, self._reading, self._moving):
            task.cancel()
        self._content = b""
        self._host.session.measured = None
        self._host.show_measured_curve(None)
        self._host.show_measured_series(None)
        self._sensors = Sensors()
        self._tabs.update_state(understood="", question=None, series="", misfit=None, bandwidth="")


def _settled(scene: Scene, stop: Stop) -> Settled:
    """Return the steady state, whose largest force a virtual experiment needs."""
    began = time.thread_time()
    for settled in settling(scene, stop=stop):
        if time.thread_time() - began > WHOLE_PICTURE and not settled.final:
            raise BadInput(f"After {WHOLE_PICTURE:g} s of computing this chain has not settled, so the virtual "
                           "experiment was not made.")
    return settled


def _content(message: dict[str, Any]) -> bytes:
    """Return the bytes of the file, which the page sends in base64 so that any encoding arrives unchanged."""
    coded = message.get("content")
    try:
        content = base64.b64decode(coded if isinstance(coded, str) else "!", validate=True)
    except (binascii.Error, ValueError):
        raise BadInput("The measurement did not arrive as a file; choose it again.") from None
    if len(content) > LARGEST_UPLOAD:
        raise BadInput(_TOO_LARGE)
    return content


def _found(content: bytes, answers: Answers, name: str) -> Measured | Series:
    """Return the curve or the series in a file. Raise `Unclear` or `BadInput`."""
    data: Measured | Series | Shaker
    try:
        data = read_data(content, answers, TABLE_KINDS, name, LARGEST_UPLOAD, MOST_UPLOADED_POINTS)
    except Unclear:
        if format_of(content) is not TEXT:
            raise
        # read again as a curve only, so that the question is about nothing else
        data = read_data(content, answers, ("curve",), name, LARGEST_UPLOAD, MOST_UPLOADED_POINTS)
    if isinstance(data, Shaker):
        raise BadInput(f"{name} is the shaker's amplitude, but the page draws curves of frequency and force, and "
                       "series of forces; use granchain curve --amplitude FILE.")
    if isinstance(data, Series) and data.input_force is None and data.output_force is None:
        raise BadInput(f"{name} is a time series without a force, but the page draws input and output force.")
    points = len(data.time if isinstance(data, Series) else data.frequency)
    if points > MOST_UPLOADED_POINTS:
        raise BadInput(f"{name} has {points} points, and the page draws up to {MOST_UPLOADED_POINTS}.")
    return data


def _word(message: dict[str, Any], name: str) -> str | None:
    value = message.get(name)
    return value[:200] if isinstance(value, str) and value else None


def _misfit(difference: Difference | None) -> dict[str, Any] | None:
    """Return the misfit for the tab: its sentence and rows of frequency, measured, model, difference."""
    if difference is None:
        return None
    measured = difference.measured
    rows = [[f"{f:g} Hz", given_in_words(float(force), "N"), in_words(float(model), "N"),
             signed_in_words(float(gap), "N")]
            for f, force, model, gap in zip(measured.frequency, measured.force, difference.model, difference.residuals,
                                            strict=True) if not math.isnan(gap)]
    return {"sentence": difference.sentence, "rows": rows[:_MOST_ROWS], "left": max(0, len(rows) - _MOST_ROWS)}
