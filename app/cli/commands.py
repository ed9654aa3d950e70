"""The table of commands; parsing and running one, and turning failures into a sentence and an exit status.

With --json exactly one object goes to stdout: the result or, if the computation failed or was over budget, its outcome,
a sentence and what is known. Progress goes to stderr.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from importlib import import_module
from typing import NoReturn

from granchain_core import BadInput, Cancelled, ComputationError
from granchain_core.errors import OverBudget, outcome_of
from granchain_core.inputs.checks import unknown_name

from . import ending
from .common import say, show_json

#: Exit status of a command that did what it was asked for.
DONE = 0
#: Exit status of one whose input was refused (`BadInput`).
BAD_INPUT = 2
#: Exit status of one whose computation failed (`ComputationError`).
FAILED = 3


class _Parser(argparse.ArgumentParser):
    """A parser whose errors are `BadInput`: one sentence, no usage text."""

    def error(self, message: str) -> NoReturn:
        raise BadInput(f"{self.prog}: {message}; see '{self.prog} --help'.")


#: What each command is for, in the order of `granchain --help`. The module of its name has its options, `add_options`,
#: and does it, `do`; only the one that is asked for is imported, because some need what takes a second to load.
COMMANDS = {
    "serve": "open the dashboard",
    "scenes": "list the scenes and what to look at",
    "warm": "compile the kernels of the paper's scenes, or of those named, ahead of time",
    "run": "run a scene and record it",
    "orbit": "periodic orbit and Floquet multipliers",
    "branch": "branch of periodic orbits and its special points",
    "accuracy": "what accuracy costs: error against time for every method",
    "observe": "push a scene's chain by a measured force",
    "check": "the hard cases: value, limit and verdict of each; status 3 if one fails",
    "curve": "resonance curve: largest forces over frequency",
    "map": "parameter map: regime and largest forces over two knobs",
    "spectrum": "lines of a force, and the transfer from input to output",
    "lyapunov": "all Lyapunov exponents, and the dimension of the attractor",
    "rotation": "rotation number and second frequency of a quasi-periodic motion",
    "strobes": "bifurcation diagram: strobes over one knob",
    "attractors": "the steady states that coexist at one setting, and the share of random starts that lead to each",
    "basins": "to which steady state each start of a plane leads",
    "pulse": "the first pulse along a chain: its force, speed and width at every contact",
    "bands": "pass bands of a precompressed chain: cut-off and band edges",
    "virtual": "what the sensors of a rig would record of a scene: a virtual experiment, as CSV",
    "fit": "parameters of a scene from a measurement, with intervals and a verdict",
    "figure": "a figure of the paper with our numbers",
    "cite": "what to cite for the effects of a scene",
}


def parser_for(words: Sequence[str]) -> _Parser:
    """The parser, with the options of the command in `words`."""
    asked_for = next((word for word in words if not word.startswith("-")), None)
    parser = _Parser(prog="granchain", description="Driven granular chains: simulate, sweep, show.",
                     allow_abbrev=False)
    known = parser.add_subparsers(dest="command", parser_class=_Parser, metavar="COMMAND", required=True)
    for name, about in COMMANDS.items():
        command = known.add_parser(name, help=about, description=about, allow_abbrev=False)
        if name == asked_for:
            module = import_module(f".{name}", __package__)
            module.add_options(command)
            command.set_defaults(do=module.do)
    return parser


def do(words: list[str]) -> int:
    """Run one command; returns the exit status."""
    try:
        if words and not words[0].startswith("-") and words[0] not in COMMANDS:
            raise unknown_name("command", words[0], COMMANDS)
        parsed = parser_for(words).parse_args(words)
        return parsed.do(parsed) or DONE
    except (BadInput, ComputationError) as problem:
        say(problem)
        if "--json" in words and isinstance(problem, (ComputationError, OverBudget)):
            show_json(outcome_of(problem))
        return BAD_INPUT if isinstance(problem, BadInput) else FAILED
    except (KeyboardInterrupt, Cancelled) as end:
        say(f"{ending.word()}{f': {end}' if str(end) else ''}.")
        return ending.status()
    except BrokenPipeError:
        sys.stderr.close()
        return DONE
