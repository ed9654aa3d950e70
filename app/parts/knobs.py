"""The knobs: slider, number and unit for every quantity of the scene."""

from __future__ import annotations

from typing import Any

from granchain_core import Scene, scene
from granchain_core.quantities import QUANTITIES

from ..scripts import module
from ..session.session import slider_range
from .component import Component, text
from .foundation import beside_kappa, foundation_words

MAIN = tuple(name for name, quantity in QUANTITIES.items() if quantity.main)
MORE = tuple(name for name in QUANTITIES if name not in MAIN)


class Knobs(Component):
    """The knobs' drawing; a movement comes as {"do": "set", "name": knob, "value": SI value, "seq": number}."""

    _esm = module("knobs.js")
    _stylesheets = [text("controls.css"), text("knobs.css")]  # noqa: RUF012


def knob_state(current: Scene) -> dict[str, Any]:
    """Everything that the browser needs to draw the knobs of a scene."""
    preset = scene(current.name).knobs
    return {
        "specs": [_spec(name, current) for name in MAIN + MORE],
        "values": {name: current.knobs[name] for name in MAIN + MORE},
        "preset": {name: preset[name] for name in MAIN + MORE},
        "foundation": foundation_words(current), "kept": beside_kappa(current),
    }


def _spec(name: str, current: Scene) -> dict[str, Any]:
    quantity = QUANTITIES[name]
    factor, unit = quantity.shown_in or (1.0, quantity.unit if quantity.unit != "1" else "")
    low, high = slider_range(current, name)
    return {
        "name": name, "symbol": "" if quantity.choices else quantity.symbol, "label": quantity.label,
        "short": quantity.short or quantity.label, "meaning": quantity.meaning,
        "unit": unit, "factor": factor, "choices": list(quantity.choices), "low": low, "high": high,
        "whole": quantity.whole, "more": name in MORE, "step": quantity.step, "scale": quantity.scale,
    }
