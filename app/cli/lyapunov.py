"""`granchain lyapunov`: all Lyapunov exponents of a motion, and the dimension of its attractor."""

from __future__ import annotations

import argparse
import sys

from .common import chosen_scene, in_background, show_json, show_percent
from .options import add_json, add_out, add_scene, whole
from .picture import add_option as add_picture
from .picture import check_files, write_files


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of `lyapunov`."""
    add_scene(parser)
    parser.add_argument("--periods", type=whole, default=400, metavar="P",
                        help="drive periods over which the exponents are means")
    add_out(parser)
    add_json(parser)
    add_picture(parser)


def do(arguments: argparse.Namespace) -> None:
    """Measure the Lyapunov spectrum of the motion that a scene settles to."""
    from granchain_core import lyapunov_spectrum

    chosen = chosen_scene(arguments)
    check_files(arguments)
    progress = show_percent if sys.stderr.isatty() else None
    result = in_background(lambda stop: lyapunov_spectrum(chosen, arguments.periods, stop=stop, progress=progress),
                           reports=True)
    write_files(arguments, f"Lyapunov spectrum of {chosen.name}", result)
    if arguments.json:
        low, high = result.dimension_range or (None, None)
        show_json({"exponents": result.exponents.tolist(), "errors": result.errors.tolist(),
                   "resolved": result.resolved, "dimension": result.dimension, "mean_trace": result.mean_trace,
                   "liouville": result.liouville_error, "periods": result.periods,
                   "regime": result.regime, "dimension_low": low, "dimension_high": high})
        return
    print(f"{chosen.name}: {result.resolved} of {len(result.exponents)} exponents resolved over {result.periods} "
          f"periods; Kaplan–Yorke dimension of the section: {result.dimension_words()}")
    for i, (exponent, error) in enumerate(zip(result.exponents, result.errors, strict=True), start=1):
        known = f"± {error:.1e}" if i <= result.resolved else "at most"
        print(f"{i:4d}  {exponent:+10.5f} per period  {known}")
