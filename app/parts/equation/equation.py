"""The equation of motion of the current scene, with its active terms only."""

from __future__ import annotations

from ...scripts import module
from ..toolkit.component import Component, text


class EquationPart(Component):
    """LaTeX from the scene, rendered as MathML by the KaTeX that comes with Panel."""

    _esm = module("equation.js")
    _stylesheets = [text("equation.css")]  # noqa: RUF012
