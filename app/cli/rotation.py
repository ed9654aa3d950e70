"""`granchain rotation`: the rotation number and the second frequency of a quasi-periodic motion."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING, Any

from .common import chosen_scene, in_background, show_json, show_percent
from .options import add_json, add_out, add_scene, whole
from .picture import add_option as add_picture
from .picture import check_files, write_files

if TYPE_CHECKING:
    from granchain_core import RotationNumber


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of `rotation`."""
    add_scene(parser)
    parser.add_argument("--periods", type=whole, default=4000, metavar="P",
                        help="drive periods of the first record; up to two follow, each twice as long")
    add_out(parser)
    add_json(parser)
    add_picture(parser)


def do(arguments: argparse.Namespace) -> None:
    """Compute the rotation number of the motion that a scene settles to."""
    from granchain_core import rotation_number

    chosen = chosen_scene(arguments)
    check_files(arguments)
    progress = show_percent if sys.stderr.isatty() else None
    result = in_background(lambda stop: rotation_number(chosen, arguments.periods, stop=stop, progress=progress),
                           reports=True)
    write_files(arguments, f"Rotation number of {chosen.name}", result)
    if arguments.json:
        show_json(_json(result))
        return
    for line in result.summary():
        print(f"{chosen.name}: {line}")


def _json(result: RotationNumber) -> dict[str, Any]:
    nearest = result.nearest_fraction
    return {"regime": result.regime.name, "rotation_number": result.value, "error": result.error,
            "average_error": result.average_error, "step_error": result.step_error, "curves": result.curves,
            "second_frequency": result.second_frequency, "second_frequency_error": result.second_frequency_error,
            "nearest_fraction": None if nearest is None else [nearest.numerator, nearest.denominator],
            "fraction_distance": result.fraction_distance, "projections": result.projections, "reason": result.reason,
            "periods": result.periods,
            "convergence": None if result.value is None else result.convergence.tolist()}
