"""The command line: serve, scenes, warm, run, curve, orbit, branch, observe, map, accuracy, check.

Names, JSON keys and exit statuses are what others script against: 0 done, 2 bad input, 3 the numbers failed,
130 cancelled. With --json one object goes to stdout and nothing else: the result, or of a computation that failed or
would not fit its outcome, sentence and what is known. Progress goes to stderr.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from typing import NoReturn

from app.cli import (
    branch as branch_command,
)
from app.cli import (
    check as check_command,
)
from app.cli import (
    commands,
)
from app.cli import (
    map as map_command,
)
from app.cli import (
    observe as observe_command,
)
from app.cli import (
    orbit as orbit_command,
)
from app.cli.picture import add_option as add_picture
from granchain_core import BadInput, Cancelled, NumbersFailed
from granchain_core.errors import OverBudget, outcome_of, unknown_name
from granchain_core.run.budget import BUDGET

DONE, BAD_INPUT, FAILED, CANCELLED = 0, 2, 3, 130


class _Parser(argparse.ArgumentParser):
    """A parser whose errors are `BadInput`: one sentence, no usage text."""

    def error(self, message: str) -> NoReturn:
        raise BadInput(f"{self.prog}: {message}; see '{self.prog} --help'.")


def _parser() -> _Parser:
    parser = _Parser(prog="granchain", description="Driven granular chains: simulate, sweep, show.",
                     allow_abbrev=False)
    known = parser.add_subparsers(dest="command", parser_class=_Parser, metavar="COMMAND", required=True)

    def command(name: str, about: str) -> _Parser:
        added = known.add_parser(name, help=about, description=about, allow_abbrev=False)
        assert isinstance(added, _Parser)
        return added

    serve = command("serve", "open the dashboard")
    serve.add_argument("--port", type=int, default=5006)
    serve.add_argument("--address", default="127.0.0.1")
    serve.add_argument("--allow-websocket-origin", action="append", metavar="HOST",
                       help="host name under which browsers may reach a dashboard behind a proxy")
    scenes = command("scenes", "list the scenes and what to look at")
    scenes.add_argument("--json", action="store_true")
    command("warm", "compile the kernels of all presets, ahead of time")
    run = _scene_command(command("run", "run a scene and record it"))
    run.add_argument("--periods", type=int, default=100, metavar="P", help="periods run and discarded")
    run.add_argument("--record", type=int, default=20, metavar="R", help="periods recorded")
    run.add_argument("--samples", type=int, default=96, metavar="S", help="samples a period")
    run.add_argument("--method", metavar="M", help="integration method instead of the one accuracy chooses")
    run.add_argument("--budget", type=float, default=BUDGET, metavar="SECONDS", help="refuse what would take longer")
    run.add_argument("--explain", action="store_true", help="say which effects and method are used, and why")
    orbit = command("orbit", "periodic orbit and Floquet multipliers")
    orbit.add_argument("scene", metavar="SCENE")
    orbit.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", help="change a knob")
    orbit.add_argument("--period", type=int, metavar="n", help="drive periods; else those of the settled motion")
    orbit.add_argument("--start", default="settled", metavar="settled|rest|random|FILE",
                       help="where Newton's method starts; FILE is a recorded run, whose last sample counts")
    orbit.add_argument("--seed", type=int, default=0, help="of the random start")
    orbit.add_argument("--observer", action="store_true", help="multipliers of the observer of model (4) too")
    orbit.add_argument("--json", action="store_true", help="print one JSON object on stdout")
    add_picture(orbit)
    branch = _scene_command(command("branch", "branch of periodic orbits and its special points"))
    branch_command.add_options(branch)
    add_picture(branch)
    accuracy = command("accuracy", "what accuracy costs: error against time for every method")
    accuracy.add_argument("scene", metavar="SCENE")
    accuracy.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", help="change a knob")
    accuracy.add_argument("--json", action="store_true", help="print one JSON object on stdout")
    add_picture(accuracy)
    observe = _scene_command(command("observe", "push a scene's chain by a measured force"))
    observe_command.add_options(observe)
    add_picture(observe)
    check = command("check", "the hard cases: figure, bar and verdict; status 3 if one fails")
    check_command.add_parser(check)
    add_picture(check)
    curve = _scene_command(command("curve", "resonance curve: largest forces over frequency"))
    curve.add_argument("--from", dest="low", type=float, required=True, metavar="F", help="lowest frequency [Hz]")
    curve.add_argument("--to", dest="high", type=float, required=True, metavar="F", help="highest frequency [Hz]")
    curve.add_argument("--points", type=int, required=True, metavar="n")
    curve.add_argument("--start", default="rest", metavar="rest|up|down")
    add_picture(curve)
    diagram = command("map", "regime and largest forces over two knobs")
    map_command.add_arguments(diagram)
    add_picture(diagram)
    return parser


def _scene_command(parser: _Parser) -> _Parser:
    parser.add_argument("scene", metavar="SCENE")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", help="change a knob")
    parser.add_argument("--accuracy", metavar="E", help="the same as --set accuracy=E")
    parser.add_argument("--out", metavar="FILE", help="write an HDF5 file")
    parser.add_argument("--json", action="store_true", help="print one JSON object on stdout")
    return parser


_COMMANDS: dict[str, Callable[[argparse.Namespace], int | None]] = {
    "serve": commands.serve, "scenes": commands.scenes, "warm": commands.warm, "run": commands.run,
    "curve": commands.curve, "orbit": orbit_command.orbit, "branch": branch_command.branch,
    "observe": observe_command.observe, "map": map_command.map_scene, "accuracy": commands.accuracy,
    "check": check_command.check,
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; returns the exit status."""
    words = list(sys.argv[1:] if arguments is None else arguments)
    try:
        if words and not words[0].startswith("-") and words[0] not in _COMMANDS:
            raise unknown_name("command", words[0], _COMMANDS)
        parsed = _parser().parse_args(words)
        return _COMMANDS[parsed.command](parsed) or DONE
    except (BadInput, NumbersFailed) as problem:
        commands.say(problem)
        if "--json" in words and isinstance(problem, (NumbersFailed, OverBudget)):
            commands.show_json(outcome_of(problem))
        return BAD_INPUT if isinstance(problem, BadInput) else FAILED
    except (KeyboardInterrupt, Cancelled):
        commands.say("Cancelled.")
        return CANCELLED
    except BrokenPipeError:
        sys.stderr.close()
        return DONE


if __name__ == "__main__":
    sys.exit(main())
