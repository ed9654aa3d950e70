"""The Accuracy page: error against time for every method, the table of methods, what naive steps would have drawn."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from granchain_core.accuracy import Lesson, Row, WorkPrecision, ways

from ...page.format import duration, short_error
from ...page.frames import prefixed
from ...parts.component import Component, text
from ...scripts import module

_PALETTE = ("#e0900a", "#9b6bf2", "#0fa3b8", "#d6489a", "#a97142", "#86a316", "#6d7fd8", "#c26a52")
_MARKS = ("circle", "square", "diamond", "triangle", "hexagon", "star", "down", "pentagon")
_LOST = 1e-4
"""References that differ by more than this belong to a motion that nobody can follow for ten periods."""
_NAIVE_MARKS, _NAIVE_COLOUR = ("x", "plus", "star"), "#8a8f98"


class Accuracy(Component):
    """The page over the pictures; points, lines and text come in `state`, the drawn forces as one message."""

    _esm = module("accuracy.js")
    _stylesheets = [text("controls.css"), text("drawing.css"), text("accuracy.css")]  # noqa: RUF012


def described_ways() -> list[dict[str, Any]]:
    """The table of methods with a mark for each: by shape and fill told apart without colour, too."""
    shown, naive, other = [], 0, 0
    for way in ways().values():
        if way.family == "naive":
            mark, colour = _NAIVE_MARKS[naive % len(_NAIVE_MARKS)], _NAIVE_COLOUR
            naive += 1
        else:
            mark, colour = _MARKS[other % len(_MARKS)], _PALETTE[other % len(_PALETTE)]
            other += 1
        shown.append({"name": way.name, "title": way.title, "family": way.family, "order": f"{way.order:g}",
                      "restrictions": way.restrictions, "reference": way.reference, "mark": mark, "colour": colour})
    return shown


def described_rows(rows: list[Row]) -> list[dict[str, Any]]:
    """The rows as the browser draws them; what has no finite error has the sentence that says why."""
    return [{
        "way": row.method, "setting": row.setting, "rhs": row.rhs, "ms": 1e3 * row.wall_s,
        "error": row.error if math.isfinite(row.error) else None,
        "failure": row.failure or ("" if math.isfinite(row.error) else "Its numbers are not finite."),
        "told": f"error {row.error:.2g}, {duration(row.wall_s)}, {row.rhs} evaluations",
    } for row in rows]


def described_reference(found: WorkPrecision) -> dict[str, Any]:
    """The reference, the second one, and how far they are apart."""
    known = math.isfinite(found.agreement)
    if found.disagreement:
        words = f"The second reference failed: {found.disagreement}"
    elif found.agreement > _LOST:
        words = (f"Two references differ by {short_error(found.agreement)}: this motion amplifies every error, "
                 "so smaller ones mean nothing here.")
    elif known:
        words = f"Two independent references agree to {short_error(found.agreement)}."
    else:
        words = "The second reference comes last."
    return {"reference": found.reference, "second": found.second, "agreement": found.agreement if known else None,
            "agreement_words": words}


def lesson_message(lesson: Lesson) -> dict[str, Any]:
    """The certified and the naive output forces, in one array of rows; a naive one that failed has no row."""
    largest = float(np.abs(lesson.force).max())
    factor, letter = prefixed(largest)
    seconds, unit = prefixed(float(lesson.time[-1]))
    drawn = [one for one in lesson.drawn if not one.failure]
    rows = [lesson.time / seconds, lesson.force / factor, *(one.force / factor for one in drawn)]
    return {
        "type": "lesson", "columns": len(lesson.time), "unit": f"{letter}N", "time_unit": f"{unit}s",
        "drawn": [{"method": one.method, "steps": one.steps, "failure": one.failure,
                   "error": None if one.failure else one.error,
                   "row": -1 if one.failure else 2 + drawn.index(one)} for one in lesson.drawn],
        "values": np.concatenate(rows, dtype=np.float32),
    }
