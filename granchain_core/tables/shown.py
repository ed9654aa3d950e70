"""The summary of a result: its scene, its most important numbers, and what it contains."""

from __future__ import annotations

import html
from collections.abc import Sequence

from ..scene import Scene
from ..scene.quantities import QUANTITIES
from .table import Table

_ROW = "text-align:left;background:none"


def as_text(heading: str, sentences: Sequence[str]) -> str:
    """Return the summary for a terminal."""
    return "\n".join([heading, *(f"  {sentence}" for sentence in sentences)])


def as_html(heading: str, sentences: Sequence[str], tables: Sequence[Table]) -> str:
    """Return the summary for a notebook: short enough for a cell, in the notebook's colours, with folded contents."""
    lines = "".join(f"<div>{html.escape(sentence)}</div>" for sentence in sentences)
    listed = "".join(_held(table) for table in tables)
    return (f"<div style='line-height:1.5'><b>{html.escape(heading)}</b>{lines}"
            f"<details><summary>names and units</summary>{listed}</details></div>")


def scene_in_words(scene: Scene, varied: Sequence[str] = ()) -> str:
    """Describe a scene, its frequency and the knobs that differ from its preset, except those that are `varied`.

    Without a drive, f is not a frequency of the motion, and 1/f is the unit of the recorded time.
    """
    knobs = {name: value for name, value in {"f": scene.f, **scene.differences()}.items() if name not in varied}
    if "k" in varied or "kappa" in varied:  # one quantity with two names
        knobs.pop("k", None)
    changed = [_knob(name, value) if name != "f" or scene.is_driven else f"time 1/f = {1.0 / value:.4g} s"
               for name, value in knobs.items()]
    return f"{scene.name}: {', '.join(changed)}" if changed else scene.name


def _knob(name: str, value: float | str) -> str:
    return f"{name} = {value:g}{_unit(name)}" if isinstance(value, float | int) else f"{name} = {value}"


def _unit(knob: str) -> str:
    unit = QUANTITIES[knob].unit
    return "" if unit in ("", "1") else f" {unit}"


def _held(table: Table) -> str:
    """List the axes and columns of a table."""
    rows = "".join(
        _row(f"<code>{html.escape(name)}</code>", ", ".join(column.axes), "" if column.unit == "1" else column.unit,
             html.escape(column.meaning)) for name, column in {**table.axes, **table.columns}.items())
    sizes = ", ".join(f"{name} {len(column.values)}" for name, column in table.axes.items())
    return f"<div><b>{html.escape(table.name)}</b> ({html.escape(sizes)})</div><table cellpadding='4'>{rows}</table>"


def _row(*cells: str) -> str:
    return f"<tr style={_ROW!r}>{''.join(f'<td align=left>{cell}</td>' for cell in cells)}</tr>"
