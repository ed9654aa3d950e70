"""The Branches page: periodic orbits over the drive frequency, stable and unstable, with their special points."""

from __future__ import annotations

from functools import cache
from typing import Any

from bokeh.embed import json_item

from ...parts.component import text
from ...parts.drawn import Drawn
from ...pictures.branches import branches
from ...pictures.theme import Theme
from ...scripts import module


class Branches(Drawn):
    """The page over the pictures; the growing branch comes in messages."""

    _esm = module("branches.js")
    _stylesheets = [text("controls.css"), text("branches.css")]  # noqa: RUF012

    def empty_figures(self, theme: Theme) -> dict[str, Any]:
        """The figure without branches, for the page and, small, for the corner."""
        return empty_figures(theme)


@cache
def empty_figures(theme: Theme) -> dict[str, Any]:
    """The figure without branches, for the page and, small, for the corner."""
    return {name: json_item(branches([], theme, compact=compact)) for name, compact in (("page", False),
                                                                                        ("small", True))}
