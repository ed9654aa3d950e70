"""A page of the table on a host without a browser; its work is kept until the test computes it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any

from host import FakeHost

import granchain_core
from app.dashboard.table import PageSpec, overlay_names
from app.dashboard.tabs import Tabs
from app.serve.compiling.compiler import COMPILER
from app.serve.computing.worker_pools import WorkerPool
from app.session.activities import Activity
from app.session.page import Page
from app.session.session import Session
from app.session.task import Job, Task
from granchain_core import Scene, Settled, State, scene
from granchain_core.experiment import Difference, Measured
from granchain_core.fitting.overlay import Overlay


@cache
def picture(f: float = 2000.0) -> Settled:
    """Return a settled picture of a short chain, final for its knobs."""
    return granchain_core.settle(scene("sec2").evolve(N=2, f=f), samples=8)


class FakePageHost(FakeHost):
    """The host of one page: one visitor's session, and the page's requests to the dashboard."""

    overlays = overlay_names()

    def __init__(self) -> None:
        super().__init__()
        self.session = Session(scene=picture().run.scene)
        #: Requests to show a motion: the scene, its initial state, and mode or curves.
        self.shown: list[tuple[Scene, State | None, str]] = []
        self.addresses = 0

    def activities(self) -> list[Activity]:
        return []

    def turn_knobs(self, scene: Scene, state: State | None = None, mode: str = "settled") -> None:
        self.shown.append((scene, state, mode))

    def open_scene(self, scene: Scene, state: State | None, curves: str) -> None:
        self.shown.append((scene, state, curves))

    def show_measured_curve(self, measured: Measured | None) -> Difference | None:
        return None

    def show_measured_series(self, overlay: Overlay | None) -> None:
        pass

    def address_changed(self) -> None:
        self.addresses += 1


@dataclass(frozen=True)
class Submitted:
    """Work that a task submitted to a worker pool."""

    pool: str
    run: Callable[[Callable[[Job], None], Job], None]
    work: Callable[[Job], None]
    job: Job

    @property
    def task(self) -> Task:
        """The task that submitted it."""
        task = self.run.__self__  # type: ignore[attr-defined]
        assert isinstance(task, Task)
        return task


class PageUnderTest:
    """A page with its view, without a browser."""

    def __init__(self, row: PageSpec, monkeypatch: Any) -> None:
        self.row = row
        self.host = FakePageHost()
        self.view = (row.view or Tabs)()
        self.sent: list[dict[str, Any]] = []
        self.submitted: list[Submitted] = []
        monkeypatch.setattr(self.view, "send", lambda **message: self.sent.append(message))
        monkeypatch.setattr(WorkerPool, "submit", lambda pool, run, work, job, owner=None: self.submitted.append(
            Submitted(pool.name, run, work, job)))
        for name in ("has", "await_piece", "load"):
            monkeypatch.setattr(COMPILER, name, lambda *_: True)
        self.page: Page = row.page(self.host, self.view)

    @property
    def activity(self) -> Activity:
        """The page's line in the list of running computations, which must exist."""
        activity = self.page.activity
        assert activity is not None
        return activity

    def do(self, action: str, /, **message: Any) -> None:
        """Request an action as the visitor."""
        self.page.actions[action]({"do": action, **message})

    def set_visible(self, visible: bool = True) -> None:
        """Show or hide the page."""
        self.page.visibility_changed(visible)

    def deliver_picture(self, new: Settled | None = None) -> None:
        """Deliver the picture of the current knobs."""
        self.host.session.settled = new or picture()
        self.page.picture_ready(self.host.session.settled)
        self.host.call_waiting()

    def move_knobs(self, **knobs: float) -> None:
        """Move knobs as the visitor; the dashboard calls its pages in this order."""
        self.page.picture_requested()
        self.host.session.scene = self.host.session.scene.evolve(**knobs)
        self.page.scene_changed()

    def run_callbacks(self) -> None:
        """Let time pass: run waiting callbacks and those that they request, but not endless repetitions."""
        for _ in range(4):
            self.host.call_waiting()

    def compute(self, work: Callable[[Job], None] | None = None) -> None:
        """Compute submitted work that was not cancelled, or `work` instead of it, and deliver the results."""
        runs, self.submitted = self.submitted, []
        for submitted in runs:
            submitted.run(work or submitted.work, submitted.job)
        self.run_callbacks()

    @property
    def under_way(self) -> list[Submitted]:
        """Work that was submitted to a worker pool and neither computed nor cancelled."""
        return [submitted for submitted in self.submitted if not submitted.job.stop]

    @property
    def state(self) -> dict[str, Any]:
        """The state of the view."""
        return dict(self.view.state)

    def messages(self, kind: str) -> list[dict[str, Any]]:
        """Return the messages of a type that were sent to the browser."""
        return [message for message in self.sent if message.get("type") == kind]

    def last(self, kind: str) -> dict[str, Any]:
        """Return the last message of a type that was sent to the browser."""
        return self.messages(kind)[-1]

    @property
    def statuses(self) -> set[str]:
        """The statuses of computations that the page shows or has shown (`StatusWords.of`)."""
        return set(self._entries("status"))

    @property
    def sentences(self) -> list[str]:
        """Sentences about failures, from the page or left to the dashboard; a row of effects has its own in `state`."""
        rows = (state for state in self._entries("state") if isinstance(state, str))
        return [*self._entries("failure"), *rows, *map(str, self.host.failures), *(sentence for _, sentence in self.host.faults)]

    @property
    def is_stale(self) -> bool:
        """Whether the page marks its contents as out of date."""
        return any(self._entries("stale"))

    def _entries(self, name: str) -> Iterator[Any]:
        """Yield the values with this name in the state and in the messages, at any depth."""
        waiting: list[Any] = [self.state, *self.sent]
        while waiting:
            value = waiting.pop()
            if isinstance(value, dict):
                yield from (inner for key, inner in value.items() if key == name)
                waiting.extend(value.values())
            elif isinstance(value, (list, tuple)):
                waiting.extend(value)
