"""The table of knobs in docs/model.md is `QUANTITIES`."""

from __future__ import annotations

import re

from documents import ROOT

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
