"""Functions that all commands share: the scene from the options, messages on stderr, JSON on stdout."""

from __future__ import annotations

import argparse
import json
import math
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from granchain_core import BadInput, Cancelled, Scene, scene
from granchain_core.execution.stop import Stop
from granchain_core.scene.validity import missing_impurity

from . import ending
from .compiling import announce_compiling
from .foundation import kappa_changed_by_amplitude

if TYPE_CHECKING:
    from granchain_core import Run

T = TypeVar("T")

#: Time between two checks for the end of a computation [s].
_LOOK = 0.05
#: Time within which a computation has to end once its stop flag is set [s].
_PATIENCE = 1.2


def chosen_scene(arguments: argparse.Namespace) -> Scene:
    """Return the scene that SCENE (a name or a file NAME.toml), --set and --accuracy describe."""
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
    preset = scene(Path(arguments.scene) if arguments.scene.endswith(".toml") else arguments.scene)
    chosen = preset.evolve(**changes)
    say_if(kappa_changed_by_amplitude(preset, chosen, changes))
    say_if(missing_impurity(chosen))
    return chosen


def run_to_start_from(path: str, chosen: Scene) -> Run:
    """Return the recorded run of --start FILE. Raises `BadInput` if its chain has another number of beads."""
    from granchain_core.store import load

    run = load(path)
    beads = run.displacement.shape[1]
    if beads != chosen.N:
        raise BadInput(f"--start {path} holds a chain of {beads} beads and the scene has {chosen.N}; add --set "
                       f"N={beads}.")
    return run


def say(*args: object) -> None:
    """Print a message for a person on stderr; stdout is for results."""
    print(*args, file=sys.stderr, flush=True)


def say_if(sentence: str) -> None:
    """Print a message for a person on stderr, unless it is empty."""
    if sentence:
        say(sentence)


def accuracy_unused(scene: Scene, what: str) -> str:
    """Return a sentence if the user has set `accuracy`, which does not affect a batch; otherwise return ""."""
    if "accuracy" not in scene.differences() or scene.cuts_tension:
        return ""
    return (f"accuracy = {scene.accuracy:g} does not change {what} that a batch computes with fixed steps; each has "
            "its error.")


def show_json(data: dict[str, Any]) -> None:
    """Print the JSON object of a command."""
    print(json.dumps(data, allow_nan=False))


def finite_or_null(value: float) -> float | None:
    """Return a number for JSON: None (null) for NaN and infinity, which JSON does not have."""
    return value if math.isfinite(value) else None


def show_percent(fraction: float) -> None:
    """Show how much is done, on one line of stderr that is overwritten each time."""
    print(f"\r{100 * fraction:3.0f} %", end="\n" if fraction >= 1.0 else "", file=sys.stderr, flush=True)


def check_points(points: int, fewest: int, most: int) -> None:
    """Refuse a number of points outside the command's range."""
    if not fewest <= points <= most:
        raise BadInput(f"--points {points} is outside {fewest} to {most}; the nearest valid value is "
                       f"{min(max(points, fewest), most)}.")


def in_background(work: Callable[[Any], T], reports: bool = False) -> T:
    """Run `work(stop)` in a second thread, so that a signal reaches a running kernel through its stop flag.

    For work that does not report its progress, a terminal shows the seconds that have passed, from the first one on.
    After a signal, raise `Cancelled` once the work has ended or has been abandoned, since a compiler cannot be stopped.
    """
    stop = Stop()
    result: list[T] = []
    problem: list[BaseException] = []

    def target() -> None:
        try:
            result.append(work(stop))
        except BaseException as error:  # passed to the main thread, which reports it
            problem.append(error)

    announce_compiling()
    thread = threading.Thread(target=target, daemon=True)
    with ending.asking(stop.set) as has_to_end:
        thread.start()
        began = 0 if reports or not sys.stderr.isatty() else time.monotonic()
        try:
            while thread.is_alive() and not has_to_end():
                thread.join(_LOOK)
                if began and time.monotonic() - began >= 1.0:
                    print(f"\r{time.monotonic() - began:3.0f} s", end="", file=sys.stderr, flush=True)
        except KeyboardInterrupt:  # in a process that has not taken over the signals
            stop.set()
        if stop or has_to_end():
            thread.join(_PATIENCE)
            raise Cancelled
        if began and time.monotonic() - began >= 1.0:
            print("\r      \r", end="", file=sys.stderr, flush=True)
    if problem:
        raise problem[0]
    return result[0]


@contextmanager
def unbroken(file: str | None) -> Iterator[None]:
    """Finish this block, which writes a result to `file` (if given), before a signal ends the command."""
    with ending.asking() as has_to_end:
        yield
        written = f"the result is in {file}" if file else ""
        ending.wrote(written)
        if has_to_end():
            raise Cancelled(written)
