"""The Observer page of one session: it computes a drive period for each period that the browser has shown."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

from granchain_core import Scene, Settled
from granchain_core.precompile.pieces import DOP853_KERNELS, OBSERVER_KERNELS

from ...serve.computing.worker_pools import PICTURES
from ...session.host import PageHost
from ...session.page import Actions, Page
from ...session.progress import Status, StatusWords
from ...session.task import Job, Task
from .view import Observer
from .work import ObserverRun, ObserverStep

WORDS = StatusWords("the observer's kernels", OBSERVER_KERNELS)


@dataclass(frozen=True)
class _Moved:
    """A step of a run, and whether the run started with it."""

    run: ObserverRun
    step: ObserverStep
    began: bool


class ObserverPage(Page):
    """The page; each message "observer-more" asks for one period, and nothing is computed without a message."""

    def __init__(self, host: PageHost, view: Observer) -> None:
        self._host = host
        self._view = view
        self._task = Task(host, PICTURES, self._said, "The observer", report_to_host=True,
                          outlives_knobs="the running period is the old chain's last, the next is the new chain's")
        self._run: ObserverRun | None = None
        self._asked = False
        self._requests: list[str] = []
        self.actions: Actions = {
            "observer-more": lambda _: self._more(),
            "observer-nudge": lambda _: self._request("nudge"), "observer-rest": lambda _: self._request("rest"),
            "observer-again": lambda _: self._request("again"),
        }

    def scene_changed(self) -> None:
        """Update the page's control after a knob has moved; the next period is the new chain's."""
        scene = self._host.session.scene
        self._view.update_state(kappa=scene.kappa)
        if self._run is not None and self._run.scene.digest != scene.digest:
            self._view.update_state(sentence="", failure="", predicted=None, measured=None)

    def _request(self, name: str) -> None:
        self._requests.append(name)
        self._more()

    def _more(self) -> None:
        if self._task.running:
            self._asked = True
            return
        self._asked = False
        session = self._host.session
        requests, self._requests = self._requests, []
        self._task.start(partial(self._next_in_thread, session.scene, session.settled, self._run, requests))

    def _said(self, status: Status, sentence: str) -> None:
        if status in ("compiling", "failed"):
            self._view.update_state(**WORDS.of(status, sentence))
        elif self._asked:
            self._more()

    def _next_in_thread(self, scene: Scene, settled: Settled | None, run: ObserverRun | None, requests: list[str],
                        job: Job) -> None:
        """In a worker thread, compute one more period of this scene; `run` has the periods so far."""
        job.compile(scene, DOP853_KERNELS, OBSERVER_KERNELS)
        mine = settled if settled is not None and settled.run.scene.digest == scene.digest else None
        began = False
        if run is None or run.scene.digest != scene.digest or "again" in requests:
            run, began = ObserverRun(scene, mine, job.stop, None if "again" in requests else run), True
        run.pair.engine.stop = job.stop
        if run.orbit is None and not run.failure and mine is not None and mine.final \
                and mine.regime.period is not None:
            run.predict(mine)
        for request in requests:
            if request != "again":
                began = True
                (run.nudge if request == "nudge" else run.from_rest)()
        if not run.in_step or began:
            job.next_tick(self._show, _Moved(run, run.step(), began))

    def _show(self, moved: _Moved) -> None:
        self._run = run = moved.run
        self._view.update_state(**WORDS.of("done"), sentence=run.sentence, predicted=run.predicted,
                                measured=run.measured)
        self._view.step(moved.step, run.scene, moved.began, run.since, run.predicted)
