"""Options that several commands share."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from typing import Any

from granchain_core import BadInput
from granchain_core.inputs.text import number_in, whole_in


def number(text: str) -> float:
    """Read the number of an option in the same way as a knob's value."""
    value = number_in(text)
    if value is None:
        raise argparse.ArgumentTypeError(f"{text[:40]!r} is not a number")
    return value


def whole(text: str) -> int:
    """Read the whole number of an option."""
    value = whole_in(text)
    if value is None:
        raise argparse.ArgumentTypeError(f"{text[:40]!r} is not a whole number")
    return value


def add_scene(parser: argparse.ArgumentParser) -> None:
    """Add SCENE and the changes of its knobs."""
    parser.add_argument("scene", metavar="SCENE", help="a name of `granchain scenes`, or a scene file NAME.toml")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", help="change a knob")


def add_json(parser: argparse.ArgumentParser) -> None:
    """Add --json, the choice between words and one JSON object."""
    parser.add_argument("--json", action="store_true", help="print one JSON object on stdout")


def add_result(parser: argparse.ArgumentParser, accuracy: str = "") -> None:
    """Add a scene, the requested accuracy (`accuracy` ends its help text), and the file for the result."""
    add_scene(parser)
    parser.add_argument("--accuracy", metavar="E", help=f"the same as --set accuracy=E{accuracy}")
    add_out(parser)
    add_json(parser)


def add_out(parser: argparse.ArgumentParser) -> None:
    """Add the file for the result."""
    parser.add_argument("--out", metavar="FILE", help="write an HDF5 file")


def add_scheduler(parser: argparse.ArgumentParser) -> None:
    """Add the scheduler whose workers compute; `scheduler_of` opens its client."""
    parser.add_argument("--scheduler", metavar="ADDRESS", help="compute on the workers of a Dask scheduler")


def scheduler_of(arguments: argparse.Namespace) -> AbstractContextManager[Any]:
    """Return a context manager with a client of the scheduler that --scheduler names; without the option, with None.

    Raise `BadInput` if no scheduler answers.
    """
    if arguments.scheduler is None:
        return nullcontext()
    from granchain_core.scheduler import connect

    client: AbstractContextManager[Any] = connect(arguments.scheduler)
    return client


def values_from(option: str, text: str, most: int) -> tuple[str, tuple[float, float], Callable[[float, float], Any]]:
    """Read NAME=a:b:n or NAME=a:b:n:log: the name, both ends, and a function that spaces n values between any two."""
    import numpy as np

    name, equals, values = text.partition("=")
    parts = values.split(":")
    logarithmic = len(parts) == 4 and parts[3] == "log"
    if not equals or not (len(parts) == 3 or logarithmic):
        raise BadInput(f"{option} {text[:60]!r} must have the form KNOB=a:b:n or KNOB=a:b:n:log, for example "
                       "f=30:3000:100.")
    ends = (_end(option, parts[0]), _end(option, parts[1]))
    count = whole_in(parts[2])
    if count is None:
        raise BadInput(f"{option}: the number of points {parts[2][:40]!r} must be a whole number from 1 to {most}.")
    if not 1 <= count <= most:
        raise BadInput(f"{option}: {count} points are outside 1 to {most}; the nearest valid value is "
                       f"{min(max(count, 1), most)}.")
    if (count == 1) != (ends[0] == ends[1]):
        raise BadInput(f"{option} {text[:60]!r}: from {parts[0]} to {parts[1]} there are "
                       f"{'one point' if ends[0] == ends[1] else 'at least two points'}, not {count}.")
    if logarithmic and min(ends) <= 0.0:
        raise BadInput(f"{option} {text[:60]!r}: logarithmic spacing needs both ends above 0; leave out :log.")
    spaced = np.geomspace if logarithmic else np.linspace
    return name, ends, lambda low, high: spaced(low, high, count)


def _end(option: str, text: str) -> float:
    value = number_in(text)
    if value is None:
        raise BadInput(f"{option}: {text[:40]!r} is not a number.")
    return value
