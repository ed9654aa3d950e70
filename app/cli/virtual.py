"""`granchain virtual`: the record that a rig's sensors would make of a scene, as a CSV file marked as virtual."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np

from granchain_core import BadInput

from .common import check_points, chosen_scene, in_background, show_percent
from .data_options import add_bandwidth, add_tip_mass
from .options import add_scene, number, whole


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of `virtual`."""
    add_scene(parser)
    parser.add_argument("--kind", default="series", metavar="series|curve", help="a time series, or a resonance curve")
    parser.add_argument("--out", metavar="FILE.csv", help="write a file instead of stdout")
    parser.add_argument("--start", default="settled", metavar="settled|rest",
                        help="where a series begins: at a random phase of the steady state, or before the shaker "
                             "starts, with a drive period at rest and two in which its amplitude rises")
    parser.add_argument("--periods", type=whole, default=20, metavar="P", help="drive periods of each record")
    parser.add_argument("--from", type=number, dest="low", metavar="HZ", help="first frequency of a curve")
    parser.add_argument("--to", type=number, dest="high", metavar="HZ", help="last frequency of a curve")
    parser.add_argument("--points", type=whole, default=15, help="frequencies of a curve")
    parser.add_argument("--repeats", type=whole, default=3, help="records at each frequency of a curve")
    parser.add_argument("--scatter", type=number, default=0.0, metavar="PART",
                        help="scatter of the drive amplitude between the records of a curve, as a fraction of A0")
    parser.add_argument("--rate", type=number, default=100_000.0, metavar="HZ", help="samples per second")
    parser.add_argument("--noise", type=number, default=0.0, metavar="N", help="noise of a force sample, rms")
    parser.add_argument("--velocity-noise", type=number, default=0.0, metavar="M/S", help="noise of a velocity sample")
    add_bandwidth(parser, "")
    add_tip_mass(parser, "")
    parser.add_argument("--seed", type=whole, default=0, help="seed of noise, phase and scatter")


def do(arguments: argparse.Namespace) -> None:
    """Compute the motion and write the records of the sensors."""
    from granchain_core.store import check_writable
    from granchain_core.virtual_experiment import Sensors, virtual_curve_csv, virtual_series_csv

    chosen = chosen_scene(arguments)
    if arguments.out is not None:
        check_writable(arguments.out)
    if arguments.kind not in ("series", "curve"):
        raise BadInput(f"--kind {arguments.kind[:40]} is neither series nor curve.")
    sensors = Sensors(arguments.noise, arguments.velocity_noise, arguments.bandwidth, arguments.tip_mass,
                      arguments.rate)
    if arguments.kind == "series":
        for name in ("low", "high"):
            if getattr(arguments, name) is not None:
                raise BadInput("--from and --to are for --kind curve; a series has the scene's own f.")
        text = in_background(lambda stop: virtual_series_csv(chosen, arguments.periods, sensors, arguments.seed, stop,
                                                               arguments.start))
    else:
        if arguments.low is None or arguments.high is None:
            raise BadInput("A curve needs --from and --to, the first and the last frequency in Hz.")
        if arguments.start != "settled":
            raise BadInput("--start is for --kind series; the records of a curve are of the steady state.")
        check_points(arguments.points, 1, 1000)
        low, high = chosen.evolve(f=arguments.low).f, chosen.evolve(f=arguments.high).f
        if low > high:
            raise BadInput(f"--from {low:g} is above --to {high:g}; exchange them.")
        frequencies = np.linspace(low, high, arguments.points)
        progress = _progress if sys.stderr.isatty() else None
        text = in_background(lambda stop: virtual_curve_csv(
            chosen, frequencies, sensors, arguments.repeats, arguments.scatter, arguments.periods, arguments.seed,
            stop, progress), reports=True)
    if arguments.out is None:
        sys.stdout.write(text)
        return
    try:
        Path(arguments.out).write_text(text, encoding="utf-8")
    except OSError as problem:
        raise BadInput(f"Cannot write {arguments.out[:200]}: {problem.strerror or problem}.") from None
    print(f"{arguments.out}: {_rows(text)} rows of a virtual experiment with {chosen.name}")


def _progress(done: int, count: int) -> None:
    """Show how many of the records are finished."""
    show_percent(done / count)


def _rows(text: str) -> int:
    """Count the rows of numbers: all lines except the comments and the column titles."""
    return sum(not line.startswith("#") for line in text.splitlines()) - 1
