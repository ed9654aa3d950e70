"""The command line: serve, scenes, warm, run, curve, orbit, branch, observe, map, accuracy, check.

Names, JSON keys and exit statuses are what others script against: 0 done, 2 bad input, 3 the numbers failed,
130 cancelled. With --json exactly one object goes to stdout: the result or, if the computation failed or was over
budget, its outcome, a sentence and what is known. Progress goes to stderr.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from typing import NamedTuple, NoReturn

from app.cli import accuracy, branch, check, curve, observe, options, orbit, run, scenes, serve, warm
from app.cli import map as map_command
from app.cli.common import say, show_json
from granchain_core import BadInput, Cancelled, NumbersFailed
from granchain_core.errors import OverBudget, outcome_of, unknown_name

DONE, BAD_INPUT, FAILED, CANCELLED = 0, 2, 3, 130


class _Parser(argparse.ArgumentParser):
    """A parser whose errors are `BadInput`: one sentence, no usage text."""

    def error(self, message: str) -> NoReturn:
        raise BadInput(f"{self.prog}: {message}; see '{self.prog} --help'.")


class _Command(NamedTuple):
    """What a command is for, how its options are added to a parser, and what does it."""

    about: str
    add_options: Callable[[argparse.ArgumentParser], None]
    do: Callable[[argparse.Namespace], int | None]


#: In the order of `granchain --help`.
_COMMANDS = {
    "serve": _Command("open the dashboard", serve.add_options, serve.serve),
    "scenes": _Command("list the scenes and what to look at", options.add_json, scenes.scenes),
    "warm": _Command("compile the kernels of all presets, ahead of time", warm.add_options, warm.warm),
    "run": _Command("run a scene and record it", run.add_options, run.run),
    "orbit": _Command("periodic orbit and Floquet multipliers", orbit.add_options, orbit.orbit),
    "branch": _Command("branch of periodic orbits and its special points", branch.add_options, branch.branch),
    "accuracy": _Command("what accuracy costs: error against time for every method", accuracy.add_options,
                         accuracy.accuracy),
    "observe": _Command("push a scene's chain by a measured force", observe.add_options, observe.observe),
    "check": _Command("the hard cases: figure, bar and verdict; status 3 if one fails", check.add_options, check.check),
    "curve": _Command("resonance curve: largest forces over frequency", curve.add_options, curve.curve),
    "map": _Command("regime and largest forces over two knobs", map_command.add_options, map_command.map_scene),
}


def _parser() -> _Parser:
    parser = _Parser(prog="granchain", description="Driven granular chains: simulate, sweep, show.",
                     allow_abbrev=False)
    known = parser.add_subparsers(dest="command", parser_class=_Parser, metavar="COMMAND", required=True)
    for name, command in _COMMANDS.items():
        command.add_options(known.add_parser(name, help=command.about, description=command.about, allow_abbrev=False))
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; returns the exit status."""
    words = list(sys.argv[1:] if arguments is None else arguments)
    try:
        if words and not words[0].startswith("-") and words[0] not in _COMMANDS:
            raise unknown_name("command", words[0], _COMMANDS)
        parsed = _parser().parse_args(words)
        return _COMMANDS[parsed.command].do(parsed) or DONE
    except (BadInput, NumbersFailed) as problem:
        say(problem)
        if "--json" in words and isinstance(problem, (NumbersFailed, OverBudget)):
            show_json(outcome_of(problem))
        return BAD_INPUT if isinstance(problem, BadInput) else FAILED
    except (KeyboardInterrupt, Cancelled):
        say("Cancelled.")
        return CANCELLED
    except BrokenPipeError:
        sys.stderr.close()
        return DONE


if __name__ == "__main__":
    sys.exit(main())
