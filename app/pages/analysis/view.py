"""The Analysis page's view: four questions, the fields of the chosen one, and its answer."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from ...parts.figures.result_figure import ResultFigure
from ...parts.toolkit.component import text
from ...scripts import module
from .questions import QUESTIONS, AnalysisQuestion, Field, Plan


class Analysis(ResultFigure):
    """The overlay; fields and words are in `state`, and the figure is sent as a message."""

    _esm = module("analysis.js")
    _stylesheets = [text("controls.css"), text("result_page.css"), text("analysis.css")]  # noqa: RUF012

    def __init__(self, receive: Callable[[dict[str, Any]], None] | None = None, **params: Any) -> None:
        super().__init__(receive, state={"questions": [
            {"name": question.name, "title": question.title} for question in QUESTIONS.values()]}, **params)

    def ask(self, question: AnalysisQuestion, fields: Sequence[Field]) -> None:
        """Show a question with its fields, without a figure."""
        self.clear()
        self.update_state(question=question.name, about=question.about)
        self.offer(fields)

    def offer(self, fields: Sequence[Field]) -> None:
        """Offer these fields, with values for the present scene."""
        self.update_state(fields=[{"name": field.name, "label": field.label, "value": field.value,
                                   "choices": list(field.choices), "chosen": field.chosen} for field in fields])

    def clear(self) -> None:
        """Remove the figure."""
        self.update_state(title="", words=[], command="")
        self.clear_figure()

    def answer(self, plan: Plan, result: Any) -> None:
        """Show the answer of a plan."""
        self.update_state(title=plan.title, words=result.summary(), command=plan.command)
        self.show_figure(partial(plan.draw, result), plan.title)
