"""The Observer page of one visitor: computes while it is looked at, one drive period for each the browser has shown."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

from granchain_core import Scene, Settled
from granchain_core.observe.compiled import OBSERVER_PIECE
from granchain_core.pieces import compile_piece

from ...serve.compiler import CERTIFIED, COMPILER
from ...serve.queues import LatestWins, Stop
from .view import step_message
from .work import ObserverRun, Step

if TYPE_CHECKING:
    from ...page.controller import Controller

_COMPILING = "Compiling the observer's kernels: some 10 s, only the first time on this computer."


@dataclass(frozen=True)
class _Moved:
    """A step of a run, and whether the run began with it."""

    run: ObserverRun
    step: Step
    began: bool


class ObserverPage:
    """Each message "observer-more" asks for one period; without them nothing is computed."""

    def __init__(self, page: Controller) -> None:
        self._page = page
        self._view = page.views.observer
        self._jobs = LatestWins(partial(page.later, self._show), partial(page.later, page.failed))
        self._run: ObserverRun | None = None
        self._loaded: set[str] = set()
        self._wishes: list[str] = []
        self.actions: dict[str, Callable[[dict[str, Any]], None]] = {
            "observer-more": lambda _: self._more(),
            "observer-nudge": lambda _: self._wish("nudge"), "observer-rest": lambda _: self._wish("rest"),
            "observer-again": lambda _: self._wish("again"),
        }

    def changed(self) -> None:
        """A knob moved: the control on the page follows, and the next period is the new chain's."""
        scene = self._page.session.scene
        self._view.display(kappa=scene.kappa)
        if self._run is not None and self._run.scene.digest != scene.digest:
            self._view.display(sentence="", predicted=None, measured=None)

    def close(self) -> None:
        """The visitor left."""
        self._jobs.close()

    def _wish(self, name: str) -> None:
        self._wishes.append(name)
        self._more()

    def _more(self) -> None:
        self._jobs.submit(partial(self._work, self._page.session.scene, self._page.session.picture))

    def _work(self, scene: Scene, picture: Settled | None, stop: Stop) -> Iterator[_Moved]:
        """In a worker thread: one period more of this scene's run."""
        if not self._ready(scene, stop):
            return
        mine = picture if picture is not None and picture.run.scene.digest == scene.digest else None
        run, began = self._run, False
        wishes, self._wishes = self._wishes, []
        if run is None or run.scene.digest != scene.digest or "again" in wishes:
            run, began = ObserverRun(scene, mine, stop, None if "again" in wishes else run), True
        run.pair.engine.stop = stop
        if run.orbit is None and not run.failure and mine is not None and mine.final \
                and mine.regime.period is not None:
            run.predict(mine)
        for wish in wishes:
            if wish != "again":
                began = True
                (run.nudge if wish == "nudge" else run.from_rest)()
        self._run = run
        if not run.in_step or began:
            yield _Moved(run, run.step(), began)

    def _ready(self, scene: Scene, stop: Stop) -> bool:
        for piece in (CERTIFIED, OBSERVER_PIECE):
            if not COMPILER.has(scene, piece):
                self._page.later(partial(self._view.display, status=_COMPILING))
            if not COMPILER.await_piece(scene, piece, stop):
                return False
        key = f"{scene.effects}{scene.N}"
        if key not in self._loaded:
            compile_piece(scene, OBSERVER_PIECE)
            self._loaded.add(key)
        return True

    def _show(self, moved: object) -> None:
        assert isinstance(moved, _Moved)
        run = moved.run
        mu = run.leading
        self._view.display(
            status="", sentence=run.sentence, predicted=run.predicted, measured=run.measured, since=run.since,
            mu=None if mu is None else [mu.real, mu.imag], period=None if run.orbit is None else run.orbit.period,
            broken=run.broken, in_step=run.in_step)
        self._view.tell(**step_message(moved.step, run.scene, moved.began))
