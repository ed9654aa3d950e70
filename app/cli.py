"""The command line: serve, scenes, warm, run, curve, accuracy.

Names, JSON keys and exit statuses are what others script against: 0 done, 2 bad input, 3 the numbers failed,
130 cancelled. With --json one object goes to stdout and nothing else; progress goes to stderr.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import threading
from collections.abc import Callable, Sequence
from dataclasses import asdict
from typing import Any, NoReturn, TypeVar

from granchain_core import BadInput, Cancelled, NumbersFailed, Scene, scene, scene_names
from granchain_core.errors import unknown_name

DONE, BAD_INPUT, FAILED, CANCELLED = 0, 2, 3, 130
T = TypeVar("T")


class _Parser(argparse.ArgumentParser):
    """A parser whose errors are `BadInput`: one sentence, no usage text."""

    def error(self, message: str) -> NoReturn:
        raise BadInput(f"{self.prog}: {message}; see '{self.prog} --help'.")


def _parser() -> _Parser:
    parser = _Parser(prog="granchain", description="Driven granular chains: simulate, sweep, show.",
                     allow_abbrev=False)
    commands = parser.add_subparsers(dest="command", parser_class=_Parser, metavar="COMMAND", required=True)

    def command(name: str, about: str) -> _Parser:
        added = commands.add_parser(name, help=about, description=about, allow_abbrev=False)
        assert isinstance(added, _Parser)
        return added

    serve = command("serve", "open the dashboard")
    serve.add_argument("--port", type=int, default=5006)
    serve.add_argument("--address", default="127.0.0.1")
    serve.add_argument("--allow-websocket-origin", action="append", metavar="HOST",
                       help="host name under which browsers may reach a dashboard behind a proxy")
    scenes = command("scenes", "list the scenes and what to look at")
    scenes.add_argument("--json", action="store_true")
    command("warm", "compile and cache what the dashboard needs")
    run = _scene_command(command("run", "run a scene and record it"))
    run.add_argument("--periods", type=int, default=100, metavar="P", help="periods run and discarded")
    run.add_argument("--record", type=int, default=20, metavar="R", help="periods recorded")
    run.add_argument("--samples", type=int, default=96, metavar="S", help="samples a period")
    run.add_argument("--method", metavar="M", help="integration method instead of the one accuracy chooses")
    run.add_argument("--explain", action="store_true", help="say which effects and method are used, and why")
    accuracy = command("accuracy", "what accuracy costs: error against time for every method")
    accuracy.add_argument("scene", metavar="SCENE")
    accuracy.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", help="change a knob")
    accuracy.add_argument("--json", action="store_true", help="print one JSON object on stdout")
    curve = _scene_command(command("curve", "resonance curve: largest forces over frequency"))
    curve.add_argument("--from", dest="low", type=float, required=True, metavar="F", help="lowest frequency [Hz]")
    curve.add_argument("--to", dest="high", type=float, required=True, metavar="F", help="highest frequency [Hz]")
    curve.add_argument("--points", type=int, required=True, metavar="n")
    curve.add_argument("--start", default="rest", metavar="rest|up|down")
    return parser


def _scene_command(parser: _Parser) -> _Parser:
    parser.add_argument("scene", metavar="SCENE")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", help="change a knob")
    parser.add_argument("--accuracy", metavar="E", help="the same as --set accuracy=E")
    parser.add_argument("--out", metavar="FILE", help="write an HDF5 file")
    parser.add_argument("--json", action="store_true", help="print one JSON object on stdout")
    return parser


def chosen_scene(arguments: argparse.Namespace) -> Scene:
    """The scene that SCENE, --set and --accuracy describe."""
    changes: dict[str, str] = {}
    settings = list(arguments.set)
    if getattr(arguments, "accuracy", None) is not None:
        settings.append(f"accuracy={arguments.accuracy}")
    for setting in settings:
        name, equals, value = setting.partition("=")
        if not equals:
            raise BadInput(f"--set {setting!r} must have the form NAME=VALUE, for example --set f=340.")
        if name in changes:
            raise BadInput(f"{name} is set twice, to {changes[name]} and to {value}; give it once.")
        changes[name] = value
    return scene(arguments.scene).evolve(**changes)


def _say(*words: object) -> None:
    print(*words, file=sys.stderr, flush=True)


def _show_json(data: dict[str, Any]) -> None:
    print(json.dumps(data, allow_nan=False))


def in_background(work: Callable[[Any], T]) -> T:
    """Run `work(stop)` beside the main thread, so that Ctrl-C reaches a running kernel through its stop flag."""
    from granchain_core.integrate.engine import new_stop

    stop = new_stop()
    result: list[T] = []
    problem: list[BaseException] = []

    def target() -> None:
        try:
            result.append(work(stop))
        except BaseException as error:  # handed to the main thread, which knows what to say
            problem.append(error)

    thread = threading.Thread(target=target, daemon=True)
    thread.start()
    try:
        while thread.is_alive():
            thread.join(0.1)
    except KeyboardInterrupt:
        stop[0] = 1
        thread.join(5.0)
        raise
    if problem:
        raise problem[0]
    return result[0]


def _serve(arguments: argparse.Namespace) -> None:
    from app.server import serve

    if not 0 <= arguments.port <= 65535:
        raise BadInput(f"port {arguments.port} is outside 0 to 65535; the usual one is 5006.")
    try:
        serve(arguments.port, arguments.address, arguments.allow_websocket_origin)
    except OSError as problem:
        raise BadInput(f"Cannot listen on {arguments.address}:{arguments.port}: {problem.strerror or problem}; "
                       f"try --port {arguments.port + 1}.") from None


def _scenes(arguments: argparse.Namespace) -> None:
    found = [scene(name) for name in scene_names()]
    if arguments.json:
        _show_json({"scenes": [{"name": s.name, "title": s.title, "look_at": s.look_at, "paper": s.paper,
                                "knobs": s.knobs, "effects": s.effects} for s in found]})
        return
    for one in found:
        print(f"{one.name:10}  {one.title}\n{'':10}  {one.look_at}")


def _warm(arguments: argparse.Namespace) -> None:
    from granchain_core.warm import warm_presets

    for done in warm_presets():
        _say("compiled", done)


def _run(arguments: argparse.Namespace) -> None:
    from granchain_core.run import run, warnings
    from granchain_core.store import save

    chosen = chosen_scene(arguments)
    if arguments.explain:
        _explain(chosen, arguments.method, sys.stderr if arguments.json else sys.stdout)
    progress = _progress if sys.stderr.isatty() else None
    result = in_background(lambda stop: run(chosen, arguments.periods, arguments.record, arguments.samples,
                                            arguments.method, stop=stop, progress=progress))
    for warning in warnings(result):
        _say(warning)
    if result.status == "accuracy-not-reached":
        _say(f"The accuracy asked for, {chosen.accuracy:g}, was not reached: successive computations differ by "
             f"{result.error_estimate:.1e}.")
    if arguments.out:
        save(result, arguments.out)
    if arguments.json:
        _show_json({
            "scene": chosen.name, "knobs": chosen.knobs, "effects": chosen.effects, "status": result.status,
            "regime": result.regime.name, "period": result.regime.period,
            "max_output_force": result.max_output_force,
            "max_output_force_elastic": result.max_output_force_elastic,
            "max_input_force": result.max_input_force, "error_estimate": result.error_estimate,
            "energy_residual": result.energy_residual, "cost": asdict(result.cost),
        })
        return
    print(f"{chosen.name}: {result.regime.sentence}; {result.status}")
    print(f"largest output force {result.max_output_force:.6g} N (elastic {result.max_output_force_elastic:.6g} N), "
          f"input force {result.max_input_force:.6g} N")
    print(f"relative error {result.error_estimate:.1e}, energy closes to {result.energy_residual:.1e}; "
          f"{result.cost.method}, {result.cost.steps} steps, {result.cost.events} contact events, "
          f"{1e3 * result.cost.wall_s:.1f} ms")


def _progress(fraction: float) -> None:
    print(f"\r{100 * fraction:3.0f} %", end="\n" if fraction >= 1.0 else "", file=sys.stderr, flush=True)


def _explain(chosen: Scene, method: str | None, stream: Any) -> None:
    from app.explain import explanation

    print(explanation(chosen, method), file=stream, flush=True)


def _curve(arguments: argparse.Namespace) -> None:
    import numpy as np

    from granchain_core.steady.curve import MOST_POINTS, resonance_curve
    from granchain_core.store import save_curve

    chosen = chosen_scene(arguments)
    if not 1 <= arguments.points <= MOST_POINTS:
        raise BadInput(f"--points {arguments.points} is outside 1 to {MOST_POINTS}; the nearest valid value is "
                       f"{min(max(arguments.points, 1), MOST_POINTS)}.")
    low, high = chosen.evolve(f=arguments.low).f, chosen.evolve(f=arguments.high).f
    if low > high:
        raise BadInput(f"--from {low:g} is above --to {high:g}; exchange them, and sweep with --start down.")
    done = [0]

    def count(point: Any) -> None:
        done[0] += 1
        if point.failure:
            _say(f"{point.frequency:g} Hz: {point.failure}")
        if sys.stderr.isatty():
            _progress(done[0] / arguments.points)

    frequencies = np.linspace(low, high, arguments.points)
    curve = in_background(lambda stop: resonance_curve(chosen, frequencies, arguments.start,
                                                       stop=lambda: bool(stop[0]), on_point=count))
    if arguments.out:
        save_curve(curve, arguments.out)
    if arguments.json:
        _show_json({
            "frequency": [p.frequency for p in curve.points],
            **{name: [_null(getattr(p, name)) for p in curve.points]
               for name in ("max_output_force", "max_output_force_elastic", "max_input_force")},
            "regime": [p.regime.name for p in curve.points], "period": [p.regime.period for p in curve.points],
            "error_estimate": [p.error_estimate for p in curve.points], "wall_s": curve.wall_s,
        })
        return
    print("frequency_Hz  max_output_force_N  elastic_N  max_input_force_N  regime")
    for p in curve.points:
        regime = f"period {p.regime.period}" if p.regime.period else p.regime.name
        print(f"{p.frequency:12.6g}  {p.max_output_force:18.6g}  {p.max_output_force_elastic:9.6g}  "
              f"{p.max_input_force:17.6g}  {regime}")
    _say(f"{len(curve.points)} points in {curve.wall_s:.2f} s")


def _null(value: float) -> float | None:
    """A number, or null where there is none; NaN and infinity are no JSON."""
    return value if math.isfinite(value) else None


def _accuracy(arguments: argparse.Namespace) -> None:
    from granchain_core.accuracy import work_precision

    chosen = chosen_scene(arguments)
    progress = _progress if sys.stderr.isatty() else None
    found = in_background(lambda stop: work_precision(chosen, stop, progress))
    if arguments.json:
        rows = [{**asdict(row), "error": _null(row.error)} for row in found.rows]
        _show_json({"reference": {"method": found.reference, "agreement": _null(found.agreement)}, "rows": rows})
        return
    print(f"reference: {found.reference}; a second one agrees to {found.agreement:.1e}")
    print("method          setting                   error     time_ms  evaluations")
    for row in found.rows:
        print(f"{row.method:14}  {row.setting:22}  {row.error:8.1e}  {1e3 * row.wall_s:8.2f}  {row.rhs:11d}")
    for error in (1e-3, 1e-6, 1e-9):
        best = found.cheapest(error)
        if best is not None:
            print(f"the cheapest way to {error:g} is {best.method}, {best.setting}: {1e3 * best.wall_s:.2f} ms")


_COMMANDS = {"serve": _serve, "scenes": _scenes, "warm": _warm, "run": _run, "curve": _curve,
             "accuracy": _accuracy}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; returns the exit status."""
    words = list(sys.argv[1:] if arguments is None else arguments)
    try:
        if words and not words[0].startswith("-") and words[0] not in _COMMANDS:
            raise unknown_name("command", words[0], _COMMANDS)
        parsed = _parser().parse_args(words)
        _COMMANDS[parsed.command](parsed)
    except BadInput as problem:
        _say(problem)
        return BAD_INPUT
    except NumbersFailed as problem:
        _say(problem.sentence)
        return FAILED
    except (KeyboardInterrupt, Cancelled):
        _say("Cancelled.")
        return CANCELLED
    except BrokenPipeError:
        sys.stderr.close()
        return DONE
    return DONE


if __name__ == "__main__":
    sys.exit(main())
