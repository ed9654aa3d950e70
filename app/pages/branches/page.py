"""The Branches page of one session: it continues the orbit on the screen in frequency, and loads orbits it found."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from granchain_core import Scene, Settled
from granchain_core.execution.stop import Stop
from granchain_core.orbits import Branch, Continuation, HalfBranch, begin_branch, switch_to_doubled
from granchain_core.precompile.pieces import BRANCH_KERNELS, DOP853_KERNELS, FIXED_STEP_KERNELS

from ...plots.branches import BranchRows
from ...serve.computing.worker_pools import LONG
from ...session.budget import curve_affordable
from ...session.host import PageHost
from ...session.message_checks import check_index, check_integer
from ...session.page import Actions, Page
from ...session.progress import Status, StatusWords
from ...session.scene_facts import slider_range, without_frequency
from ...session.task import Job, Task
from .view import LONGEST_BRANCH_PERIOD, Branches

#: Time between two messages while a branch grows [s].
_MESSAGE_EVERY = 0.08

WORDS = StatusWords("the kernels for branches", BRANCH_KERNELS, remaining="the orbits found so far")
NOT_PERIODIC = ("The motion on the screen does not repeat, so it is on no branch. Choose a period to follow an orbit "
                "of that period near it.")


@dataclass
class _Drawn:
    """A half-branch, and how many of its points and special points have been sent to the page."""

    branch: Branch
    half: HalfBranch
    points: int = 0
    special: int = 0


class BranchesPage(Page):
    """Branches of one chain: the first from the orbit on the screen, others from its period doublings."""

    def __init__(self, host: PageHost, view: Branches) -> None:
        self._host = host
        self._view = view
        self._task = Task(host, LONG, self._show_status, "Following the branch",
                          outlives_knobs="it covers all f")
        self._followed: list[Continuation] = []
        self._drawn: list[_Drawn] = []
        self._special: list[tuple[Branch, Any]] = []
        self._rows = BranchRows()
        self._scene: Scene | None = None
        self._begun = self._waits = False
        self.status: Status = "none"
        self.actions: Actions = {
            "branches-open": lambda _: self._opened(), "branches-start": self._start,
            "branches-stop": lambda _: self.stop(), "branches-continue": lambda _: self._continue(),
            "branches-orbit": self._load_orbit, "branches-double": self._double,
        }

    def scene_changed(self) -> None:
        """Show whether the branches are still those of the present chain; remove an outdated curve without branches."""
        now = self._host.session.scene
        stale = self._scene is not None and without_frequency(self._scene) != without_frequency(now)
        if stale and not self._followed and not self._task.running:
            self._clear()
            stale = False
        if self._begun or self._waits:
            self._view.update_state(now=now.f, stale=stale)

    def picture_ready(self, settled: Settled) -> None:
        """Follow the orbit if the page was opened before the motion had settled."""
        if self._waits and settled.final:
            self._begin()

    def curve_ready(self) -> None:
        """Draw the curve behind the branches, if the page has been opened."""
        if self._begun or self._waits:
            self._draw_curve()

    def stop(self) -> None:
        """Stop; the points computed so far stay, and can be continued later."""
        if self._task.cancel():
            self._show_status("stopped")

    # The visitor's actions

    def _opened(self) -> None:
        """Follow the orbit on the screen when the page is opened for the first time."""
        self._draw_curve()
        if self._begun:
            return
        if self._host.awaiting_picture or self._host.session.settled is None:
            self._waits = True
        else:
            self._begin()

    def _begin(self) -> None:
        """Follow the orbit on the screen, if there is one and its branch may be computed without a request."""
        self._begun, self._waits = True, False
        scene, settled = self._host.session.scene, self._host.session.settled
        if settled is None or not scene.is_driven or not curve_affordable(scene):
            return
        if settled.regime.period:
            self._start({})
        else:
            self._view.update_state(words=NOT_PERIODIC)

    def _start(self, message: dict[str, Any]) -> None:
        period = message.get("period")
        if period is not None:
            period = check_integer("period of a branch", period, 1, LONGEST_BRANCH_PERIOD)
        scene, settled = self._host.session.scene, self._host.session.settled
        low, high = slider_range(scene, "f")
        axis = min(low, scene.f), max(high, scene.f)
        self._begun, self._waits, seed = True, False, None
        if settled is not None and settled.final and settled.run.scene == scene and settled.regime.period \
                and period in (None, settled.regime.period):
            seed, period = settled.state, settled.regime.period
        self._clear()
        self._submit(lambda stop: [begin_branch(scene, "f", *axis, period, seed, both=True, stop=stop)], scene)

    def _continue(self) -> None:
        if self._followed and self._scene is not None and not self._task.running:
            scene = self._scene
            left = [followed.branch for followed in self._followed]
            self._clear()
            self._submit(lambda stop: left, scene)

    def _double(self, message: dict[str, Any]) -> None:
        if self._task.running:
            return
        branch, special = check_index("special point", self._special, message.get("place"))
        self._submit(lambda stop: [switch_to_doubled(branch, special, stop)], branch.axis.scene)

    def _load_orbit(self, message: dict[str, Any]) -> None:
        """Show an orbit on the main page: a stable one settled, an unstable one live, so that its instability shows."""
        half: Any = message.get("arm")
        drawn = check_index("branch", self._drawn, half)
        point = check_index("orbit", self._rows.orbits.get(half, []), message.get("place"))
        self._host.turn_knobs(drawn.branch.axis.scene_at(point.knob), drawn.branch.state(point),
                              "settled" if point.stable else "live")

    # Following a branch, in a separate thread

    def _clear(self) -> None:
        self._task.cancel()
        self._followed, self._drawn, self._special, self._rows, self._scene = [], [], [], BranchRows(), None
        self._view.send(type="clear")

    def _submit(self, begin: Callable[[Stop], list[Branch]], scene: Scene) -> None:
        self._task.cancel()
        self._scene = scene
        self._draw_curve()
        self._show_status("waiting")
        self._task.start(lambda job: self._follow_in_thread(begin, scene, job))

    def _follow_in_thread(self, begin: Callable[[Stop], list[Branch]], scene: Scene, job: Job) -> None:
        """In a worker thread, follow branches, report every `_MESSAGE_EVERY` seconds, and let pictures go first."""
        sent = 0.0
        job.compile(scene, FIXED_STEP_KERNELS, DOP853_KERNELS, BRANCH_KERNELS)
        job.report("settling")
        for branch in begin(job.stop):
            continuation = Continuation(branch, job.stop)
            job.next_tick(self._add, continuation)
            for _ in continuation:
                if time.monotonic() - sent > _MESSAGE_EVERY:
                    sent = time.monotonic()
                    job.next_tick(self._draw)
                job.give_way()
        job.next_tick(self._draw)

    # With the document locked

    def _add(self, continuation: Continuation) -> None:
        self._followed.append(continuation)
        self._drawn.extend(_Drawn(continuation.branch, half) for half in continuation.branch.half_branches)
        self.scene_changed()
        self._draw()

    def _draw_curve(self) -> None:
        """Draw the resonance curve behind the branches of the same chain, or alone while there are no branches."""
        now = self._host.session.scene
        if self._scene is not None and without_frequency(self._scene) != without_frequency(now):
            return
        added = self._rows.curve(self._host.complete_curve())
        if added is not None:
            self._scene = self._scene or now
            self.scene_changed()
            self._view.need_figures()
            self._view.send(type="add", **added)

    def _draw(self) -> None:
        """Send the new points; a special point is sent before the orbit that follows it on its half-branch."""
        for number, drawn in enumerate(self._drawn):
            points = drawn.half.points[drawn.points :]
            special = drawn.half.special[drawn.special :]
            if not points:
                continue
            self._special.extend((drawn.branch, s) for s in special)
            drawn.points += len(points)
            drawn.special += len(special)
            self._view.need_figures()
            self._view.send(type="add", **self._rows.add(number, drawn.branch, points, special))
        self._show_status(self.status if self.status in ("stopped", "done") else "following")

    def _show_status(self, status: Status, sentence: str = "") -> None:
        self.status = status
        halves = [drawn.half for drawn in self._drawn]
        orbits, special = sum(len(half.points) for half in halves), sum(len(half.special) for half in halves)
        words = f"{orbits} orbits, {special} special points" if halves else ""
        if status == "following":
            words += "; now at " + " and ".join(f"{half.points[-1].knob:.1f} Hz" for half in halves if not half.ended)
        self._view.update_state(**WORDS.of(status, sentence), words=words,
                                ended=[half.reason for half in halves if half.ended],
                                unfinished=any(not half.ended for half in halves))
