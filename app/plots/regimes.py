"""Marks of the regimes.

They are the same on the resonance curve and its key, in the parameter map, the list of attractors, the bifurcation
diagram, the tab “regimes” and the paper's figures. After a change, run `python -m tools.paper` and
`python -m tools.screenshots`, because the pictures in docs/paper and docs/dashboard.png show them, and
`python -m tools.update`, which writes docs/marks.md. The colours are constants of theme.py; a new one also needs its
name in tools/marks.py.
"""

from __future__ import annotations

from .theme import BLUE, CYAN, GREY, ORANGE, OUTPUT_COLOUR, PINK, PURPLE, RED

#: Marker, colour and size of every regime, distinguishable with and without colour.
REGIME_MARKS = {
    "period 1": ("circle", OUTPUT_COLOUR, 7), "period 2": ("diamond", PURPLE, 11),
    "period 3": ("triangle", ORANGE, 10), "period 4": ("square", CYAN, 8),
    "period 5+": ("star", PINK, 12), "quasi-periodic": ("circle_dot", BLUE, 9),
    "chaotic": ("x", RED, 9), "unsettled": ("dash", GREY, 10),
}

#: The markers as characters, for a legend in words.
SYMBOLS = {"circle": "●", "diamond": "◆", "triangle": "▲", "square": "■", "star": "★", "circle_dot": "◉", "x": "✕",
           "dash": "–"}


def regime_key(name: str, period: int | None) -> str:
    """Return a motion's key in `REGIME_MARKS`, from the name of its regime and its period if it has one."""
    if name == "periodic" and period:
        return f"period {period}" if f"period {period}" in REGIME_MARKS else "period 5+"
    return name if name in REGIME_MARKS else "unsettled"
