"""`granchain accuracy`: the cost of accuracy, as error against time for every method."""

from __future__ import annotations

import argparse
import sys
from dataclasses import asdict
from typing import Any

from .common import chosen_scene, finite_or_null, in_background, show_json, show_percent
from .options import add_json, add_out, add_scene
from .picture import add_option as add_picture
from .picture import check_files, write_files


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of `accuracy`."""
    add_scene(parser)
    add_out(parser)
    add_json(parser)
    add_picture(parser)


def do(arguments: argparse.Namespace) -> None:
    """Measure error against time for every method."""
    from granchain_core.accuracy import work_precision

    check_files(arguments)
    chosen = chosen_scene(arguments)
    progress = show_percent if sys.stderr.isatty() else None
    result = in_background(lambda stop: work_precision(chosen, stop, progress), reports=True)
    write_files(arguments, f"What accuracy costs for {chosen.name}", result)
    if arguments.json:
        show_json(_accuracy_json(result))
    else:
        _show_accuracy(result)


def _accuracy_json(result: Any) -> dict[str, Any]:
    """Return the measurement as one JSON object; "naive" has the output force's error with plain steps in (u, v)."""
    naive = [{"method": line.method, "steps_per_period": line.steps,
              "output_force_error": finite_or_null(line.error), "failure": line.failure}
             for line in result.naive.lines]
    return {
        "reference": {"method": result.reference, "agreement": finite_or_null(result.agreement),
                      "second": result.second, "disagreement": result.disagreement},
        "rows": [{**asdict(row), "error": finite_or_null(row.error)} for row in result.rows],
        "naive": naive,
    }


def _show_accuracy(result: Any) -> None:
    """Print the measurement as a table; below it, the cheapest methods for three accuracies and the naive forces."""
    print(f"reference: {result.reference}")
    print(f"second reference: {result.second}: " + (result.disagreement or f"agrees to {result.agreement:.1e}"))
    print("method          setting                   error     time_ms  evaluations")
    for row in result.rows:
        if row.failure:
            print(f"{row.method:14}  {row.setting:22}  failed: {row.failure}")
            continue
        print(f"{row.method:14}  {row.setting:22}  {row.error:8.1e}  {1e3 * row.wall_s:8.2f}  {row.rhs:11d}")
    for error in (1e-3, 1e-6, 1e-9):
        best = result.cheapest(error)
        if best is not None:
            print(f"the cheapest way to {error:g} is {best.method}, {best.setting}: {1e3 * best.wall_s:.2f} ms")
    for line in result.naive.lines if result.naive else ():
        outcome = line.failure or f"off by {100 * line.error:.2g} % of the largest"
        print(f"output force by {line.method} with {line.steps} steps per period: {outcome}")
