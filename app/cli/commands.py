"""The commands. Their names, JSON keys and meanings are an interface on which others' scripts depend."""

from __future__ import annotations

import argparse
import json
import math
import sys
import threading
from collections.abc import Callable
from dataclasses import asdict
from typing import Any, TypeVar

from granchain_core import BadInput, Scene, scene, scene_names
from granchain_core.stop import Stop

from .foundation import kept_spring
from .picture import check_picture, write_picture

T = TypeVar("T")


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
    preset = scene(arguments.scene)
    chosen = preset.evolve(**changes)
    say_if(kept_spring(preset, chosen, changes))
    return chosen


def say(*words: object) -> None:
    """Tell a person something, on stderr: stdout is for results."""
    print(*words, file=sys.stderr, flush=True)


def say_if(sentence: str) -> None:
    """Tell a person something if there is something to tell."""
    if sentence:
        say(sentence)


def show_json(data: dict[str, Any]) -> None:
    """Print the one JSON object of a command."""
    print(json.dumps(data, allow_nan=False))


def in_background(work: Callable[[Any], T]) -> T:
    """Run `work(stop)` beside the main thread, so that Ctrl-C reaches a running kernel through its stop flag."""

    stop = Stop()
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
        stop.set()
        thread.join(5.0)
        raise
    if problem:
        raise problem[0]
    return result[0]


def serve(arguments: argparse.Namespace) -> None:
    """Open the dashboard."""
    from app.serve.server import serve as serve_page

    if not 0 <= arguments.port <= 65535:
        raise BadInput(f"port {arguments.port} is outside 0 to 65535; the usual one is 5006.")
    try:
        serve_page(arguments.port, arguments.address, arguments.allow_websocket_origin)
    except OSError as problem:
        raise BadInput(f"Cannot listen on {arguments.address}:{arguments.port}: {problem.strerror or problem}; "
                       f"try --port {arguments.port + 1}.") from None


def scenes(arguments: argparse.Namespace) -> None:
    """List the scenes."""
    found = [scene(name) for name in scene_names()]
    if arguments.json:
        show_json({"scenes": [{"name": s.name, "title": s.title, "look_at": s.look_at, "paper": s.paper,
                                "knobs": s.knobs, "effects": s.effects} for s in found]})
        return
    for one in found:
        print(f"{one.name:10}  {one.title}\n{'':10}  {one.look_at}")


def warm(arguments: argparse.Namespace) -> None:
    """Compile the kernels of all presets, ahead of time."""
    from granchain_core.warm import warm_presets

    for done in warm_presets():
        say("compiled", done)


def run(arguments: argparse.Namespace) -> None:
    """Run a scene and record it."""
    from granchain_core.run.run import run as run_scene
    from granchain_core.run.run import warnings
    from granchain_core.store import check_writable, save

    chosen = chosen_scene(arguments)
    if arguments.out:
        check_writable(arguments.out)
    if arguments.explain:
        _explain(chosen, arguments, sys.stderr if arguments.json else sys.stdout)
    progress = _progress if sys.stderr.isatty() else None
    result = in_background(lambda stop: run_scene(chosen, arguments.periods, arguments.record, arguments.samples,
                                                  arguments.method, stop=stop, progress=progress,
                                                  budget=arguments.budget))
    for warning in warnings(result):
        say(warning)
    if result.status == "accuracy-not-reached":
        say(f"The accuracy asked for, {chosen.accuracy:g}, was not reached: the error may be "
             f"{result.error_estimate:.1e} of the largest displacement.")
    if result.status == "over-budget":
        say(f"A finer computation would not fit the budget of {arguments.budget:g} s: the error may be "
            f"{result.error_estimate:.1e} of the largest displacement, {chosen.accuracy:g} was asked for.")
    if result.jumps.unresolved:
        say(f"{result.jumps.unresolved} touches were shorter than a step of {result.cost.method} and are not resolved: "
            "their jumps are read off the step's ends.")
    if arguments.out:
        save(result, arguments.out)
    if arguments.json:
        show_json({
            "scene": chosen.name, "knobs": chosen.knobs, "effects": chosen.effects, "status": result.status,
            "regime": result.regime.name, "period": result.regime.period,
            "max_output_force": result.max_output_force,
            "max_output_force_elastic": result.max_output_force_elastic,
            "max_input_force": result.max_input_force, "error_estimate": result.error_estimate,
            "error_estimate_output": result.force_errors.output, "error_estimate_input": result.force_errors.input,
            "error_estimate_elastic": result.force_errors.elastic,
            "energy_residual": result.energy_residual, "cost": asdict(result.cost),
        })
        return
    print(f"{chosen.name}: {result.regime.sentence}; {result.status}")
    print(f"largest output force {result.max_output_force:.6g} N (elastic {result.max_output_force_elastic:.6g} N), "
          f"input force {result.max_input_force:.6g} N")
    errors = result.force_errors
    inward, outward, elastic = ("none claimed" if e is None else f"{e:.1e}"
                                for e in (errors.input, errors.output, errors.elastic))
    energy = ("no energy account" if result.energy_residual is None
              else f"energy closes to {result.energy_residual:.1e}")
    print(f"relative errors: displacement {result.error_estimate:.1e}, output force {outward} (elastic {elastic}), "
          f"input force {inward}; {energy}; "
          f"{result.cost.method}, {result.cost.steps} steps, {result.cost.events} contact events, "
          f"{1e3 * result.cost.wall_s:.1f} ms")


def _progress(fraction: float) -> None:
    print(f"\r{100 * fraction:3.0f} %", end="\n" if fraction >= 1.0 else "", file=sys.stderr, flush=True)


def _explain(chosen: Scene, arguments: argparse.Namespace, stream: Any) -> None:
    from app.cli.explain import explanation

    print(explanation(chosen, arguments.method, arguments.samples), file=stream, flush=True)


def curve(arguments: argparse.Namespace) -> None:
    """The resonance curve of a scene."""
    import numpy as np

    from granchain_core.steady.curve import MOST_POINTS, resonance_curve
    from granchain_core.store import check_writable, save_curve

    chosen = chosen_scene(arguments)
    check_picture(arguments.picture)
    if arguments.out:
        check_writable(arguments.out)
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
            say(f"{point.frequency:g} Hz: {point.failure}")
        if sys.stderr.isatty():
            _progress(done[0] / arguments.points)

    frequencies = np.linspace(low, high, arguments.points)
    swept = in_background(lambda stop: resonance_curve(chosen, frequencies, arguments.start,
                                                       stop=stop, on_point=count))
    if arguments.out:
        save_curve(swept, arguments.out)
    write_picture(arguments.picture, f"Resonance curve of {chosen.name}", lambda theme: _drawn_curve(swept, theme))
    if arguments.json:
        show_json(_curve_json(swept))
    else:
        _show_curve(swept)


def _curve_json(swept: Any) -> dict[str, Any]:
    """A curve as one JSON object."""
    return {
        "frequency": [p.frequency for p in swept.points],
        **{name: [_null(getattr(p, name)) for p in swept.points]
           for name in ("max_output_force", "max_output_force_elastic", "max_input_force")},
        "regime": [p.regime.name for p in swept.points], "period": [p.regime.period for p in swept.points],
        "error_estimate": [p.force_errors.output for p in swept.points],
        "error_estimate_elastic": [p.force_errors.elastic for p in swept.points],
        "error_estimate_input": [p.force_errors.input for p in swept.points], "wall_s": swept.wall_s,
    }


def _show_curve(swept: Any) -> None:
    """A curve as a table."""
    print("frequency_Hz  max_output_force_N    error  elastic_N    error  max_input_force_N    error  regime")
    for p in swept.points:
        regime = f"period {p.regime.period}" if p.regime.period else p.regime.name
        inward, outward, elastic = (f"{'–':>7}" if math.isnan(e) else f"{e:7.1e}" for e in p.force_errors.row)
        print(f"{p.frequency:12.6g}  {p.max_output_force:18.6g}  {outward}  {p.max_output_force_elastic:9.6g}  "
              f"{elastic}  {p.max_input_force:17.6g}  {inward}  {regime}")
    say(f"{len(swept.points)} points in {swept.wall_s:.2f} s")


def _drawn_curve(swept: Any, theme: Any) -> Any:
    from app.pictures.curve import curve as drawn

    return drawn([swept], theme)


def _null(value: float) -> float | None:
    """A number, or null where there is none; NaN and infinity are no JSON."""
    return value if math.isfinite(value) else None


def _naive(found: Any) -> list[dict[str, Any]]:
    """What plain steps in (u, v) make of the output force."""
    return [{"method": one.method, "steps_per_period": one.steps, "output_force_error": _null(one.error),
             "failure": one.failure} for one in found.lesson.drawn]


def _drawn_accuracy(found: Any, asked: float, theme: Any) -> Any:
    from app.pictures.accuracy import Asked
    from app.pictures.accuracy import accuracy as drawn

    best = found.cheapest(asked)
    cheapest = None if best is None else (best.wall_s, best.error)
    return drawn(found.rows, Asked(asked, found.agreement if math.isfinite(found.agreement) else None, cheapest), theme)


def accuracy(arguments: argparse.Namespace) -> None:
    """Error against time for every method."""
    from granchain_core.accuracy import work_precision

    check_picture(arguments.picture)
    chosen = chosen_scene(arguments)
    progress = _progress if sys.stderr.isatty() else None
    found = in_background(lambda stop: work_precision(chosen, stop, progress))
    write_picture(arguments.picture, f"What accuracy costs for {chosen.name}",
                  lambda theme: _drawn_accuracy(found, chosen.accuracy, theme))
    if arguments.json:
        rows = [{**asdict(row), "error": _null(row.error)} for row in found.rows]
        show_json({"reference": {"method": found.reference, "agreement": _null(found.agreement),
                                  "second": found.second, "disagreement": found.disagreement}, "rows": rows,
                    "naive": _naive(found)})
        return
    print(f"reference: {found.reference}")
    print(f"second reference: {found.second}: " + (found.disagreement or f"agrees to {found.agreement:.1e}"))
    print("method          setting                   error     time_ms  evaluations")
    for row in found.rows:
        if row.failure:
            print(f"{row.method:14}  {row.setting:22}  failed: {row.failure}")
            continue
        print(f"{row.method:14}  {row.setting:22}  {row.error:8.1e}  {1e3 * row.wall_s:8.2f}  {row.rhs:11d}")
    for error in (1e-3, 1e-6, 1e-9):
        best = found.cheapest(error)
        if best is not None:
            print(f"the cheapest way to {error:g} is {best.method}, {best.setting}: {1e3 * best.wall_s:.2f} ms")
    for one in found.lesson.drawn if found.lesson else ():
        drawn = one.failure or f"off by {100 * one.error:.2g} % of the largest"
        print(f"output force by {one.method} with {one.steps} steps a period: {drawn}")
