"""`granchain basins`: the steady state that each start in a plane leads to."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING, Any

import numpy as np

from granchain_core.precompile.pieces import BESIDE_A_BATCH

from .common import chosen_scene, in_background, show_json, show_percent
from .compiling import compiling_beside
from .options import add_json, add_out, add_scene, values_from
from .picture import add_option as add_picture
from .picture import check_files, write_files

if TYPE_CHECKING:
    from granchain_core import Basins


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of `basins`."""
    add_scene(parser)
    for name, example in (("--x", "u1=-1e-6:1e-6:40"), ("--y", "v1=-0.01:0.01:40")):
        parser.add_argument(name, required=True, metavar="COORDINATE=a:b:n",
                            help=f"n values of a bead's displacement u [m] or velocity v [m/s]; for example {example}")
    add_out(parser)
    add_json(parser)
    add_picture(parser)


def do(arguments: argparse.Namespace) -> None:
    """Compute the basins of a plane of starts."""
    from granchain_core import basins
    from granchain_core.analysis.basins import MOST_CELLS

    chosen = chosen_scene(arguments)
    check_files(arguments)
    (x, x_ends, x_spaced), (y, y_ends, y_spaced) = (
        values_from(option, text, MOST_CELLS) for option, text in (("--x", arguments.x), ("--y", arguments.y)))
    progress = show_percent if sys.stderr.isatty() else None
    starts = (x, x_spaced(*x_ends)), (y, y_spaced(*y_ends))
    with compiling_beside(chosen, *BESIDE_A_BATCH):
        result = in_background(lambda stop: basins(chosen, *starts, stop, progress), reports=True)
    write_files(arguments, f"Basins of {chosen.name}", result)
    if arguments.json:
        show_json(_json(result))
        return
    print("share  max_output_force_N  motion")
    for share, attractor in zip(result.shares, result.attractors, strict=True):
        print(f"{100.0 * share:4.0f}%  {attractor.max_output_force:18.6g}  {attractor.regime.sentence}")
    failed = result.number < 0
    if failed.any():
        print(f"{100.0 * failed.mean():4.0f}%  {'':18}  no steady state: {failed.sum()} of {failed.size} starts "
              f"failed, the first {_why(result, int(failed.argmax()))}")


def _why(result: Basins, number: int) -> str:
    """Compute a failed start again, and return its place in the plane and the reason why it has no steady state."""
    from granchain_core import ComputationError, State, settle

    row, column = divmod(number, len(result.x[1]))
    start = {"u": np.zeros(result.scene.N), "v": np.zeros(result.scene.N)}
    for (name, values), place in ((result.x, column), (result.y, row)):
        start[name[0]][int(name[1:]) - 1] = values[place]
    where = f"at {result.x[0]} = {result.x[1][column]:g}, {result.y[0]} = {result.y[1][row]:g}"
    try:
        in_background(lambda stop: settle(result.scene, State(start["u"], start["v"]), stop=stop))
    except ComputationError as problem:
        return f"{where}. {problem}"
    return f"{where}, after it had left an unstable orbit."


def _json(result: Basins) -> dict[str, Any]:
    return {"x": {"coordinate": result.x[0], "values": result.x[1].tolist()},
            "y": {"coordinate": result.y[0], "values": result.y[1].tolist()}, "number": result.number.tolist(),
            "attractors": [{"share": float(share), "regime": attractor.regime.name, "period": attractor.regime.period,
                            "max_output_force": attractor.max_output_force, "stable": attractor.stable}
                           for share, attractor in zip(result.shares, result.attractors, strict=True)]}
