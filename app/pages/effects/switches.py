"""The effects one can switch: what each is, which knobs that moves, and the two kernels that show its cost."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from granchain_core import BadInput, Scene, scene
from granchain_core.accuracy.effect_cost import Variant

ACCOUNT = "account"
"""The one effect that is no knob of the scene: it changes nothing in the motion."""


@dataclass(frozen=True)
class Effect:
    """An effect as the page lists it."""

    name: str
    title: str
    meaning: str


EFFECTS: dict[str, Effect] = {
    e.name: e
    for e in (
        Effect("dashpot", "contact damping", "A contact loses energy while it is pressed."),
        Effect("tension", "tension cut", "A damped contact may not pull while it opens."),
        Effect("foundation", "foundation", "A spring from every bead to the ground."),
        Effect("preload", "preload", "A static force presses the chain together; without it: sonic vacuum."),
        Effect(ACCOUNT, "energy account",
               "Work, loss and stored energy are integrated along: how well they close is told in the badge."),
    )
}
#: What an effect is switched on with where neither the visitor nor the scene has said.
_USUAL: dict[str, Any] = {"dissipation": "linear", "D": 100.0, "kappa": 0.001, "F0": 1.0}

_OFF: dict[str, dict[str, Any]] = {"dashpot": {"dissipation": "none"}, "foundation": {"k": 0.0}, "preload": {"F0": 0.0}}


def present(name: str, shown: Scene, account: bool) -> bool:
    """Whether the effect is in the kernels of this scene."""
    return {"dashpot": shown.has_dissipation, "tension": shown.has_dissipation and shown.tension == "cut",
            "foundation": shown.k > 0.0, "preload": shown.F0 > 0.0, ACCOUNT: account}[name]


def refusal(name: str, shown: Scene) -> str:
    """Why the effect cannot be switched for this scene; empty where it can."""
    if name == "tension" and not shown.has_dissipation:
        return "Without contact damping no contact can pull: switch that on first."
    return ""


def changes(name: str, on: bool, shown: Scene, remembered: Mapping[str, Any]) -> dict[str, Any]:
    """The knobs that switch the effect: back to what the visitor had, else to what the scene has, else to the usual."""
    if name not in EFFECTS or name == ACCOUNT:
        raise BadInput(f"There is no effect {str(name)[:40]!r} that a knob switches.")
    if refused := refusal(name, shown):
        raise BadInput(refused)
    if name == "tension":
        return {"tension": "cut" if on else "allowed"}
    if not on:
        return dict(_OFF[name])
    before = {**scene(shown.name).knobs, **remembered}
    if name == "dashpot":
        law = before["dissipation"] if before["dissipation"] != "none" else _USUAL["dissipation"]
        return {"dissipation": law, "D": shown.D or before["D"] or _USUAL["D"]}
    if name == "foundation":
        return {"k": before["k"]} if before["k"] > 0.0 else {"kappa": _USUAL["kappa"]}
    return {"F0": before["F0"] or _USUAL["F0"]}


def variants(name: str, shown: Scene) -> tuple[Variant, Variant] | None:
    """The scene with the effect and without it, everything else the same; None where it cannot be switched."""
    if name == ACCOUNT:
        return Variant(shown, balance=True), Variant(shown)
    if refusal(name, shown):
        return None
    on = present(name, shown, account=False)
    other = shown.evolve(**changes(name, not on, shown, {}))
    return (Variant(shown), Variant(other)) if on else (Variant(other), Variant(shown))
