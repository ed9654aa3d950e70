"""The Hard cases page: a card for each case, with values, limits and a figure that includes a naive solver."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any

from granchain_core.hard_cases import CASES, Check, Picture

from ...format import duration
from ...parts.figures.result_figure import ResultFigure
from ...parts.toolkit.component import text
from ...plots.check import check
from ...scripts import module

ABOUT = ("Cases in which solvers of granular chains go wrong without warning. Each is compared with a known result and "
         "must stay below its limit.")


class HardCases(ResultFigure):
    """The overlay; rows are in `state`, and each figure is sent as a message after its case was run."""

    _esm = module("hard_cases.js")
    _stylesheets = [text("controls.css"), text("hard_cases.css")]  # noqa: RUF012

    def __init__(self, receive: Callable[[dict[str, Any]], None] | None = None, **params: Any) -> None:
        super().__init__(receive, state={"cases": described_cases(), "about": ABOUT}, **params)

    def draw(self, name: str, data: Picture) -> None:
        """Replace the figure of a case."""
        labels = "; ".join(trace.label for trace in data.traces)
        self.show_figure(partial(check, data), f"{data.y_label} over {data.x_label}: {labels}", place=name)


def described_cases() -> list[dict[str, Any]]:
    """Return the cases in words, before anything is run."""
    return [{"name": case.name, "hard": case.hard, "naive": case.naive, "oracle": case.oracle}
            for case in CASES]


def digits_of(value: float, digits: int) -> str:
    """Return a number to `digits` significant digits, such as "7.1e-13", without leading zeros in the exponent."""
    mantissa, _, exponent = f"{value:.{digits}g}".partition("e")
    return f"{mantissa}e{int(exponent)}" if exponent else mantissa


def value_beside(value: float, limit: float) -> str:
    """Return a value to two digits, or to more if they are needed to show on which side of its limit it is."""
    if not math.isfinite(value):
        return "no number" if math.isnan(value) else "infinite"
    for digits in range(2, 17):
        shown = digits_of(value, digits)
        if (float(shown) <= limit) == (value <= limit):
            return shown
    return repr(value)


def described_results(name: str, rows: list[Check]) -> dict[str, Any]:
    """Return the rows of one case as the browser shows them, and its time.

    A value that could not be computed has a note that says why.
    """
    return {"time": duration(rows[0].seconds), "rows": [
        {"what": row.measurement, "value": value_beside(row.value, row.limit),
         "limit": digits_of(row.limit, 3), "passed": row.passed, "note": row.note} for row in rows]}


def summary(rows_by_case: dict[str, list[Check]]) -> str:
    """Return one sentence about everything that was run; the first failed row is named with its value."""
    every = [row for case in CASES for row in rows_by_case.get(case.name, ())]
    if not every:
        return ""
    missed = [row for row in every if not row.passed]
    run = f"{len(rows_by_case)} of {len(CASES)} cases run"
    if not missed:
        return f"{run}: no value of {len(every)} is above its limit."
    first = missed[0]
    more = f", and {len(missed) - 1} more" if len(missed) > 1 else ""
    return (f"{run}: {len(missed)} of {len(every)} values FAILED: "
            f"{first.title}, {value_beside(first.value, first.limit)} against {digits_of(first.limit, 3)}{more}.")
