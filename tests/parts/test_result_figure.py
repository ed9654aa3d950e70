"""Figures of results are sent when they are shown, and again when the theme changes while they are shown."""

from __future__ import annotations

from typing import Any

from bokeh.models import Div

from app.parts.figures.result_figure import ResultFigure
from app.plots.theme import THEMES, Theme


def figure(theme: Theme) -> Div:
    """Return a stand-in for a figure that contains the theme's name."""
    return Div(text=theme.card)


class Told(ResultFigure):
    """A result figure that records its messages."""

    def __init__(self) -> None:
        super().__init__()
        self.told: list[dict[str, Any]] = []

    def send(self, **message: Any) -> None:
        """Record the message instead of sending it to a browser."""
        self.told.append(message)

    def news(self) -> list[tuple[str, str, str]]:
        """Return type, place and figure theme of every message since the last call."""
        told, self.told = self.told, []
        return [(one["type"], one["place"],
                 "" if one["type"] == "clear" else one["figure"]["doc"]["roots"][0]["attributes"]["text"]) for one in told]


def test_a_figure_is_drawn_again_in_another_theme_until_it_is_cleared() -> None:
    view = Told()
    light, dark = THEMES["light"].card, THEMES["dark"].card
    view.apply_theme(THEMES["dark"])
    assert view.news() == []
    view.show_figure(figure, "words", 1.5, "here")
    view.show_figure(figure, "words", place="there")
    assert view.told[0]["shape"] == 1.5 and view.told[0]["words"] == "words"
    assert view.news() == [("figure", "here", dark), ("figure", "there", dark)]
    view.apply_theme(THEMES["dark"])
    assert view.news() == []
    view.clear_figure("here")
    view.apply_theme(THEMES["light"])
    assert view.news() == [("clear", "here", ""), ("figure", "there", light)]
