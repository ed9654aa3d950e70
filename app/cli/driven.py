"""`granchain run --drive`: a chain whose driver moves other than harmonically."""

from __future__ import annotations

import argparse
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from granchain_core import BadInput, Scene

from .common import in_background, say, show_json, unbroken
from .data_options import with_answers
from .forces import errors_in_words, errors_json, forces_in_words, forces_json, scene_json, status_in_words
from .picture import write_picture

if TYPE_CHECKING:
    from granchain_core import Driven, Signal
    from granchain_core.experiment import Answers

#: Options of `run` that count drive periods, or choose among methods, with the values they have if they are not given.
_PERIODIC = {"periods": 100, "record": 20, "samples": 96, "method": None, "resume": False, "explain": False}


def do_driven(arguments: argparse.Namespace, chosen: Scene) -> None:
    """Run a scene with the signal of --drive in place of its own drive."""
    from granchain_core import drive
    from granchain_core.store import check_writable

    for option, usual in _PERIODIC.items():
        if getattr(arguments, option) != usual:
            raise BadInput(f"--{option} is for a harmonic drive; with --drive the motion goes from the start to the "
                           "end of the signal, by the method with split steps.")
    signal = chosen_signal(arguments, chosen)
    if arguments.out:
        check_writable(arguments.out)
    say(f"The driver moves by {signal.words}: {len(signal.time)} knots, {signal.time[-1] - signal.time[0]:.4g} s.")
    found = in_background(lambda stop: drive(chosen, signal, stop=stop))
    if found.status != "done":
        say(f"The accuracy asked for, {chosen.accuracy:g}, was not reached: the error may be "
            f"{found.displacement_error:.1e} of the largest displacement.{_limited_by_samples(found)}")
    if arguments.out:
        from granchain_core.store import save

        with unbroken(arguments.out):
            save(found, arguments.out)
    write_picture(arguments.picture, f"A driven motion of {chosen.name}", found)
    if arguments.json:
        show_json(_json(found))
    else:
        _show(found)


def chosen_signal(arguments: argparse.Namespace, chosen: Scene) -> Signal:
    """The signal that --drive names: a formula with the scene's A0, or a file."""
    from granchain_core.prescribed_drive.formulas import formula_signal

    if not chosen.is_driven:
        raise BadInput("The scene has drive = rest, and --drive moves the driver: give one of them; the nearest valid "
                       "value is --set drive=harmonic.")
    found = formula_signal(arguments.drive, chosen.A0)
    if found is None:
        return with_answers(arguments, lambda given: _measured(arguments.drive, given, arguments.gap))
    check_no_gap(arguments)
    return found


def check_no_gap(arguments: argparse.Namespace) -> None:
    """Refuse --gap where no samples are read."""
    if arguments.gap != "refuse":
        raise BadInput("--gap is for --drive FILE, the samples of a measured motion.")


def _measured(path: str, answers: Answers, gap: str) -> Signal:
    """The signal in a file: its velocity if that was measured, else its displacement."""
    from granchain_core import Signal
    from granchain_core.experiment.reader import read_experiment
    from granchain_core.experiment.series import Series

    series = read_experiment(path, answers, wanted=("series",))
    assert isinstance(series, Series)
    lines, source = series.lines, series.source or path

    def place(index: int) -> str:
        return f"Line {lines[index]}"

    if series.velocity is not None:
        return Signal.from_velocity(series.time, series.velocity, f"the velocity in {source}", gap=gap, place=place)
    if series.displacement is not None:
        return Signal.from_displacement(series.time, series.displacement, f"the displacement in {source}", gap=gap,
                                        place=place)
    raise BadInput(f"{path} has neither velocity nor displacement of the driver; a force is for granchain observe.")


def _limited_by_samples(found: Driven) -> str:
    """That the samples of a measured motion are what limits its accuracy; else nothing."""
    steps = found.displacement_error - found.interpolation_error
    if found.interpolation_error <= steps:
        return ""
    return (f" The samples limit it: the motion between them adds {found.interpolation_error:.1e}, the steps "
            f"{steps:.1e}.")


def _json(found: Driven) -> dict[str, Any]:
    """A driven motion as one JSON object."""
    return {**scene_json(found.scene), "drive": found.signal.words,
            "duration": float(found.time[-1] - found.time[0]), "status": found.status, **forces_json(found),
            **errors_json(found), "interpolation_error": found.interpolation_error, "cost": asdict(found.cost)}


def _show(found: Driven) -> None:
    """A driven motion in a few lines."""
    print(f"{found.scene.name}: {found.signal.words}; {status_in_words(found.status)}")
    print(forces_in_words(found))
    print(errors_in_words(found))
