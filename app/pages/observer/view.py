"""The Observer page: a chain, its observer below it, the force between them, and their distance over time."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from granchain_core import Scene, scene

from ...format import prefixed
from ...frames import chain_series
from ...parts.chain.chain import drawn_chain
from ...parts.figures.streamed_figure import StreamedFigure, page_and_small
from ...parts.toolkit.component import text
from ...plots.energies import ENERGY_COLOURS
from ...plots.observer import observer, prediction
from ...plots.theme import Theme
from ...scripts import module
from .work import NUDGE, ObserverStep

#: Drive periods after a start in which the distance does not yet follow a multiplier.
_TRANSIENT_PERIODS = 2


@cache
def empty_figures(theme: Theme) -> dict[str, Any]:
    """Return the figure of the distance over time without points, for the page and, small, for its tab."""
    return page_and_small(lambda compact: observer([], [], [], theme, compact))


class Observer(StreamedFigure):
    """The overlay; every period is sent as one message."""

    _esm = module("observer.js")
    _stylesheets = [text("controls.css"), text("observer.css")]  # noqa: RUF012
    empty_figures = staticmethod(empty_figures)

    def __init__(self, receive: Callable[[dict[str, Any]], None] | None = None, **params: Any) -> None:
        super().__init__(receive, state=first_state(), **params)
        self._anchor: tuple[float, float] | None = None

    def step(self, step: ObserverStep, scene: Scene, began: bool, since: int, factor: float | None) -> None:
        """Send one period, and the prediction from the end of the transient (two periods after the start)."""
        self.need_figures()
        if began:
            self._anchor = None
        if self._anchor is None and step.number >= since + _TRANSIENT_PERIODS:
            self._anchor = float(step.number), float(step.distance[0])
        line = prediction(*self._anchor, factor) if self._anchor else []
        self.send(**step_message(step, scene, began), prediction=line)


def first_state() -> dict[str, Any]:
    """Return the state of the page before anything is computed."""
    return {"palette": ENERGY_COLOURS, "kappa": 0.0, "nudge": NUDGE, "paper_kappa": scene("fig11-founded").kappa,
            "progress": "", "sentence": ""}


def step_message(step: ObserverStep, scene: Scene, began: bool) -> dict[str, Any]:
    """Return one drive period for the browser; one array has the chain's rows, the observer's, and their distance."""
    push = step.largest_input
    factor, letter = prefixed(push)
    series = [*chain_series(step.chain, step.chain_force, step.chain_energy, step.drive),
              *chain_series(step.observer, step.observer_force, step.observer_energy, step.drive), step.distance]
    return {
        "type": "step", "number": step.number, "began": began, "rows": len(step.distance),
        "samples": step.samples, **drawn_chain(scene),
        "energy_high": max(float(step.chain_energy.max()), 1e-300), "push": f"{push / factor:.3g} {letter}N",
        "values": np.concatenate(series, dtype=np.float32),
    }
