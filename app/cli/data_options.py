"""Options that say what the columns of a measured file contain, if the file itself does not."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from typing import TYPE_CHECKING, TypeVar

from .common import say
from .options import number

if TYPE_CHECKING:
    from granchain_core import Amplitude, Scene
    from granchain_core.experiment import Answers

Found = TypeVar("Found")


def add_answers(parser: argparse.ArgumentParser) -> None:
    """Add the options that answer the questions of the file reader."""
    parser.add_argument("--column", action="append", default=[], metavar="QUANTITY=n:UNIT",
                        help="what column n of a data file contains: f=1:kHz, F=2:mN, sigma=3:mN, t=1:ms, v=2:mm/s, "
                             "A0=2:µm, a=2:g, Fin=3:2.248V/kN (volts and a sensitivity), Fout=4:N; once for each")
    parser.add_argument("--decimal", metavar="point|comma", help="the decimal mark of a data file")
    parser.add_argument("--separator", metavar="NAME", help="semicolon, tab, comma, bar or space between the columns")
    parser.add_argument("--dataset", metavar="NAME", help="the dataset to read in a digitiser's project")
    parser.add_argument("--note", default="", metavar="TEXT", help="a note that stays with the data")


def add_bandwidth(parser: argparse.ArgumentParser, use: str) -> None:
    """Add the bandwidth of the force sensors; `use` ends its help text."""
    parser.add_argument("--bandwidth", type=number, default=math.inf, metavar="HZ",
                        help=f"bandwidth of the force sensors, a low-pass of order 2{use}")


def add_amplitude(parser: argparse.ArgumentParser) -> None:
    """Add the drive amplitude over the frequency, and the answers to questions that its file leaves open."""
    parser.add_argument("--amplitude", metavar="FILE|constant-velocity=V|constant-acceleration=a",
                        help="drive amplitude over the frequency: a measured table, or a quantity that stays constant "
                             "[SI]")
    add_answers(parser)


def chosen_amplitude(arguments: argparse.Namespace, scene: Scene) -> Amplitude | None:
    """Return the drive amplitude that --amplitude names, and report it; None without the option."""
    from granchain_core.experiment import read_amplitude

    if arguments.amplitude is None:
        return None
    amplitude = with_answers(arguments, lambda answers: read_amplitude(arguments.amplitude, answers))
    say(f"The drive has {amplitude.words}; k stays {scene.k:g} N/m.")
    return amplitude


def with_answers(arguments: argparse.Namespace, read: Callable[[Answers], Found]) -> Found:
    """Call `read` with the answers; if a question remains open, show the file's first rows before raising it."""
    from granchain_core.experiment import Unclear, answers_of

    answers = answers_of(arguments.column, arguments.decimal, arguments.separator, arguments.dataset,
                         note=arguments.note)
    try:
        return read(answers)
    except Unclear as unclear:
        say(unclear.question.table)
        raise


def add_tip_mass(parser: argparse.ArgumentParser, use: str) -> None:
    """Add the mass of the tip in front of the input sensor; `use` ends its help text."""
    parser.add_argument("--tip-mass", type=number, default=0.0, metavar="KG",
                        help=f"mass between the input sensor and bead 1, which moves with the shaker{use}")
