"""The bar over the resonance curve."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from granchain_core.steady.curve.resonance import STRONG_FRACTION

from ..parts.toolkit.component import Component, text
from ..plots.curve import CURVE_STYLES
from ..plots.regimes import REGIME_MARKS, SYMBOLS
from ..scripts import module

#: The curves that can be selected: name, label and meaning.
CHOICES = (*((name, style.label, f"{style.meaning.capitalize()}.") for name, style in CURVE_STYLES.items()),
           ("features", "paper’s features ┊", "Frequencies the paper states for its rig; it gives no forces."))
#: Every mark that a curve may have, for the key and for the tab “regimes”.
KINDS = [{"name": name, "symbol": SYMBOLS[marker], "colour": colour}
         for name, (marker, colour, _) in REGIME_MARKS.items()]


class CurveBar(Component):
    """The bar of the curve: its selection, its progress, and a button that stops it."""

    _esm = module("curve_bar.js")
    _stylesheets = [text("controls.css"), text("curve_bar.css")]  # noqa: RUF012

    def __init__(self, receive: Callable[[dict[str, Any]], None] | None = None, **params: Any) -> None:
        super().__init__(receive, state={"choices": [list(choice) for choice in CHOICES], "names": [], "stated": [],
                                          "kinds": KINDS, "strong": STRONG_FRACTION, "driven": True, "too_long": False,
                                          "rig": False},
                         **params)


def shown_progress(done: float | None) -> float:
    """Return the progress as the bar's script expects it: from 0 to 1, or −1 if no curve is under way."""
    return -1.0 if done is None else done
