"""The Accuracy page of one session: when it measures, and whether the rows are still valid."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

from granchain_core import Scene, Settled
from granchain_core.accuracy import NaiveComparison, Row, WorkPrecision, cheapest, work_precision
from granchain_core.kernels.batch_size import machine
from granchain_core.precompile.pieces import ACCURACY_KERNELS, DOP853_KERNELS, FIXED_STEP_KERNELS

from ...format import duration, short_error
from ...plots.accuracy import Annotations
from ...serve.computing.worker_pools import MEASUREMENTS
from ...session.active_setting import PlacedSetting, locate, shown_setting
from ...session.activities import Activity
from ...session.host import PageHost
from ...session.page import Actions, Page
from ...session.progress import Status, StatusWords, activity_state
from ...session.task import Job, Task
from .view import Accuracy, described_methods, described_reference

WORDS = StatusWords("the kernels of all methods", ACCURACY_KERNELS, remaining="the measurements so far")


def measured_for(scene: Scene) -> str:
    """Return the key of a measurement: the scene's digest without the requested accuracy, which affects no row."""
    return scene.evolve(accuracy=1e-6).digest


class AccuracyPage(Page):
    """The page, which runs one measurement at a time in the background until it is done or stopped."""

    def __init__(self, host: PageHost, view: Accuracy) -> None:
        self._host = host
        self._view = view
        self._task = Task(host, MEASUREMENTS, self._show_status, "The measurement")
        self._measured = ""
        self._naive: NaiveComparison | None = None
        self._agreement: float | None = None
        self.rows: list[Row] = []
        self.status: Status = "none"
        self.done = 0.0
        self.actions: Actions = {
            "accuracy-measure": lambda _: self._measure(), "accuracy-stop": lambda _: self.stop(),
        }

    @property
    def running(self) -> bool:
        """Whether a measurement is running or waiting for its turn."""
        return self._task.running

    @property
    def activity(self) -> Activity:
        """Name, state and detail for the list of running computations."""
        words = f"{len(self.rows)} settings measured" if self.rows or self.running else "its page has not been opened"
        return "accuracy of all methods", activity_state(self.running, bool(self.rows)), words

    def scene_changed(self) -> None:
        """Update the page after a knob has moved, which may change the requested accuracy or outdate the rows."""
        if self.status != "none":  # nothing is shown until the page is opened
            self.describe()

    def picture_ready(self, settled: Settled) -> None:
        """Mark the setting of the new picture among the rows."""
        if self.status != "none":
            self.describe()

    def describe(self) -> None:
        """Show the requested accuracy, the cheapest row, the present setting, and whether the rows are still valid."""
        scene, session = self._host.session.scene, self._host.session
        now = locate(shown_setting(scene, session.settled, session.mode == "live"), self.rows)
        best = cheapest(self.rows, scene.accuracy)
        stale = bool(self._measured) and self._measured != measured_for(scene)
        self._view.mark(self.rows, Annotations(
            scene.accuracy, self._agreement, None if best is None else (best.wall_s, best.error),
            None if now is None else (now.wall_s, now.error)), stale=stale, sentence=self._sentence(best),
                        used=self._used(now))

    def stop(self) -> None:
        """Stop measuring; the rows measured so far stay."""
        if self._task.cancel():
            self._show_status("stopped")

    def visibility_changed(self, visible: bool) -> None:
        """When the page or its tab is opened, measure if nothing has been measured yet."""
        if not visible:
            return
        self._view.update_state(ways=described_methods(), machine=machine())
        if self.status == "none":
            self._measure()
        self.describe()

    def _measure(self) -> None:
        self._task.cancel()
        scene = self._host.session.scene
        self._measured, self.rows, self._naive, self.done = measured_for(scene), [], None, 0.0
        self._agreement = None
        self._view.forget()
        self._show_status("waiting")
        self.describe()
        self._task.start(partial(self._work, scene))

    def _work(self, scene: Scene, job: Job) -> None:
        """In the measuring thread: load the kernels, then measure one row after another."""

        def report(result: WorkPrecision) -> None:
            job.next_tick(self._show, list(result.rows), result.naive, described_reference(result), result.agreement)

        job.compile(scene, FIXED_STEP_KERNELS, DOP853_KERNELS, ACCURACY_KERNELS)
        job.report("measuring")
        work_precision(scene, job.stop, report=report, pause=job.give_way,
                       progress=lambda done: job.next_tick(self._progress, done))

    def _show(self, rows: list[Row], naive: NaiveComparison | None, reference: dict[str, Any],
              agreement: float) -> None:
        self.rows = rows
        self._agreement = agreement if math.isfinite(agreement) else None
        self._view.measured(rows, reference)
        if naive is not None and self._naive is None:
            self._naive = naive
            self._view.show_naive(naive)
        self.describe()

    def _progress(self, done: float) -> None:
        self.done = done
        self._view.update_state(done=done)

    def _show_status(self, status: Status, sentence: str = "") -> None:
        self.status = status
        self._view.update_state(**WORDS.of(status, sentence), done=self.done)

    def _used(self, now: PlacedSetting | None) -> str:
        """Say which setting the page uses, and why the status line shows another error."""
        settled = self._host.session.settled
        if now is None:
            return ""
        words = f"This page uses {now.method}, {now.label}: error {short_error(now.error)} against the reference"
        if settled is None or settled.run.displacement_error is None:
            return f"{words}."
        stated = settled.run.displacement_error
        side = " on the safe side" if stated >= now.error else ""
        return f"{words}; the status line has no reference and states an estimate{side}, {short_error(stated)}."

    def _sentence(self, best: Row | None) -> str:
        accuracy = short_error(self._host.session.scene.accuracy)
        if best is not None:
            return (f"The cheapest way to {accuracy} is {best.method}, {best.setting}: {duration(best.wall_s)}, "
                    f"error {short_error(best.error)}.")
        if not self.rows:
            return ""
        nearest = min(self.rows, key=lambda row: row.error)
        return f"Nothing measured here reaches {accuracy}; the nearest is {nearest.method}, {nearest.setting}."
