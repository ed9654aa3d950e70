"""The Accuracy page of one visitor: when it measures, what of it is still true, and what it says."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from panel.io import unlocked

from granchain_core import BadInput, Cancelled, NumbersFailed, Scene
from granchain_core.accuracy import Lesson, Row, WorkPrecision, cheapest, work_precision
from granchain_core.accuracy.compiled import METHODS_PIECE
from granchain_core.integrate.engine import new_stop

from ...page.active_setting import locate, page_setting
from ...page.background import Background
from ...page.format import duration, short_error
from ...serve.compiler import CERTIFIED, LIVE
from ...serve.queues import MEASUREMENTS, Stop
from .view import described_reference, described_rows, described_ways, lesson_message

if TYPE_CHECKING:
    from ...page.controller import Controller

_PATIENCE = 0.01
"""Seconds between looks whether the picture in front is done; nothing is measured while a knob moves."""


def measured_for(scene: Scene) -> str:
    """What a measurement belongs to: the scene without the accuracy asked for, which measures nothing anew."""
    return scene.evolve(accuracy=1e-6).digest


class AccuracyPage(Background):
    """One measurement at a time; it goes on in the background until it is done, cancelled or the visitor leaves."""

    def __init__(self, page: Controller) -> None:
        self._page = page
        self._view = page.views.accuracy
        self._stop: Stop = new_stop()
        self._measured = ""
        self._lesson: Lesson | None = None
        self.rows: list[Row] = []
        self.status = "none"
        self.done = 0.0
        self.actions: dict[str, Callable[[dict[str, Any]], None]] = {
            "accuracy-open": lambda _: self.open(), "accuracy-measure": lambda _: self._measure(),
            "accuracy-cancel": lambda _: self.cancel(),
        }

    @property
    def running(self) -> bool:
        """Whether a measurement is under way or waits for its turn."""
        return self.status in ("waiting", "compiling", "measuring")

    @property
    def progress_words(self) -> str:
        """How far the measurement is."""
        return f"{len(self.rows)} settings measured" if self.rows or self.running else "its page was not opened yet"

    def describe(self) -> None:
        """Tell what follows from the knobs and the picture: asked, cheapest, now, and whether the rows still hold."""
        scene, session = self._page.session.scene, self._page.session
        now = locate(page_setting(scene, session.picture, session.mode == "live"), self.rows)
        best = cheapest(self.rows, scene.accuracy)
        stale = bool(self._measured) and self._measured != measured_for(scene)
        self._view.tell(
            type="asked", asked=scene.accuracy, asked_words=short_error(scene.accuracy), stale=stale,
            cheapest=None if best is None else self.rows.index(best), sentence=self._sentence(best),
            now=None if now is None else {"way": now.method, "setting": now.label, "error": now.error,
                                          "ms": 1e3 * now.wall_s})

    def cancel(self) -> None:
        """Stop; the rows that are there stay."""
        self._stop[0] = 1
        if self.running:
            self._say("cancelled")

    def close(self) -> None:
        """The visitor left."""
        self._stop[0] = 1

    def open(self) -> None:
        """The page or its small version came on the screen: what was never measured is measured now."""
        self._view.display(ways=described_ways())
        if self.status == "none":
            self._measure()
        self.describe()

    def _measure(self) -> None:
        self._stop[0] = 1
        self._stop = stop = new_stop()
        scene = self._page.session.scene
        self._measured, self.rows, self._lesson, self.done = measured_for(scene), [], None, 0.0
        self._view.display(rows=[], agreement=None, agreement_words="", reference="", second="")
        self._view.tell(type="no-lesson")
        self._say("waiting")
        self.describe()
        MEASUREMENTS.submit(self._work, scene, stop)

    def _work(self, scene: Scene, stop: Stop) -> None:
        """In the measuring thread: the kernels first, then one row after the other."""
        try:
            if not self._compiled(scene, (LIVE, CERTIFIED, METHODS_PIECE), stop, self._say):
                return
            self._later(stop, self._say, "measuring")
            work_precision(scene, stop, report=lambda found: self._report(found, stop), pause=lambda: self._pause(stop),
                           progress=lambda done: self._later(stop, self._progress, done))
            self._later(stop, self._say, "done")
        except Cancelled:
            pass
        except (NumbersFailed, BadInput) as problem:
            self._later(stop, self._say, "failed", str(problem))
        except Exception as error:
            self._later(stop, self._say, "failed", "The measurement stopped by a fault inside granchain.")
            self._page.later(self._page.failed, error)

    def _pause(self, stop: Stop) -> None:
        while self._page.unsettled and not stop[0]:
            time.sleep(_PATIENCE)

    def _report(self, found: WorkPrecision, stop: Stop) -> None:
        self._later(stop, self._show, list(found.rows), found.lesson, described_reference(found))

    def _show(self, rows: list[Row], lesson: Lesson | None, reference: dict[str, Any]) -> None:
        self.rows = rows
        with unlocked():
            self._view.display(rows=described_rows(rows), **reference)
            if lesson is not None and self._lesson is None:
                self._lesson = lesson
                self._view.tell(**lesson_message(lesson))
            self.describe()

    def _progress(self, done: float) -> None:
        self.done = done
        self._view.display(done=done)

    def _say(self, status: str, sentence: str = "") -> None:
        self.status = status
        self._view.display(status=status, failure=sentence, done=self.done)

    def _sentence(self, best: Row | None) -> str:
        asked = short_error(self._page.session.scene.accuracy)
        if best is not None:
            return (f"The cheapest way to {asked} is {best.method}, {best.setting}: {duration(best.wall_s)}, "
                    f"error {short_error(best.error)}.")
        if not self.rows:
            return ""
        nearest = min(self.rows, key=lambda row: row.error)
        return f"Nothing measured here reaches {asked}; the nearest is {nearest.method}, {nearest.setting}."
