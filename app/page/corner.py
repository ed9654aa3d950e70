"""The corner below the curve: what to look at, the effects, the visitor's own data."""

from __future__ import annotations

from ..parts.component import Component, text
from ..scripts import module


class Corner(Component):
    """Tabs; the data tab sends the text of a CSV file."""

    _esm = module("corner.js")
    _stylesheets = [text(f"{name}.css")  # noqa: RUF012
                    for name in ("controls", "drawing", "corner", "map")]
