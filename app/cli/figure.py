"""`granchain figure N`: a figure of the paper with our numbers, drawn or as a table."""

from __future__ import annotations

import argparse
import csv
import io
import sys
from pathlib import Path
from typing import Any

from granchain_core import BadInput

from ..plots.theme import THEMES
from .common import in_background, say, show_percent
from .data_options import add_answers, with_answers

_KINDS = (".html", ".htm", ".png", ".svg", ".csv")


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of `figure`."""
    parser.add_argument("number", metavar="N", help="1 to 12, 3a or 3b; 'list' shows what each is about")
    parser.add_argument("--out", metavar="FILE", help="FILE.html, .png, .svg or .csv; figure-N.html by default")
    parser.add_argument("--data", action="append", default=[], metavar="[HZ=]FILE",
                        help="a measurement of yours to draw over it: a curve, the shaker's amplitude, or a series (HZ "
                             "is its frequency in the paper); CSV in any dialect, WebPlotDigitizer, HDF5, netCDF-4")
    add_answers(parser)
    parser.add_argument("--theme", default="light", metavar="|".join(THEMES), help="colours of the picture")


def do(arguments: argparse.Namespace) -> None:
    """Compute a figure and write it."""
    from granchain_core.paper import FIGURES, compute, figure_of, read_given
    from granchain_core.store import check_writable

    if arguments.number == "list":
        for figure in FIGURES.values():
            print(f"{figure.number:>3}  {figure.title}")
        return
    figure = figure_of(arguments.number)
    out = arguments.out or f"figure-{figure.number}.html"
    kind = _checked(out, arguments.theme)
    check_writable(out)
    given = with_answers(arguments, lambda answers: read_given(figure.number, figure.takes, figure.frequencies,
                                                               arguments.data, answers))
    for sentence in given.sentences:
        say(sentence)
    progress = show_percent if sys.stderr.isatty() else _quiet
    result = in_background(lambda stop: compute(figure.number, given, stop, progress), reports=True)
    Path(out).write_bytes(_written(figure, result, kind, arguments.theme))
    print(f"figure {figure.number}: {figure.title}; {out}")


def _quiet(_: float) -> None:
    """Show no progress, which is only for a person at a terminal."""


def _checked(name: str, theme: str) -> str:
    """Return the kind of file, or raise `BadInput`, before anything is computed, if it cannot be written."""
    from granchain_core.inputs.checks import unknown_name

    kind = Path(name).suffix.lower()
    if kind not in _KINDS:
        raise BadInput(f"A figure is written as .html, .png, .svg or .csv; name it "
                       f"{Path(name).with_suffix('.html')}, not {name}.")
    if theme not in THEMES:
        raise unknown_name("theme", theme, THEMES)
    if kind in (".png", ".svg"):
        from ..headless.browser import browser

        browser()
    return kind


def _written(figure: Any, result: Any, kind: str, theme: str) -> bytes:
    """Return the content of the file."""
    if kind == ".csv":
        return table_of(result).encode("utf-8")
    from ..headless.browser import png_of, svg_of
    from ..plots.file import captioned_html
    from ..plots.paper import paper_figure, size_of

    colours = THEMES[theme]
    drawn, title = paper_figure(result, colours), f"Figure {figure.number}: {figure.title}"
    if kind == ".png":
        return png_of(drawn, title, figure.caption, colours, size_of(result))
    if kind == ".svg":
        return svg_of(drawn, title, figure.caption, colours, size_of(result)).encode("utf-8")
    return captioned_html(drawn, title, figure.caption, colours).encode("utf-8")


def table_of(result: Any) -> str:
    """Return the numbers of a figure as CSV, in columns with units; a field is empty if its row has no such number."""
    rows = list(result.rows())
    names = list(dict.fromkeys(name for row in rows for name in row))
    file = io.StringIO()
    writer = csv.DictWriter(file, names, lineterminator="\n")
    writer.writeheader()
    for row in rows:
        writer.writerow({name: _number(value) for name, value in row.items()})
    return file.getvalue()


def _number(value: Any) -> Any:
    """Return a number with nine significant figures, and any other value unchanged."""
    return f"{value:.9g}" if isinstance(value, float) else value
