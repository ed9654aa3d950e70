"""The corner below the curve: what to look at, the effects, the visitor's own data."""

from __future__ import annotations

from .component import Component, text


class Corner(Component):
    """Tabs; the data tab sends the text of a CSV file."""

    _esm = text("plot.js") + text("effects.js") + text("map.js") + text("corner.js")
    _stylesheets = [text("controls.css"), text("drawing.css"), text("corner.css"), text("map.css")]  # noqa: RUF012


class CurveBar(Component):
    """What the curve shows, its progress and how to stop it."""

    _esm = text("curvebar.js")
    _stylesheets = [text("controls.css"), text("curvebar.css")]  # noqa: RUF012
