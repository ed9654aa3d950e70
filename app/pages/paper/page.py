"""The page "The paper" of one session: it computes a chosen figure to its end.

The computation continues while the page is closed. Only "stop", another figure or the end of the session ends it.
"""

from __future__ import annotations

from typing import Any

from granchain_core import scene
from granchain_core.paper import PaperFigure, Result, compute, figure_of
from granchain_core.precompile.pieces import CURVE_KERNELS, MOTION_KERNELS, OBSERVER_KERNELS, ORBIT_KERNELS

from ...serve.computing.worker_pools import LONG
from ...session.host import PageHost
from ...session.page import Actions, Page
from ...session.progress import Status, StatusWords
from ...session.task import Job, Task
from .view import Paper

_TRAINS = (("rig", MOTION_KERNELS),)
_FED = (("rig", (*MOTION_KERNELS, CURVE_KERNELS, ORBIT_KERNELS, OBSERVER_KERNELS)),)
#: The kernels of each figure: presets, and pieces of their structures. Figures without an entry need none.
_KERNELS: dict[str, tuple[tuple[str, tuple[str, ...]], ...]] = {
    "2": (("sec2", (*MOTION_KERNELS, CURVE_KERNELS)),), **dict.fromkeys(("3", "3a", "3b"), (("sec2", MOTION_KERNELS),)),
    "6": (("rig", (*MOTION_KERNELS, CURVE_KERNELS)),), "7": _TRAINS, "9": _FED, "10": _FED, "12": _TRAINS,
    "11": tuple((name, (*MOTION_KERNELS, ORBIT_KERNELS, OBSERVER_KERNELS)) for name in ("fig11-free", "fig11-founded")),
}
#: The figure that the page shows first: the resonance curve of section 2, which takes a second.
_FIRST_FIGURE = "2"

WORDS = StatusWords("the figure's kernels", ORBIT_KERNELS)


class PaperPage(Page):
    """The page, which keeps all computed figures until the session ends."""

    def __init__(self, host: PageHost, view: Paper) -> None:
        self._view = view
        self._task = Task(host, LONG, self._show_status, "The figure", outlives_knobs="it has scenes of its own")
        self._found: dict[str, Result] = {}
        self._chosen = False
        self.actions: Actions = {"paper-show": self._show, "paper-stop": lambda _: self._stop()}

    def visibility_changed(self, visible: bool) -> None:
        """Show the first figure when the page is opened for the first time, rather than none."""
        if visible and not self._chosen:
            self._show({"figure": _FIRST_FIGURE})

    def _stop(self) -> None:
        if self._task.cancel():
            self._show_status("stopped")

    def _show(self, message: dict[str, Any]) -> None:
        figure = figure_of(str(message.get("figure")))
        self._task.cancel()
        self._chosen = True
        self._view.choose(figure)
        if figure.number in self._found:
            self._show_status("done")
            self._view.draw(figure, self._found[figure.number])
            return
        self._show_status("waiting")
        self._task.start(lambda job: self._compute(figure, job))

    def _compute(self, figure: PaperFigure, job: Job) -> None:
        """Compute the figure in a thread of the pool `LONG`."""
        for name, pieces in _KERNELS.get(figure.number, ()):
            job.compile(scene(name), *pieces)
        job.report("computing")
        progress = job.progress(lambda done: self._view.update_state(done=done))
        job.next_tick(self._arrived, figure, compute(figure.number, stop=job.stop, progress=progress))

    def _arrived(self, figure: PaperFigure, result: Result) -> None:
        self._found[figure.number] = result
        self._view.draw(figure, result)

    def _show_status(self, status: Status, sentence: str = "") -> None:
        if status == "waiting":
            self._view.update_state(done=0.0)
        self._view.update_state(**WORDS.of(status, sentence))
