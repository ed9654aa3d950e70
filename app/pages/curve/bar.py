"""The bar over the resonance curve."""

from __future__ import annotations

from ...parts.component import Component, text
from ...scripts import module


class CurveBar(Component):
    """What the curve shows, its progress and how to stop it."""

    _esm = module("curvebar.js")
    _stylesheets = [text("controls.css"), text("curvebar.css")]  # noqa: RUF012
