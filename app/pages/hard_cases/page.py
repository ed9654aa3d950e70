"""The Hard cases page of one session: the queue, the case being run, and the results."""

from __future__ import annotations

from functools import partial
from typing import Any

from granchain_core import ComputationError
from granchain_core.hard_cases import CASES, Case, Check, Picture

from ...serve.computing.worker_pools import MEASUREMENTS
from ...session.activities import Activity
from ...session.host import PageHost
from ...session.message_checks import check_choice
from ...session.page import Actions, Page
from ...session.progress import Status, StatusWords, activity_state
from ...session.task import Job, Task
from .view import HardCases, described_results, summary
from .work import CaseProcess, Ended, case_of

_FAULT = "The process that ran this case ended unexpectedly; run it again, and please report it."

WORDS = StatusWords()


class HardCasesPage(Page):
    """The page, which runs the requested cases one after another; results stay until a case is run again."""

    def __init__(self, host: PageHost, view: HardCases) -> None:
        self._view = view
        self._process = CaseProcess()
        self._task = Task(host, MEASUREMENTS, self._end, "The case", outlives_knobs="it has a scene of its own")
        host.on_close(self._give_up)
        self._shown: dict[str, dict[str, Any]] = {}
        self._requested = 0
        self.rows: dict[str, list[Check]] = {}
        self.waiting: list[str] = []
        self.actions: Actions = {
            "hard-cases-run": self._run_one, "hard-cases-all": lambda _: self._run(CASES),
            "hard-cases-stop": lambda _: self.stop(),
        }

    @property
    def activity(self) -> Activity:
        """Name, state and detail for the list of running computations."""
        detail = self.waiting[0] if self.waiting else f"{len(self.rows)} of {len(CASES)} run"
        return "hard cases", activity_state(bool(self.waiting), bool(self.rows)), detail

    def stop(self) -> None:
        """Stop the running case and forget the waiting cases; the results so far stay."""
        self._give_up()
        for name in self.waiting:
            self._put(name, **WORDS.of("stopped"))
        self.waiting = []
        self._show()

    def _give_up(self) -> None:
        self._task.cancel()
        self._process.close()
        self._process = CaseProcess()

    # The visitor's actions

    def _run_one(self, message: dict[str, Any]) -> None:
        name = check_choice("hard case", message.get("case"), (case.name for case in CASES))
        self._run(tuple(case for case in CASES if case.name == name))

    def _run(self, cases: tuple[Case, ...]) -> None:
        idle = not self.waiting
        if idle:
            self._requested = 0
        for case in cases:
            if case.name not in self.waiting:
                self.waiting.append(case.name)
                self._requested += 1
                self._put(case.name, **WORDS.of("waiting"))
        if idle:
            self._begin_next()
        self._show()

    def _begin_next(self) -> None:
        case = case_of(self.waiting[0])
        if case is None:
            raise LookupError(self.waiting[0])
        self._task.start(partial(self._work, case, self._process))

    # In the measuring thread

    def _work(self, case: Case, process: CaseProcess, job: Job) -> None:
        job.next_tick(self._change, case.name, **WORDS.of("computing"))
        try:
            answers = process.measure(case, job.stop)
            job.next_tick(self._measured, case.name, next(answers))
            job.next_tick(self._draw, case.name, next(answers))
        except Ended:
            raise ComputationError(_FAULT, "worker-failed") from None

    # With the document locked

    def _measured(self, name: str, rows: list[Check]) -> None:
        self.rows[name] = rows
        self._change(name, **WORDS.of("drawing"), **described_results(name, rows))

    def _draw(self, name: str, data: Picture | None) -> None:
        if data is not None:
            self._view.draw(name, data)

    def _end(self, status: Status, sentence: str) -> None:
        """Start the next case after the first in the queue has ended or failed."""
        name = self.waiting.pop(0)
        if self.waiting:
            self._begin_next()
        else:
            self._process.close()
            self._process = CaseProcess()
        self._change(name, **WORDS.of(status, sentence))

    def _put(self, name: str, **changes: Any) -> None:
        self._shown = {**self._shown, name: {**self._shown.get(name, {}), **changes}}

    def _change(self, name: str, **changes: Any) -> None:
        self._put(name, **changes)
        self._show()

    def _show(self) -> None:
        self._view.update_state(results=self._shown, summary=summary(self.rows), running=bool(self.waiting),
                                done=1.0 - len(self.waiting) / max(1, self._requested))
