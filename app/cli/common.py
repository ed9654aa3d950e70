"""What all commands share: the scene that the options describe, words for a person, numbers for a script."""

from __future__ import annotations

import argparse
import json
import math
import sys
import threading
from collections.abc import Callable
from typing import Any, TypeVar

from granchain_core import BadInput, Scene, scene
from granchain_core.stop import Stop

from .foundation import kept_spring

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


def finite_or_null(value: float) -> float | None:
    """A number for JSON, or null for NaN and infinity, which JSON does not have."""
    return value if math.isfinite(value) else None


def show_percent(fraction: float) -> None:
    """Show how much is done, on one line of stderr that is written again and again."""
    print(f"\r{100 * fraction:3.0f} %", end="\n" if fraction >= 1.0 else "", file=sys.stderr, flush=True)


def check_points(points: int, fewest: int, most: int) -> None:
    """Refuse a number of points outside the range of the command."""
    if not fewest <= points <= most:
        raise BadInput(f"--points {points} is outside {fewest} to {most}; the nearest valid value is "
                       f"{min(max(points, fewest), most)}.")


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
