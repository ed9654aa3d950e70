"""The knobs in the docstring of `Scene`, from the table of knobs."""

from __future__ import annotations

import textwrap

from .quantities import QUANTITIES, Quantity


def with_knobs(docstring: str | None) -> str | None:
    """Return `Scene`'s docstring with all knobs that are fields among its attributes; None if Python has dropped it."""
    if docstring is None:
        return None
    attributes, heading, rest = docstring.partition("\n    Notes\n")
    knobs = "".join(_entry(knob) for knob in QUANTITIES.values() if knob.name != "kappa")  # a property: k/(K√A0)
    return attributes + knobs + heading + rest


def _entry(knob: Quantity) -> str:
    """Return a knob's name, type, label, unit and meaning as an attribute in a NumPy docstring."""
    unit = f" [{knob.unit}]" if knob.unit not in ("", "1") else ""
    words = [f'"{word}"' for word in knob.choices]
    values = f" One of {', '.join(words)}" + (", or a number." if knob.numeric else ".") if words else ""
    title = knob.label[0].upper() + knob.label[1:]
    text = textwrap.fill(f"{title}{unit}. {knob.meaning}{values}", 112)
    return f"    {knob.name} : {_type(knob)}\n" + textwrap.indent(text, "        ") + "\n"


def _type(knob: Quantity) -> str:
    if knob.choices:
        return "str or float" if knob.numeric else "str"
    return "int" if knob.whole else "float"
