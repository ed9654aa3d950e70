"""Pinned motions: their lines in the force trains and on the curve, and their numbers."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

from granchain_core import BadInput, CurvePoint, Run, Scene, Settled, settle

from ..curve.computation import CurveComputation, Progress
from ..frames import samples_for
from ..parts.time_figures.pinned_trains import SIGNS
from ..serve.compiling.compiler import PICTURE_PIECES
from ..serve.computing.worker_pools import ANALYSES, CURVES
from ..session.budget import check_first_picture, curve_affordable
from ..session.host import PageHost
from ..session.initial_state import MOST_BEADS_IN_LINK
from ..session.message_checks import check_index
from ..session.page import Actions
from ..session.pins import NAMES, Pin, compared_rows, setting_words
from ..session.scene_facts import without_frequency
from ..session.task import Job, Task, report_nothing
from .layout import Views


class Pinned:
    """The pins of one session, and their actions in the tab “numbers”.

    A pin is a scene and an initial state, so it fits into a link; its motion is computed again from these.
    """

    def __init__(self, host: PageHost, views: Views) -> None:
        self._host = host
        self._session = host.session
        self._views = views
        self._runs: dict[str, Run] = {}
        self._curves: dict[Scene, list[CurvePoint]] = {}
        self._task = Task(host, ANALYSES, report_nothing, "The pinned picture", report_to_host=True)
        self._curve_task = Task(host, CURVES, report_nothing, "The curve of a pinned picture", report_to_host=True)
        self.actions: Actions = {"pin": lambda _: self._add(), "unpin": self._remove, "pin-open": self._open}

    def show(self) -> None:
        """Draw the session's pins, and compute the motions that are missing."""
        pins = self._session.pins
        self._runs = {name: run for name, run in self._runs.items() if name in map(_key, pins)}
        missing = [pin for pin in pins if _key(pin) not in self._runs]
        if missing:
            self._task.start(partial(self._settle, missing))
        else:
            self._task.cancel()
        self._draw()
        self.scene_changed()

    def scene_changed(self) -> None:
        """Draw the curve of each pin that differs from the present curve, because knobs have moved."""
        others = self._other_curves()
        missing = [key for key in others if key and key not in self._curves and curve_affordable(key)]
        if missing:
            self._curve_task.start(partial(self._compute_curves, missing))
        elif self._session.pins:
            self._curve_task.cancel()
        self._views.curve.pinned_curves([self._curves.get(key, []) if key else [] for key in others])

    def picture_ready(self, settled: Settled) -> None:
        """Compare the pins with a new picture."""
        if self._session.pins and settled.final:
            self._show()

    # Actions of the visitor

    def _add(self) -> None:
        session = self._session
        if session.mode != "settled" or session.settled is None:
            raise BadInput("Only a settled picture can be pinned: a live run keeps changing. Choose “settled” first.")
        if len(session.pins) == len(NAMES):
            raise BadInput(f"{len(NAMES)} pictures are pinned already; remove one of them in the tab “numbers” first.")
        settled = session.settled
        if settled.run.scene != session.scene:  # the start of the motion is not known yet
            raise BadInput("The picture of these knobs is still being computed; pin it when it is shown.")
        pin = Pin(session.scene, session.initial_state)
        if settled.final:
            self._runs[_key(pin)] = settled.run
        if self._views.curve.rest_complete:
            self._curves[without_frequency(session.scene)] = self._views.curve.points("rest")
        session.pins = (*session.pins, pin)
        self._changed()
        if sentence := session.pins_left_out:
            raise BadInput(sentence)

    def _remove(self, message: dict[str, Any]) -> None:
        gone = check_index("pin", self._session.pins, message.get("number"))
        self._session.pins = tuple(pin for pin in self._session.pins if pin is not gone)
        self._changed()

    def _open(self, message: dict[str, Any]) -> None:
        pin = check_index("pin", self._session.pins, message.get("number"))
        self._host.open_scene(pin.scene, pin.initial_state, "")

    def _changed(self) -> None:
        self.show()
        self._host.address_changed()

    # In a worker thread

    def _settle(self, missing: Sequence[Pin], job: Job) -> None:
        for pin in missing:
            check_first_picture(pin.scene)
            job.give_way()
            job.compile(pin.scene, *PICTURE_PIECES)
            settled = settle(pin.scene, start=pin.initial_state, samples=samples_for(pin.scene), stop=job.stop)
            job.next_tick(self._settled, pin, settled.run)

    def _compute_curves(self, missing: Sequence[Scene], job: Job) -> None:
        """Compute the curves of pins, once the present curve is done."""
        for key in missing:
            job.compile(key, *PICTURE_PIECES)
            job.give_way(lambda: self._host.busy or self._host.curve_computing)
            parts: list[Progress] = []
            CurveComputation(key, ["rest"], parts.append, lambda: self._host.busy)(job)
            job.next_tick(self._swept, key, [point for progress in parts for point in progress.points])

    # To the browser

    def _settled(self, pin: Pin, run: Run) -> None:
        self._runs[_key(pin)] = run
        self._draw()

    def _swept(self, key: Scene, points: list[CurvePoint]) -> None:
        self._curves[key] = sorted(points, key=lambda point: point.frequency)
        self.scene_changed()

    def _other_curves(self) -> list[Scene | None]:
        """Return the scene of each pin's curve; None if it is the present curve."""
        self._curves = {key: points for key, points in self._curves.items()
                        if key in [without_frequency(pin.scene) for pin in self._session.pins]}
        now = without_frequency(self._session.scene)
        keys = [without_frequency(pin.scene) for pin in self._session.pins]
        return [None if key == now else key for key in keys]

    def _found(self) -> list[Run | None]:
        return [self._runs.get(_key(pin)) for pin in self._session.pins]

    def _draw(self) -> None:
        runs = self._found()
        self._views.trains.pin(runs)
        self._views.curve.pin([(name, run.scene.f, run.max_output_force)
                               for name, run in zip(NAMES, runs, strict=False) if run is not None])
        self._show()

    def _show(self) -> None:
        session = self._session
        settled = session.settled
        self._views.tabs.send(
            type="compare", now=setting_words(session.scene, session.scene),
            pins=[{"name": name, "sign": sign, "words": setting_words(pin.scene, session.scene),
                   "known": _key(pin) in self._runs}
                  for name, sign, pin in zip(NAMES, SIGNS, session.pins, strict=False)],
            full=len(session.pins) == len(NAMES),
            rows=[] if settled is None else compared_rows(settled.run, self._found()))


def _key(pin: Pin) -> str:
    """Return the key of a pin: its link, plus the identity of an initial state that is too long for a link."""
    short = pin.initial_state is None or len(pin.initial_state.displacement) <= MOST_BEADS_IN_LINK
    return pin.text if short else f"{pin.text} {id(pin.initial_state)}"
