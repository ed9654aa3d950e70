"""`granchain check`: the hard cases, with each value, its limit and the verdict."""

from __future__ import annotations

import argparse
import html
import re
import time
from typing import TYPE_CHECKING, Any

from .common import finite_or_null, say, show_json
from .options import add_json
from .picture import add_option as add_picture
from .picture import check_picture, write_figure

if TYPE_CHECKING:
    from granchain_core.hard_cases import Check


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of `check`."""
    parser.add_argument("--quick", action="store_true", help="smaller counts: seconds instead of a minute")
    add_json(parser)
    add_picture(parser)


def do(arguments: argparse.Namespace) -> int:
    """Run all hard cases; return 3, the exit status, if a value is above its limit, and name it on stderr."""
    from granchain_core.hard_cases.runner import in_order, run_cases
    from granchain_core.hard_cases.table import CASES

    check_picture(arguments.picture)
    began, rows_by_case = time.perf_counter(), {}
    for name, rows in run_cases(arguments.quick):
        rows_by_case[name] = rows
        _say_case(f"{len(rows_by_case):2}/{len(CASES)}", name, rows)
    every = in_order(rows_by_case)
    if arguments.json:
        show_json({"rows": [{"case": row.title, "figure": finite_or_null(row.value), "bar": row.limit,
                             "passed": row.passed, "seconds": row.seconds} for row in every]})
    else:
        _show_cases(rows_by_case)
    say(f"{sum(row.passed for row in every)} of {len(every)} rows passed in {time.perf_counter() - began:.1f} s")
    if arguments.picture:
        write_figure(arguments.picture, "The hard cases", _drawn())
    missed = [row.title for row in every if not row.passed]
    if missed:
        say(f"{len(missed)} of {len(every)} values are above their limits: {'; '.join(missed)}.")
    return 3 if missed else 0


def _say_case(number: str, name: str, rows: list[Check]) -> None:
    """Report on stderr whether a case passed, with the values above their limits."""
    verdict = "passed" if all(row.passed for row in rows) else "FAILED"
    say(f"{number}  {name}: {verdict}, {rows[0].seconds:.1f} s")
    for row in rows:
        if not row.passed:
            say(f"       {row.value:.2e} is above {row.limit:.1e}: {row.measurement} {row.note}")


def _show_cases(rows_by_case: dict[str, list[Check]]) -> None:
    """Print every case with its rows."""
    from granchain_core.hard_cases.table import CASES

    for case in CASES:
        print(f"\n{case.name}\n  {case.hard}\n  Naive: {case.naive}\n  Oracle: {case.oracle}.")
        for row in rows_by_case[case.name]:
            mark = "ok  " if row.passed else "FAIL"
            note = f"  ({row.note})" if row.note else ""
            print(f"  {mark} {row.value:9.2e} ≤ {row.limit:7.1e}  {row.measurement}{note}")


def _drawn() -> Any:
    """Draw every case that has a picture, one below the other."""
    from bokeh.layouts import column
    from bokeh.models import Div

    from granchain_core.hard_cases.table import CASES

    from ..plots.check import check as drawn
    from ..plots.theme import THEMES

    shown = [(case.name, case.picture()) for case in CASES if case.picture is not None]
    models = [model for name, picture in shown for model in (Div(text=heading(name)), drawn(picture, THEMES["light"]))]
    return column(*models, sizing_mode="stretch_width")


def heading(name: str) -> str:
    """Return the name of a case with a capital letter and with powers, such as "10^5" and "F^{1/6}", raised."""
    raised = re.sub(r"\^\{([^}]+)\}|\^(-?\d+)", lambda match: f"<sup>{match[1] or match[2]}</sup>", html.escape(name))
    return f"<h3>{raised[0].upper()}{raised[1:]}</h3>"
