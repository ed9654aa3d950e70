"""The table of commands; how one is parsed and run, and how a failure becomes a sentence and an exit status.

With --json, exactly one object goes to stdout: the result or, if the computation failed or was over budget, its outcome
with a sentence and the values known so far. Progress goes to stderr.
"""

from __future__ import annotations

import argparse
import difflib
import errno
import os
import re
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from importlib import import_module
from types import MappingProxyType, ModuleType
from typing import Any, NoReturn

from granchain_core import BadInput, Cancelled, ComputationError
from granchain_core.errors import OverBudget, outcome_of
from granchain_core.inputs.checks import unknown_name

from ..former_names import present_command
from . import ending
from .common import say, show_json

#: Exit status of a command that succeeded.
DONE = 0
#: Exit status of a command whose input was refused (`BadInput`).
BAD_INPUT = 2
#: Exit status of a command whose computation failed (`ComputationError`).
FAILED = 3
#: Error numbers of a stream that can take no more output.
_CANNOT_BE_WRITTEN = (errno.ENOSPC, errno.EIO, errno.EFBIG, errno.EDQUOT)


class _Parser(argparse.ArgumentParser):
    """A parser whose errors are `BadInput`: one sentence, no usage text."""

    #: Subparsers by command name; set on the top-level parser only.
    commands: Mapping[str, argparse.ArgumentParser] = MappingProxyType({})

    def parse_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Parse the words; words that the command does not know are refused, and the nearest option is suggested."""
        parsed, left = self.parse_known_args(args, namespace)
        if left:
            command = self.commands[parsed.command]
            options = re.findall(r"--[a-z][\w-]*", command.format_help())
            near = difflib.get_close_matches(left[0], options, n=1) if left[0].startswith("-") else []
            raise BadInput(f"{command.prog}: unrecognized arguments: {' '.join(left)}"
                           f"{f'; the nearest option is {near[0]}' if near else ''}; see '{command.prog} --help'.")
        return parsed

    def error(self, message: str) -> NoReturn:
        raise BadInput(f"{self.prog}: {message}; see '{self.prog} --help'.")


@dataclass(frozen=True)
class Command:
    """A command: a row of `COMMANDS`.

    Attributes
    ----------
    form : str
        Required and usual arguments.
    about : str
        What it does, for `--help` and the tables of README.md and docs/command-line.md.
    example : str
        The arguments of an example that takes seconds; `--help` shows it.
    page : str
        The page of docs about it, with a heading if needed.
    """

    form: str
    about: str
    example: str
    page: str = ""


#: Every command, in the order of `granchain --help`. Its module (`module_of`) adds its options (`add_options`) and runs
#: it (`do`). Only the module of the command that runs is imported, because some take a second to load. After a change,
#: run `python -m tools.update`.
COMMANDS = {
    "serve": Command("[--port P] [--address A]", "open the dashboard", "--port 5007", "deployment.md"),
    "scenes": Command("", "list the scenes and what to look at", "--json", "scenes.md"),
    "run": Command(
        "SCENE", "run a scene: regime, largest forces, error reached, energy residual, cost; with --drive under a "
        "chirp, a burst, two tones, noise or a measured motion", "sec2 --set f=1130 --periods 300",
        "scenes.md#drives-other-than-the-harmonic-one"),
    "curve": Command(
        "SCENE --from F --to F --points n", "resonance curve: largest forces over the drive frequency, with --data "
        "next to a measured curve", "sec2 --from 300 --to 400 --points 11 --picture curve.html", "curve.md"),
    "orbit": Command("SCENE", "periodic orbit by Newton's method and its Floquet multipliers", "sec2 --set f=1130",
                     "orbits.md"),
    "branch": Command(
        "SCENE --knob f --from a --to b", "branch of periodic orbits over a knob: folds, period doublings, "
        "Neimark–Sacker points, grazings", "sec2 --set N=2 --knob f --from 2000 --to 700", "branches.md"),
    "spectrum": Command("SCENE", "lines of a force, and the transfer from input to output force", "sec2",
                        "analysis.md"),
    "lyapunov": Command("SCENE", "all Lyapunov exponents, and the Kaplan–Yorke dimension of the section",
                        "sec2 --set f=1130 --periods 100", "analysis.md#lyapunov-spectrum-and-dimension"),
    "rotation": Command("SCENE", "rotation number and second frequency of a quasi-periodic motion",
                        "sec2 --set f=1700", "analysis.md#rotation-number"),
    "bifurcation-diagram": Command(
        "SCENE --over KNOB=a:b:n", "bifurcation diagram: strobes over one knob",
        "sec2 --over f=1900:2000:21 --picture diagram.html", "analysis.md#bifurcation-diagram"),
    "basins": Command("SCENE --x u1=a:b:n --y v1=a:b:n", "the steady state that each start in a plane leads to",
                      "sec2 --set N=2 --x u1=0:2e-7:9 --y v1=0:1e-3:9", "analysis.md#basins"),
    "map": Command(
        "SCENE --x f=a:b:n --y A0=a:b:n --out FILE", "parameter map: regime and largest forces over two knobs, with "
        "--bifurcations curves of folds, period doublings and Neimark–Sacker points",
        "sec2 --set N=3 --x f=1700:2100:24 --y A0=2e-7:9e-7:16 --out map.h5 --picture map.html", "parameter-map.md"),
    "attractors": Command(
        "SCENE", "the steady states that coexist at one setting, and the share of random starts that lead to each",
        "sec2 --set f=900 --random-states 20", "parameter-map.md#all-attractors-of-one-setting"),
    "observe": Command("SCENE --input FILE", "push a scene's chain with a measured force", "sec2 --input force.csv",
                       "observers.md"),
    "pulse": Command("SCENE", "the first pulse along a chain after an impact: its force, speed and width at every "
                     "contact", "impact", "scenes.md"),
    "bands": Command("SCENE", "pass bands of a precompressed chain: cut-off and band edges", "precompressed",
                     "scenes.md"),
    "virtual": Command("SCENE", "virtual experiment: what the sensors of a rig would record of a scene, as CSV",
                       "fig12-60 --noise 0.2 --periods 12 --out virtual.csv", "data.md#a-virtual-experiment"),
    "fit": Command("SCENE --data FILE --free D=50:200", "parameters of a scene from a measurement, with 95 % intervals "
                   "and a verdict", "sec2 --data curve.csv --free D=50:200", "fit.md"),
    "figure": Command("N", "a figure of the paper with our numbers and, with --data, a measurement", "6", "paper.md"),
    "cite": Command("SCENE", "what to cite for the effects of a scene", "sec2", "references.md"),
    "accuracy": Command("SCENE", "the cost of accuracy: error against time for every method", "sec2", "accuracy.md"),
    "check": Command("[--quick]", "cases in which solvers fail silently: value, limit and verdict of each; status 3 if "
                     "one fails", "--quick", "hard-cases.md"),
    "warm": Command("[SCENE …]", "compile the kernels of the paper's scenes, or of those named, ahead of time", "sec2",
                    "compiling.md"),
}


#: Options that show the list of commands.
_HELP = ("-h", "--help")


def module_of(command: str) -> ModuleType:
    """Import the module of a command, whose name is the command's with underscores."""
    return import_module(f".{command.replace('-', '_')}", __package__)


def parser_for(words: Sequence[str]) -> _Parser:
    """Return the parser, with the options of the command in `words`."""
    asked_for = next((word for word in words if not word.startswith("-")), None)
    parser = _Parser(prog="granchain", description="Driven granular chains: simulate, sweep, show.",
                     allow_abbrev=False)
    known = parser.add_subparsers(dest="command", parser_class=_Parser, metavar="COMMAND", required=True)
    for name, row in COMMANDS.items():
        command = known.add_parser(name, help=row.about.replace("%", "%%"), description=f"{row.about}.",
                                   epilog=f"Example: granchain {name} {row.example}", allow_abbrev=False)
        if name == asked_for:
            module = module_of(name)
            module.add_options(command)
            command.set_defaults(do=module.do)
    parser.commands = known.choices
    return parser


def do(words: list[str]) -> int:
    """Run one command and return the exit status."""
    try:
        if not words:
            raise BadInput("granchain needs a command, for example 'granchain serve'; 'granchain --help' lists them.")
        words = [present_command(words[0]), *words[1:]]
        if words[0] not in COMMANDS and words[0] not in _HELP:
            raise unknown_name(*(("option", words[0], _HELP) if words[0].startswith("-") else
                                 ("command", words[0], COMMANDS)))
        parsed = parser_for(words).parse_args(words)
        _refuse_empty_files(parsed)
        status = parsed.do(parsed) or DONE
        if sys.stdout is not None:
            sys.stdout.flush()  # a full disk or a reader that is gone is noticed here, not when Python exits
        return int(status)
    except (BadInput, ComputationError) as problem:
        say(problem)
        if "--json" in words and isinstance(problem, (ComputationError, OverBudget)):
            show_json(outcome_of(problem))
        return BAD_INPUT if isinstance(problem, BadInput) else FAILED
    except (KeyboardInterrupt, Cancelled) as end:
        say(f"{ending.word()}{f': {end}' if str(end) else ''}.")
        return ending.status()
    except OSError as problem:  # of stdout: that of a file has its name and becomes `BadInput` on writing
        if isinstance(problem, BrokenPipeError):
            status = DONE
        elif problem.errno in _CANNOT_BE_WRITTEN and problem.filename is None:
            say(f"Cannot write to standard output: {problem.strerror}.")
            status = BAD_INPUT
        else:
            raise
        _give_stdout_up()
        return status


def _refuse_empty_files(parsed: argparse.Namespace) -> None:
    """Refuse --out "" and --picture "", which an unset shell variable gives: the result would be lost."""
    for option in ("out", "picture"):
        if getattr(parsed, option, None) == "":
            raise BadInput(f"--{option} is empty; name a file.")


def _give_stdout_up() -> None:
    """Discard unwritten output: at exit, Python would try to write it again and report an error."""
    with suppress(OSError, ValueError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())
        os.close(nowhere)
