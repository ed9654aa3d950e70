"""The corner below the curve: what to look at, the effects, the visitor's own data."""

from __future__ import annotations

from .component import Component, text


class Corner(Component):
    """Tabs; the data tab sends the text of a CSV file."""

    _esm = "".join(text(f"{name}.js") for name in (
        "plot", "embedded", "effects", "multipliers", "stabilitysmall", "branchpicture", "map", "corner"))
    _stylesheets = [text(f"{name}.css")  # noqa: RUF012
                    for name in ("controls", "drawing", "multipliers", "corner", "map")]


class CurveBar(Component):
    """What the curve shows, its progress and how to stop it."""

    _esm = text("curvebar.js")
    _stylesheets = [text("controls.css"), text("curvebar.css")]  # noqa: RUF012
