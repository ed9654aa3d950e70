"""The knobs: slider, number and unit for every quantity of the scene."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from granchain_core import Scene, scene
from granchain_core.scene.quantities import QUANTITIES

from ...scripts import module
from ...session.scene_facts import slider_range
from ..toolkit.component import Component, text
from .foundation import beside_kappa, foundation_words

MAIN = tuple(name for name, quantity in QUANTITIES.items() if quantity.main)
MORE = tuple(name for name in QUANTITIES if name not in MAIN)
#: The values at which knobs have no effect: the defaults of the fields of `Scene`, by knob.
_DEFAULTS = {field.name: field.default for field in fields(Scene)}
#: The label and meaning of a knob in a scene without a drive.
_UNDRIVEN = {
    "f": ("time shown = 1/f", "This chain has no drive: 1/f is only the length of time shown."),
    "A0": ("unit of length", "This chain has no drive: A₀ is only the unit of length in the computation."),
}


class Knobs(Component):
    """All knobs; a movement arrives as {"do": "set", "name": knob, "value": SI value, "seq": number}."""

    _esm = module("knobs.js")
    _stylesheets = [text("controls.css"), text("knobs.css")]  # noqa: RUF012


def knob_state(current: Scene) -> dict[str, Any]:
    """Return everything that the browser needs to draw the knobs of a scene."""
    preset = scene(current.name).knobs
    return {
        "specs": [_spec(name, current, preset) for name in MAIN + MORE],
        "values": {name: current.knobs[name] for name in MAIN + MORE},
        "preset": {name: preset[name] for name in MAIN + MORE},
        **beside_knobs(current),
    }


def beside_knobs(current: Scene) -> dict[str, Any]:
    """Return the notes next to a scene's knobs: on the foundation, and on knobs that have no effect at present."""
    idle = {"D": "no effect: the law, under “more knobs”, is “none”"} if current.dissipation == "none" else {}
    return {"foundation": foundation_words(current), "kept": beside_kappa(current), "idle": idle}


def _spec(name: str, current: Scene, preset: dict[str, Any]) -> dict[str, Any]:
    quantity = QUANTITIES[name]
    short, meaning = quantity.short or quantity.label, quantity.meaning
    if name in _UNDRIVEN and preset["drive"] == "rest":
        short, meaning = _UNDRIVEN[name]
    shown = quantity.main or (quantity.main_if_set and preset[name] != _DEFAULTS[name])
    factor, unit = quantity.shown_in or (1.0, quantity.unit if quantity.unit != "1" else "")
    low, high = slider_range(current, name)
    return {
        "name": name, "symbol": "" if quantity.choices else quantity.symbol, "label": quantity.label,
        "short": short, "meaning": meaning,
        "unit": unit, "factor": factor, "choices": list(quantity.choices), "low": low, "high": high,
        "whole": quantity.whole, "more": not shown, "step": quantity.step, "scale": quantity.scale,
        "at_zero": quantity.at_zero,
    }
