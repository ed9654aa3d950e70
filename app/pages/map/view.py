"""Messages to the Map tab: the figure of a grid, its cells as rows of the figure's sources, attractors in words."""

from __future__ import annotations

from typing import Any

import numpy as np

from granchain_core.attractor_search import Attractor
from granchain_core.orbits import response
from granchain_core.parameter_maps import Grid
from granchain_core.results.regime import exponent_words, modulus_words

from ...format import figures_of, in_words, short_error
from ...plots.json_item import figure_item
from ...plots.parameter_map import cell_rows, nothing, parameter_map, scale_models, shown_models
from ...plots.regimes import REGIME_MARKS, regime_key
from ...plots.theme import Theme


def head_message(grid: Grid, theme: Theme) -> dict[str, Any]:
    """Return the figure of a map without cells, and the values of its knobs in SI."""
    return {"type": "map-head", "figure": figure_item(parameter_map(nothing(grid), theme)), "x": list(grid.x.values),
            "y": list(grid.y.values), "shown": {name: shown_models(name) for name in ("force", "regime")}}


def cells_message(grid: Grid, cells: np.ndarray, every: np.ndarray) -> dict[str, Any]:
    """Return some computed cells as rows, and the scale for all computed cells."""
    computed = every[every["regime"] >= 0]
    return {"type": "map-cells", "done": len(computed) / len(every), "rows": {"cells": cell_rows(grid, cells)},
            "models": scale_models(computed)}


def described_attractor(attractor: Attractor) -> dict[str, Any]:
    """Return an attractor for the list: colour, words, force, share, and the named starts that lead to it."""
    regime = attractor.regime
    period = regime.period
    error = attractor.force_errors.output
    kind = "" if attractor.orbit is None else response(attractor.orbit).sentence
    words = [f"period {period}" if period else regime.name]
    if kind:
        words.append(kind)
    if attractor.orbit is not None:
        leading = modulus_words(abs(attractor.orbit.multipliers[0]))
        words.append(f"|μ| {leading}" + ("" if attractor.stable else ", unstable"))
    elif regime.lyapunov is not None:
        words.append(f"Lyapunov exponent {exponent_words(*regime.lyapunov)} per period")
    return {
        "colour": REGIME_MARKS[regime_key(regime.name, period)][1], "words": ", ".join(words),
        "force": in_words(attractor.max_output_force, "N", figures_of(error))
        + (f", error {short_error(error)}" if error else ""),
        "share": attractor.share, "share_words": attractor.share_words,
        "from": [origin.name for origin in attractor.origins if not origin.name.startswith("random")],
        "starts": len(attractor.origins),
    }
