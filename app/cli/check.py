"""`granchain check`: the hard cases with figure, bar and verdict."""

from __future__ import annotations

import argparse
import html
import json
import math
import re
import time
from typing import Any

from app.cli.commands import say
from app.cli.options import add_json
from app.cli.picture import add_option as add_picture
from app.cli.picture import check_picture, write_picture


def add_options(parser: argparse.ArgumentParser) -> None:
    """What `check` takes."""
    parser.add_argument("--quick", action="store_true", help="smaller counts: seconds instead of a minute")
    add_json(parser)
    add_picture(parser)


def check(arguments: argparse.Namespace) -> int:
    """Run all hard cases; the exit status is 3 where a row is above its bar, and stderr names it."""
    from granchain_core.hard.runner import in_order, run_cases
    from granchain_core.hard.table import CASES

    check_picture(arguments.picture)
    began, found = time.perf_counter(), {}
    for name, rows in run_cases(arguments.quick):
        found[name] = rows
        verdict = "passed" if all(row.passed for row in rows) else "FAILED"
        say(f"{len(found):2}/{len(CASES)}  {name}: {verdict}, {rows[0].seconds:.1f} s")
        for row in rows:
            if not row.passed:
                say(f"       {row.figure:.2e} is above {row.bar:.1e}: {row.case.removeprefix(name + ': ')} {row.note}")
    every = in_order(found)
    if arguments.json:
        print(json.dumps({"rows": [{"case": row.case, "figure": row.figure if math.isfinite(row.figure) else None,
                                    "bar": row.bar, "passed": row.passed, "seconds": row.seconds} for row in every]},
                         allow_nan=False))
    else:
        for case in CASES:
            print(f"\n{case.name}\n  {case.hard}\n  Naive: {case.naive}\n  Oracle: {case.oracle}.")
            for row in found[case.name]:
                mark = "ok  " if row.passed else "FAIL"
                note = f"  ({row.note})" if row.note else ""
                print(f"  {mark} {row.figure:9.2e} ≤ {row.bar:7.1e}  {row.case.removeprefix(case.name + ': ')}{note}")
    say(f"{sum(row.passed for row in every)} of {len(every)} rows passed in {time.perf_counter() - began:.1f} s")
    write_picture(arguments.picture, "The hard cases", _drawn)
    missed = [row.case for row in every if not row.passed]
    if missed:
        say(f"{len(missed)} of {len(every)} rows are above their bars: {'; '.join(missed)}.")
    return 3 if missed else 0


def _drawn(theme: Any) -> Any:
    """Every case that has a picture, one below the other."""
    from bokeh.layouts import column
    from bokeh.models import Div

    from app.pictures.check import check as drawn
    from granchain_core.hard.table import CASES

    shown = [(case.name, case.picture()) for case in CASES if case.picture is not None]
    models = [model for name, picture in shown for model in (Div(text=heading(name)), drawn(picture, theme))]
    return column(*models, sizing_mode="stretch_width")


def heading(name: str) -> str:
    """The name of a case with a capital letter, and with its powers, "10^5" and "F^{1/6}", raised."""
    raised = re.sub(r"\^\{([^}]+)\}|\^(-?\d+)", lambda found: f"<sup>{found[1] or found[2]}</sup>", html.escape(name))
    return f"<h3>{raised[0].upper()}{raised[1:]}</h3>"
