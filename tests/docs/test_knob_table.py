"""The table of knobs in docs/model.md is `QUANTITIES`, and the docstring of `Scene` has every knob with its unit."""

from __future__ import annotations

import re

import pytest
from documents import ROOT

from granchain_core import Scene
from granchain_core.quantities import QUANTITIES, Quantity

TEXT = (ROOT / "docs" / "model.md").read_text(encoding="utf-8")


def short(value: float) -> str:
    """1e6 for 1000000.0 and 0.01 for 0.01."""
    return re.sub(r"e([+-]?)0*(\d+)", lambda found: f"e{found[1].strip('+')}{found[2]}", f"{value:g}")


def allowed(knob: Quantity) -> str:
    """The values that a knob takes, in words."""
    words = ", ".join(f"`{word}`" for word in knob.choices)
    if not knob.numeric:
        return words
    numbers = f"{short(knob.low)} to {short(knob.high)}"
    return f"{words}, or {numbers}" if words else numbers + (", whole" if knob.whole else "")


def row(knob: Quantity) -> str:
    """A knob's row: name, symbol, unit, values, meaning."""
    return f"| `{knob.name}` | {knob.symbol or '–'} | {knob.unit or '–'} | {allowed(knob)} | {knob.meaning} |"


def test_the_table_of_knobs_is_the_codes() -> None:
    """The whole table is in the message, to be copied."""
    expected = "\n".join(row(knob) for knob in QUANTITIES.values())
    found = re.search(r"\| knob \|.*\n\|[-|]+\|\n((?:\|.*\n)+)", TEXT)
    assert found is not None
    assert found[1].rstrip() == expected, expected


@pytest.mark.parametrize("knob", [one for one in QUANTITIES.values() if one.name != "kappa"], ids=lambda knob: knob.name)
def test_the_docstring_of_a_scene_has_the_knob_and_its_unit(knob: Quantity) -> None:
    entry = re.search(rf"^    (?:\w+, )*{knob.name}(?:, \w+)* : .*\n((?: {{8}}.*\n)+)", str(Scene.__doc__), re.MULTILINE)
    assert entry is not None
    assert knob.unit in ("", "1") or f"[{knob.unit}]" in entry[1]
