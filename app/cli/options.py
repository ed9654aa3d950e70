"""Options that several commands share."""

from __future__ import annotations

import argparse

from granchain_core.text import number_in, whole_in


def number(text: str) -> float:
    """The number of an option, read as that of a knob."""
    found = number_in(text)
    if found is None:
        raise argparse.ArgumentTypeError(f"{text[:40]!r} is not a number")
    return found


def whole(text: str) -> int:
    """The whole number of an option."""
    found = whole_in(text)
    if found is None:
        raise argparse.ArgumentTypeError(f"{text[:40]!r} is not a whole number")
    return found


def add_scene(parser: argparse.ArgumentParser) -> None:
    """Add SCENE and the changes of its knobs."""
    parser.add_argument("scene", metavar="SCENE")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", help="change a knob")


def add_json(parser: argparse.ArgumentParser) -> None:
    """Add the choice between words and one JSON object."""
    parser.add_argument("--json", action="store_true", help="print one JSON object on stdout")


def add_result(parser: argparse.ArgumentParser) -> None:
    """Add a scene, the accuracy asked for, and the file that keeps the result."""
    add_scene(parser)
    parser.add_argument("--accuracy", metavar="E", help="the same as --set accuracy=E")
    parser.add_argument("--out", metavar="FILE", help="write an HDF5 file")
    add_json(parser)
