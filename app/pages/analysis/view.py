"""The Analysis page's view: four questions, the fields of the chosen one, and its answer."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from bokeh.embed import json_item

from ...parts.component import Component, text
from ...pictures.theme import THEMES, Theme
from ...scripts import module
from .questions import QUESTIONS, Field, Plan, Question


class Analysis(Component):
    """The page over the pictures; fields and words come in `state`, the figure as a message."""

    _esm = module("analysis.js")
    _stylesheets = [text("controls.css"), text("paper.css"), text("analysis.css")]  # noqa: RUF012

    def __init__(self, received: Callable[[dict[str, Any]], None] | None = None, **params: Any) -> None:
        super().__init__(received, state={"questions": [
            {"name": one.name, "title": one.title} for one in QUESTIONS.values()]}, **params)
        self._theme = THEMES["light"]
        self._drawn: tuple[Plan, Any] | None = None

    def ask(self, question: Question, fields: Sequence[Field]) -> None:
        """Show a question with its fields, and nothing drawn."""
        self.clear()
        self.update_state(question=question.name, about=question.about)
        self.offer(fields)

    def offer(self, fields: Sequence[Field]) -> None:
        """Offer these fields, with values for the present scene."""
        self.update_state(fields=[{"name": one.name, "label": one.label, "value": one.value,
                                   "choices": list(one.choices), "chosen": one.chosen} for one in fields])

    def clear(self) -> None:
        """Take the figure away."""
        self._drawn = None
        self.update_state(title="", words=[], command="")
        self.send(type="clear")

    def answer(self, plan: Plan, found: Any) -> None:
        """Show what was found."""
        self._drawn = plan, found
        self.update_state(title=plan.title, words=found.summary(), command=plan.command)
        self.send(type="figure", figure=json_item(plan.draw(found, self._theme)), words=plan.title)

    def apply_theme(self, theme: Theme) -> None:
        """Draw the figure anew in another theme."""
        if theme != self._theme:
            self._theme = theme
            if self._drawn is not None:
                self.answer(*self._drawn)
