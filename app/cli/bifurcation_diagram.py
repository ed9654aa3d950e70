"""`granchain bifurcation-diagram`: a bead's strobes, its states once a drive period, over a knob."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING, Any

from granchain_core.inputs.checks import check_range

from .common import chosen_scene, in_background, say, show_json, show_percent
from .options import add_json, add_out, add_scene, values_from, whole
from .picture import add_option as add_picture
from .picture import check_files, write_files

if TYPE_CHECKING:
    from granchain_core import BifurcationDiagram


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of `bifurcation-diagram`."""
    add_scene(parser)
    parser.add_argument("--over", required=True, metavar="KNOB=a:b:n",
                        help="n values of a knob from a to b, evenly spaced or, with :log appended, logarithmically")
    parser.add_argument("--start", default="up", metavar="rest|up|down",
                        help="up and down carry the state along from value to value")
    parser.add_argument("--keep", type=whole, default=60, metavar="K", help="strobes at each value")
    parser.add_argument("--bead", type=whole, default=1, metavar="i", help="bead whose strobes are printed and drawn")
    add_out(parser)
    add_json(parser)
    add_picture(parser)


def do(arguments: argparse.Namespace) -> None:
    """Compute the bifurcation diagram of a scene."""
    from granchain_core import bifurcation_diagram
    from granchain_core.analysis.bifurcation_diagram import MOST_VALUES

    chosen = chosen_scene(arguments)
    check_files(arguments)
    check_range("--bead", arguments.bead, 1, chosen.N)
    knob, ends, spaced = values_from("--over", arguments.over, MOST_VALUES)
    progress = show_percent if sys.stderr.isatty() else None
    result = in_background(lambda stop: bifurcation_diagram(chosen, knob, spaced(*ends), arguments.start,
                                                            arguments.keep, stop, progress), reports=True)
    for point in result.points:
        if point.failure:
            say(f"{knob} = {point.value:g}: {point.failure}")
    write_files(arguments, f"Bifurcation diagram of {chosen.name}", result, bead=arguments.bead)
    if arguments.json:
        show_json(_json(result, arguments.bead))
        return
    print(f"{knob:>12}  distinct    error  regime")
    for point in result.points:
        error = "–" if point.strobe_error is None else f"{point.strobe_error:.1e}"
        print(f"{point.value:12.6g}  {point.distinct(arguments.bead):8d}  {error:>7}  "
              f"{point.failure or point.regime.sentence}")


def _json(result: BifurcationDiagram, bead: int) -> dict[str, Any]:
    return {"knob": result.knob, "start": result.start, "bead": bead,
            "values": [point.value for point in result.points],
            "regime": [point.regime.name for point in result.points],
            "period": [point.regime.period for point in result.points],
            "strobe_error": [point.strobe_error for point in result.points],
            "displacement": [point.strobes[:, 0, bead - 1].tolist() for point in result.points],
            "velocity": [point.strobes[:, 1, bead - 1].tolist() for point in result.points]}
