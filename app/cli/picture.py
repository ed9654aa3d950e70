"""`--picture FILE.html`: the figure of a result, as on the dashboard, in a self-contained file."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from granchain_core import BadInput

from .common import unbroken


def add_option(parser: argparse.ArgumentParser) -> None:
    """Add the option --picture."""
    parser.add_argument("--picture", metavar="FILE.html", help="draw the result into a self-contained HTML file")


def check_picture(name: str | None) -> None:
    """Refuse, before anything is computed, a file to which a picture cannot be written."""
    if name is None:
        return
    from granchain_core.store import check_writable

    if Path(name).suffix.lower() not in (".html", ".htm"):
        raise BadInput(f"--picture writes an HTML file; name it {Path(name).with_suffix('.html')}, not {name}.")
    check_writable(name)


def check_files(arguments: argparse.Namespace) -> None:
    """Refuse, before anything is computed, files to which the picture or the result cannot be written."""
    from granchain_core.store import check_writable

    check_picture(arguments.picture)
    if arguments.out:
        check_writable(arguments.out)


def write_picture(name: str | None, title: str, result: Any, **options: Any) -> None:
    """If a picture was asked for, write the one that `granchain.figure` draws of a result with these `options`."""
    if name is None:
        return
    from ..plots.any_result import stretched

    write_figure(name, title, stretched(result, **options))


def write_files(arguments: argparse.Namespace, title: str, result: Any, **options: Any) -> None:
    """Write the files that --out and --picture name; a signal waits until they are complete."""
    with unbroken(arguments.out):
        if arguments.out:
            from granchain_core import save

            save(result, arguments.out)
        write_picture(arguments.picture, title, result, **options)


def write_figure(name: str, title: str, figure: Any) -> None:
    """Write a figure of `app/plots` to an HTML file."""
    from ..plots.file import html_of

    Path(name).write_text(html_of(figure, title), encoding="utf-8")
