"""What the map tab draws: the grid, its cells as rows of numbers, and attractors in words."""

from __future__ import annotations

from typing import Any

import numpy as np

from granchain_core.diagram import Attractor, Grid
from granchain_core.diagram.cells import REGIMES as NAMES
from granchain_core.orbits import response
from granchain_core.quantities import QUANTITIES
from granchain_core.steady.regime import modulus_words

from ...page.format import short_error
from ...parts.chain import PALETTE
from ...parts.regimes import REGIMES

CATEGORIES = (*REGIMES, "failed")
"""What a cell may be; the colours are those of the curve, and each has a hatch of its own in the browser."""
_FAILED = "#7a3b00"
_FIFTH = 5


def head_message(grid: Grid) -> dict[str, Any]:
    """Axes, colours and categories of a diagram whose cells are still to come."""
    axes = {}
    for name, axis in (("x", grid.x), ("y", grid.y)):
        quantity = QUANTITIES[axis.knob]
        axes[name] = {"knob": axis.knob, "symbol": quantity.symbol, "unit": quantity.unit, "values": list(axis.values),
                      "log": quantity.scale == "log" and axis.knob != "f"}
    colours = [REGIMES[name][1] if name in REGIMES else _FAILED for name in CATEGORIES]
    return {"type": "map-head", **axes, "palette": PALETTE[::4],
            "categories": [{"name": n, "colour": c} for n, c in zip(CATEGORIES, colours, strict=True)]}


def category(cell: np.ndarray) -> int:
    """The place of a cell in `CATEGORIES`."""
    name = NAMES[int(cell["regime"])]
    if name == "periodic":
        period = int(cell["period"])
        name = f"period {period}" if period < _FIFTH else "period 5+"
    return CATEGORIES.index(name)


def cells_message(grid: Grid, cells: np.ndarray, done: float) -> dict[str, Any]:
    """Computed cells as rows of number, spacing, category, period, force [N], relative error, exponent, its error."""
    spacing = grid.spacing()
    rows = [(c["number"], spacing[c["number"]], category(c), c["period"], c["max_output_force"], c["error_estimate"],
             c["lyapunov"], c["lyapunov_error"]) for c in cells]
    return {"type": "map-cells", "done": done, "columns": 8,
            "values": np.array(rows, dtype=np.float32).reshape(-1)}


def described(attractor: Attractor) -> dict[str, Any]:
    """One attractor for the list: category, words, force, share, and which named starts lead to it."""
    regime = attractor.regime
    period = regime.period
    name = regime.name if period is None else f"period {period}" if period < _FIFTH else "period 5+"
    error = attractor.error_estimate
    kind = "" if attractor.orbit is None else response(attractor.orbit).sentence
    words = [f"period {period}" if period else regime.name]
    if kind:
        words.append(kind)
    if attractor.orbit is not None:
        leading = modulus_words(abs(attractor.orbit.multipliers[0]))
        words.append(f"|μ| {leading}" + ("" if attractor.stable else ", unstable"))
    elif regime.lyapunov is not None:
        words.append(f"Lyapunov exponent {regime.lyapunov[0]:+.3f} ± {regime.lyapunov[1]:.3f} per period")
    return {
        "category": CATEGORIES.index(name if name in CATEGORIES else "unsettled"), "words": ", ".join(words),
        "force": f"{attractor.max_output_force:.4g} N" + (f", error {short_error(error)}" if error else ""),
        "share": attractor.share, "share_words": f"{100 * attractor.share:.0f} ± {100 * attractor.share_error:.0f} %",
        "from": [origin.name for origin in attractor.origins if not origin.name.startswith("random")],
        "starts": len(attractor.origins),
    }
