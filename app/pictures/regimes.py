"""How a regime is marked wherever points of several are drawn: the curve, the map, the legend."""

from __future__ import annotations

from granchain_core import CurvePoint

from .theme import THEMES

#: Marker, colour and size of every regime: told apart with and without colour.
REGIMES = {
    "period 1": ("circle", THEMES["light"].output, 7), "period 2": ("diamond", "#a855f7", 11),
    "period 3": ("triangle", "#f59e0b", 10), "period 4": ("square", "#06b6d4", 8),
    "period 5+": ("star", "#ec4899", 12), "quasi-periodic": ("circle_dot", "#8b8bf0", 9),
    "chaotic": ("x", "#e879f9", 9), "unsettled": ("dash", "#8a8f98", 10),
}


def regime_key(point: CurvePoint) -> str:
    """The entry of `REGIMES` a point belongs to."""
    if point.regime.name != "periodic" or not point.regime.period:
        return point.regime.name if point.regime.name in REGIMES else "unsettled"
    return f"period {point.regime.period}" if point.regime.period < 5 else "period 5+"
