"""The Accuracy page's view: error against time, the table of methods, and the forces of naive methods."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from granchain_core.accuracy import NaiveComparison, Row, WorkPrecision, compared_methods

from ...format import prefixed, short_error
from ...parts.figures.streamed_figure import StreamedFigure, page_and_small
from ...parts.toolkit.component import text
from ...plots.accuracy import Annotations, accuracy, marks, points
from ...plots.json_item import figure_item
from ...plots.naive_forces import naive_forces
from ...plots.theme import Theme
from ...scripts import module

#: If the references differ by more than this, the motion is too sensitive to be computed for ten periods.
_LARGEST_DISAGREEMENT = 1e-4


@cache
def empty_figures(theme: Theme) -> dict[str, Any]:
    """Return error against time without points, for the page and, small, for its tab."""
    return page_and_small(lambda compact: accuracy([], Annotations(1e-6), theme, compact))


class Accuracy(StreamedFigure):
    """The overlay. `state` has the text and the figures; the figures' data are sent as messages."""

    _esm = module("accuracy.js")
    _stylesheets = [text("controls.css"), text("accuracy.css")]  # noqa: RUF012
    empty_figures = staticmethod(empty_figures)

    def __init__(self, receive: Callable[[dict[str, Any]], None] | None = None, **params: Any) -> None:
        super().__init__(receive, **params)
        self._naive: NaiveComparison | None = None

    def apply_theme(self, theme: Theme) -> None:
        """Draw the figures, including that of the forces, in another theme."""
        super().apply_theme(theme)
        if self._naive is not None:
            self.show_naive(self._naive)

    def measured(self, rows: list[Row], reference: dict[str, Any]) -> None:
        """Show the rows measured so far and the agreement of the references."""
        self.need_figures()
        self.update_state(rows=described_rows(rows), drawn=points(rows), **reference)

    def mark(self, rows: list[Row], annotations: Annotations, stale: bool, sentence: str, used: str) -> None:
        """Mark the requested accuracy, the cheapest setting and the present one.

        `stale`: the rows are of another chain. `sentence` names the cheapest setting, `used` the present one.
        """
        self.send(type="asked", marks=marks(annotations, rows), stale=stale, sentence=sentence, used=used)

    def show_naive(self, shown: NaiveComparison) -> None:
        """Show the forces that naive steps would have drawn."""
        self._naive = shown
        self.send(**naive_message(shown, self.theme))

    def forget(self) -> None:
        """Remove everything that was measured."""
        self._naive = None
        self.update_state(rows=[], drawn={}, agreement_words="", reference="", second="")
        self.send(type="no-naive")


def described_methods() -> list[dict[str, Any]]:
    """Return the table of methods."""
    return [{"name": method.name, "title": method.title, "order": f"{method.order:g}",
             "restrictions": method.restrictions, "reference": method.reference}
            for method in compared_methods().values()]


def described_rows(rows: list[Row]) -> list[dict[str, Any]]:
    """Return, for the table, the rows without a finite error: the setting, and a sentence with the reason."""
    failed = [(row, row.failure or "Its numbers are not finite.") for row in rows
              if row.failure or not math.isfinite(row.error)]
    return [{"way": row.method, "setting": row.setting, "failure": failure} for row, failure in failed]


def described_reference(result: WorkPrecision) -> dict[str, Any]:
    """Return the reference, the second reference, and their difference in words."""
    known = math.isfinite(result.agreement)
    if result.disagreement:
        words = f"The second reference failed: {result.disagreement}"
    elif result.agreement > _LARGEST_DISAGREEMENT:
        words = (f"Two references differ by {short_error(result.agreement)}: this motion amplifies every error, "
                 "so errors below that mean nothing here.")
    elif known:
        words = f"Two independent references agree to {short_error(result.agreement)}."
    else:
        words = "The second reference is computed last."
    return {"reference": result.reference, "second": result.second, "agreement_words": words}


def naive_message(shown: NaiveComparison, theme: Theme) -> dict[str, Any]:
    """Return the accurate and the naive output forces as one array of rows; a naive force that failed has no row."""
    largest = float(np.abs(shown.force).max())
    factor, letter = prefixed(largest)
    seconds, unit = prefixed(float(shown.time[-1]))
    lines = [line for line in shown.lines if not line.failure]
    rows = np.array([shown.time / seconds, shown.force / factor, *(line.force / factor for line in lines)],
                    dtype=np.float32)
    return {
        "type": "naive", "columns": len(shown.time),
        "figure": figure_item(naive_forces(rows[0], rows[1], None, f"{unit}s", f"{letter}N", theme)),
        "drawn": [{"method": line.method, "steps": line.steps, "failure": line.failure,
                   "error": None if line.failure else line.error,
                   "row": -1 if line.failure else 2 + lines.index(line)} for line in shown.lines],
        "values": rows.ravel(),
    }
