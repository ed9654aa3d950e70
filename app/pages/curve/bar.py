"""The bar over the resonance curve."""

from __future__ import annotations

from ...parts.component import Component, text
from ...scripts import module


class CurveBar(Component):
    """Which curves are shown, their progress, and a button that stops them."""

    _esm = module("curvebar.js")
    _stylesheets = [text("controls.css"), text("curvebar.css")]  # noqa: RUF012
