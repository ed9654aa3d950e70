"""The page "Hard cases" of one visitor: what is asked to be measured, what is measured, and what was found."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from granchain_core import BadInput, Cancelled
from granchain_core.hard import CASES, Case, Check, Picture
from granchain_core.integrate.engine import new_stop

from ...page.background import Background
from ...serve.queues import Stop
from .view import described, picture_message, summary
from .work import CaseProcess, Ended, case_of

if TYPE_CHECKING:
    from ...page.controller import Controller

_TURN = threading.Lock()
"""One case at a time, for all visitors."""
_LOOK = 0.05
"""Seconds between looks at the stop flag while another visitor's case is measured."""
_FAULT = "The process that measures it ended by a fault inside granchain; run it again, and please report it."


class HardPage(Background):
    """Cases wait for their turn and are measured one after the other; results stay until a case is run again."""

    def __init__(self, page: Controller) -> None:
        self._page = page
        self._view = page.views.hard
        self._process = CaseProcess()
        self._stop: Stop = new_stop()
        self._shown: dict[str, dict[str, Any]] = {}
        self._asked = 0
        self.rows: dict[str, list[Check]] = {}
        self.waiting: list[str] = []
        self.actions: dict[str, Callable[[dict[str, Any]], None]] = {
            "hard-run": self._run_one, "hard-all": lambda _: self._run(CASES),
            "hard-cancel": lambda _: self.cancel(),
        }

    @property
    def activity(self) -> tuple[str, str, str]:
        """Name, state and detail for the list of what is computed now."""
        if self.waiting:
            return "hard cases", "computing", self.waiting[0]
        return "hard cases", "there" if self.rows else "off", f"{len(self.rows)} of {len(CASES)} run"

    def cancel(self) -> None:
        """Stop the case under way and forget those that wait; what was found stays."""
        self._give_up()
        for name in self.waiting:
            self._put(name, status="cancelled")
        self.waiting = []
        self._show()

    def close(self) -> None:
        """The visitor left."""
        self._give_up()

    def _give_up(self) -> None:
        self._stop[0] = 1
        self._process.close()
        self._stop, self._process = new_stop(), CaseProcess()

    # What the visitor does

    def _run_one(self, message: dict[str, Any]) -> None:
        case = case_of(message.get("case"))
        if case is None:
            raise BadInput(f"There is no hard case {str(message.get('case'))[:40]!r}; reload the page.")
        self._run((case,))

    def _run(self, cases: tuple[Case, ...]) -> None:
        idle = not self.waiting
        if idle:
            self._asked = 0
        for case in cases:
            if case.name not in self.waiting:
                self.waiting.append(case.name)
                self._asked += 1
                self._put(case.name, status="waiting", failure="")
        if idle:
            self._begin_next()
        self._show()

    def _begin_next(self) -> None:
        # a daemon: a server that ends does not wait for it
        wanted = case_of(self.waiting[0]), self._process, self._stop
        threading.Thread(target=self._work, args=wanted, name="hard cases", daemon=True).start()

    # In the measuring thread

    def _work(self, case: Case, process: CaseProcess, stop: Stop) -> None:
        while not _TURN.acquire(timeout=_LOOK):
            if stop[0]:
                return
        try:
            self._later(stop, self._change, case.name, status="running")
            answers = process.measure(case, stop)
            self._later(stop, self._measured, case.name, next(answers))
            self._later(stop, self._draw, case.name, next(answers))
        except Cancelled:
            pass
        except Ended:
            self._later(stop, self._finish, case.name, status="failed", failure=_FAULT)
        else:
            self._later(stop, self._finish, case.name, status="done")
        finally:
            _TURN.release()

    # In the document's turn

    def _measured(self, name: str, rows: list[Check]) -> None:
        self.rows[name] = rows
        self._change(name, status="drawing", **described(name, rows))

    def _draw(self, name: str, picture: Picture | None) -> None:
        if picture is not None:
            self._view.tell(**picture_message(name, picture))

    def _finish(self, name: str, **outcome: str) -> None:
        self.waiting.remove(name)
        if self.waiting:
            self._begin_next()
        else:
            self._process.close()
            self._process = CaseProcess()
        self._change(name, **outcome)

    def _put(self, name: str, **changes: Any) -> None:
        self._shown = {**self._shown, name: {**self._shown.get(name, {}), **changes}}

    def _change(self, name: str, **changes: Any) -> None:
        self._put(name, **changes)
        self._show()

    def _show(self) -> None:
        self._view.display(results=self._shown, summary=summary(self.rows), running=bool(self.waiting),
                           done=1.0 - len(self.waiting) / max(1, self._asked))
