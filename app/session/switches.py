"""Switchable effects: the knobs that each switch sets, and the two kernels whose times give the cost of an effect."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from granchain_core import BadInput, Scene, scene
from granchain_core.accuracy.effect_cost import Variant
from granchain_core.scene import effects as table
from granchain_core.scene.effects import Effect

from .message_checks import quoted

#: The one effect without a knob of the scene: it does not change the motion.
ACCOUNT_SWITCH = table.ACCOUNT.name

#: The effects in the order in which the page lists them.
SWITCHES: dict[str, Effect] = {effect.name: effect for effect in (*table.EFFECTS, table.ACCOUNT)}


def present(name: str, shown: Scene, account: bool) -> bool:
    """Return whether the effect is in the kernels of this scene."""
    return account if name == ACCOUNT_SWITCH else SWITCHES[name].present(shown)


def refusal(name: str, shown: Scene) -> str:
    """Return a sentence if the effect cannot be switched for this scene; otherwise an empty text."""
    return "" if SWITCHES[name].possible(shown) else SWITCHES[name].refusal


def changes(name: str, on: bool, shown: Scene, remembered: Mapping[str, Any]) -> dict[str, Any]:
    """Return the knob values that a switch sets.

    An effect that is switched on gets the visitor's earlier values, those of the preset, or usual ones, in this order.
    """
    if name not in SWITCHES or name == ACCOUNT_SWITCH:
        raise BadInput(f"There is no switchable effect {quoted(name)}.")
    if refused := refusal(name, shown):
        raise BadInput(refused)
    effect = SWITCHES[name]
    if not on:
        return dict(effect.off)
    before = {**scene(shown.name).knobs, **remembered}
    knobs: dict[str, Any] = {}
    for knob in effect.knobs:
        # switching off changed only the knobs in `off`; other knobs still have their values
        values = [before[knob]] if knob in effect.off else [shown.knobs[knob], before[knob]]
        knobs.update([(knob, value) for value in values if value != effect.off.get(knob, 0.0)][:1])
    missing = set(effect.knobs) - set(knobs)
    return knobs | {knob: value for knob, value in effect.usual.items() if missing and knob not in knobs}


def variants(name: str, shown: Scene) -> tuple[Variant, Variant] | None:
    """Return the scene with and without the effect; None if the effect cannot be switched."""
    if name == ACCOUNT_SWITCH:
        return Variant(shown, account=True), Variant(shown)
    if refusal(name, shown):
        return None
    on = present(name, shown, account=False)
    other = shown.evolve(**changes(name, not on, shown, {}))
    return (Variant(shown), Variant(other)) if on else (Variant(other), Variant(shown))
