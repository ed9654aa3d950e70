"""The Analysis page of one session: computes the chosen question for the present scene on request."""

from __future__ import annotations

from typing import Any

from granchain_core import BadInput, Settled
from granchain_core.precompile.pieces import ORBIT_KERNELS

from ...serve.computing.worker_pools import LONG
from ...session.host import PageHost
from ...session.page import Actions, Page
from ...session.progress import Status, StatusWords
from ...session.task import Job, Task
from .questions import (
    QUESTIONS,
    AnalysisQuestion,
    Field,
    Plan,
    chosen_fields,
    offered_fields,
    planned,
    question_of,
    question_text,
    read_question,
)
from .view import Analysis

WORDS = StatusWords("the kernels of the analysis", ORBIT_KERNELS)


class AnalysisPage(Page):
    """The page, which answers one question at a time.

    An answer stays, with its scene in the title, until another question is asked. The address contains the question and
    the values with which it was last computed. If the page is opened with a question in its address, it offers that
    question and computes nothing until the visitor presses “compute”. Without a question in its address, it answers the
    first one, which takes no time, for every picture until the visitor asks another.
    """

    def __init__(self, host: PageHost, view: Analysis) -> None:
        self._host = host
        self._view = view
        self._task = Task(host, LONG, self._show_status, "The analysis")
        self._question: AnalysisQuestion | None = None
        self._text = ""
        self._fields: tuple[Field, ...] = ()
        self._visible = self._unasked = False
        self.actions: Actions = {
            "analysis-ask": self._ask, "analysis-compute": self._begin, "analysis-stop": lambda _: self._stop()}
        self.address_applied()

    def scene_changed(self) -> None:
        """Cancel the running work and replace the offered values, because both are of the scene before the change."""
        self._stop()
        if self._question is not None:
            self._fields = offered_fields(self._question, self._host.session.scene, self._fields)
            self._view.offer(self._fields)

    def visibility_changed(self, visible: bool) -> None:
        """Answer the first question if the page is opened without one."""
        self._visible = visible
        self._unasked = self._unasked or (visible and self._question is None)
        self._begin_unasked()

    def picture_ready(self, settled: Settled) -> None:
        """Answer the first question for the new picture, unless the visitor has asked one."""
        if settled.final:
            self._begin_unasked()

    def _begin_unasked(self) -> None:
        if self._visible and self._unasked and self._host.session.settled is not None:
            question = next(iter(QUESTIONS.values()))
            self._offer(question, question.fields(self._host.session.scene), "")
            try:
                self._compute_chosen({})
            except BadInput as problem:  # too long a chain, or one without a drive
                self._show_status("none", str(problem))

    def address_applied(self) -> None:
        """Take question and values from the address; an answer already on the page stays."""
        text = self._host.session.question
        if text and text != self._text:
            self._unasked = False
            question, fields = read_question(text, self._host.session.scene)
            self._offer(question, fields, text)

    def _ask(self, message: dict[str, Any]) -> None:
        self._unasked = False
        question = question_of(message.get("question"))
        self._offer(question, question.fields(self._host.session.scene), question_text(question))
        self._keep()

    def _offer(self, question: AnalysisQuestion, fields: tuple[Field, ...], text: str) -> None:
        self._task.cancel()
        self._question, self._text, self._fields = question, text, fields
        self._view.ask(question, fields)
        self._show_status("none")

    def _keep(self) -> None:
        self._host.session.question = self._text
        self._host.address_changed()

    def _begin(self, message: dict[str, Any]) -> None:
        if self._question is None:
            return
        self._unasked = False
        self._compute_chosen(message.get("values"))
        self._text = question_text(self._question, self._fields)
        self._keep()

    def _compute_chosen(self, values: object) -> None:
        """Start to compute the question with these values of its fields."""
        assert self._question is not None
        scene = self._host.session.scene
        plan = planned(self._question, scene, values)
        self._fields = chosen_fields(self._question, scene, values)
        self._view.clear()
        self._show_status("waiting")
        self._task.start(lambda job: self._compute(plan, job))

    def _stop(self) -> None:
        if self._task.cancel():
            self._show_status("stopped")

    def _compute(self, plan: Plan, job: Job) -> None:
        """Compute the answer in a thread of the pool `LONG`."""
        for scene, pieces in plan.kernels:
            job.compile(scene, *pieces)
        job.report("computing")
        progress = job.progress(lambda done: self._view.update_state(done=done))
        job.next_tick(self._view.answer, plan, plan.compute(job.stop, progress))

    def _show_status(self, status: Status, sentence: str = "") -> None:
        if status == "waiting":
            self._view.update_state(done=0.0)
        self._view.update_state(**WORDS.of(status, sentence))
