"""Lists that follow from the tables in the code: the knobs in docs/model.md and the scenes in README.md."""

from __future__ import annotations

from granchain_core import scene, scene_names
from granchain_core.quantities import QUANTITIES, Quantity
from tools.thresholds import printed


def table_of_knobs() -> str:
    """The table of docs/model.md: every knob with its symbol, unit, values and meaning."""
    rows = [f"| `{knob.name}` | {knob.symbol or '–'} | {knob.unit or '–'} | {allowed(knob)} | {knob.meaning} |"
            for knob in QUANTITIES.values()]
    return "\n".join(["| knob | symbol | unit | values | meaning |", "|---|---|---|---|---|", *rows])


def allowed(knob: Quantity) -> str:
    """The values that a knob takes, in words."""
    words = ", ".join(f"`{word}`" for word in knob.choices)
    if not knob.numeric:
        return words
    numbers = f"{printed(knob.low)} to {printed(knob.high)}"
    return f"{words}, or {numbers}" if words else numbers + (", whole" if knob.whole else "")


def table_of_scenes() -> str:
    """The table of README.md: every scene with its title, in teaching order."""
    rows = [f"| `{name}` | {scene(name).title} |" for name in scene_names()]
    return "\n".join(["| scene | what it is |", "|---|---|", *rows])
