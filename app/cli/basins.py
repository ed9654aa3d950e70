"""`granchain basins`: the steady state that each start in a plane leads to."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING, Any

from .common import chosen_scene, in_background, show_json, show_percent
from .options import add_json, add_scene, values_from
from .picture import add_option as add_picture
from .picture import check_picture, write_picture

if TYPE_CHECKING:
    from granchain_core import Basins


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of `basins`."""
    add_scene(parser)
    for name, example in (("--x", "u1=-1e-6:1e-6:40"), ("--y", "v1=-0.01:0.01:40")):
        parser.add_argument(name, required=True, metavar="COORDINATE=a:b:n",
                            help=f"n values of a bead's displacement u [m] or velocity v [m/s]; for example {example}")
    add_json(parser)
    add_picture(parser)


def do(arguments: argparse.Namespace) -> None:
    """Compute the basins of a plane of starts."""
    from granchain_core import basins
    from granchain_core.analysis.basins import MOST_CELLS

    chosen = chosen_scene(arguments)
    check_picture(arguments.picture)
    (x, x_ends, x_spaced), (y, y_ends, y_spaced) = (
        values_from(option, text, MOST_CELLS) for option, text in (("--x", arguments.x), ("--y", arguments.y)))
    progress = show_percent if sys.stderr.isatty() else None
    found = in_background(lambda stop: basins(chosen, (x, x_spaced(*x_ends)), (y, y_spaced(*y_ends)), stop, progress),
                          reports=True)
    write_picture(arguments.picture, f"Basins of {chosen.name}", found)
    if arguments.json:
        show_json(_json(found))
        return
    print("share  max_output_force_N  motion")
    for share, one in zip(found.shares, found.attractors, strict=True):
        print(f"{100.0 * share:4.0f}%  {one.max_output_force:18.6g}  {one.regime.sentence}")


def _json(found: Basins) -> dict[str, Any]:
    return {"x": {"coordinate": found.x[0], "values": found.x[1].tolist()},
            "y": {"coordinate": found.y[0], "values": found.y[1].tolist()}, "number": found.number.tolist(),
            "attractors": [{"share": float(share), "regime": one.regime.name, "period": one.regime.period,
                            "max_output_force": one.max_output_force, "stable": one.stable}
                           for share, one in zip(found.shares, found.attractors, strict=True)]}
