"""`granchain run --drive`: a chain whose driver does not move harmonically."""

from __future__ import annotations

import argparse
import math
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from granchain_core import BadInput, Scene

from .common import in_background, run_to_start_from, say, show_json, unbroken
from .data_options import with_answers
from .forces import errors_in_words, errors_json, forces_in_words, forces_json, scene_json, status_in_words
from .picture import write_picture

if TYPE_CHECKING:
    from granchain_core import Driven, Signal
    from granchain_core.experiment import Answers, ForceDifference, Sensors, Series
    from granchain_core.fitting import Beginning

#: Options of `run` that count drive periods or choose a method, with their default values.
PERIODIC = {"periods": 100, "record": 20, "samples": 96, "method": None, "resume": False, "explain": False}


def do_driven(arguments: argparse.Namespace, chosen: Scene) -> None:
    """Run a scene with the signal of --drive instead of its own drive."""
    from granchain_core import drive
    from granchain_core.experiment import Sensors, compared_forces
    from granchain_core.store import check_writable

    for option, usual in PERIODIC.items():
        if getattr(arguments, option) != usual:
            raise BadInput(f"--{option} is for a harmonic drive; with --drive the motion goes from the start to the "
                           "end of the signal, by the method with split steps.")
    signal, series = chosen_signal(arguments, chosen)
    sensors = Sensors(bandwidth=arguments.bandwidth, tip_mass=arguments.tip_mass)
    if arguments.out:
        check_writable(arguments.out)
    begin = None if series is None else _beginning(arguments.start, chosen, series, sensors)
    if begin is not None:
        say(f"The chain begins in {begin.words}; the driver begins at {begin.displacement:.4g} m.")
        signal = signal.shifted(begin.displacement)
    say(f"The driver moves by {signal.words}: {len(signal.time)} knots, {signal.time[-1] - signal.time[0]:.4g} s.")
    if sensors.filters:
        signal = _fine_enough(signal, chosen, sensors)
    start = None if begin is None else begin.state
    motion = in_background(lambda stop: drive(chosen, signal, start, stop=stop))
    if motion.status != "done":
        say(f"The accuracy asked for, {chosen.accuracy:g}, was not reached: the error may be "
            f"{motion.displacement_error:.1e} of the largest displacement.{_limited_by_samples(motion)}")
    if arguments.out:
        from granchain_core.store import save

        with unbroken(arguments.out):
            save(motion, arguments.out, series)
    write_picture(arguments.picture, f"A driven motion of {chosen.name}", motion, measured=series)
    differences = {} if series is None else compared_forces(series, motion, sensors)
    if arguments.json:
        show_json({**_json(motion, series, differences), "start": "rest" if begin is None else begin.words,
                   "bandwidth": sensors.bandwidth if sensors.filters else None, "tip_mass": sensors.tip_mass})
    else:
        _show(motion, differences)


def _fine_enough(signal: Signal, chosen: Scene, sensors: Sensors) -> Signal:
    """Return the signal with the knots at which the low-pass of the sensors needs forces.

    If a record of this chain cannot hold that many, say so and return fewer.
    """
    from granchain_core.experiment.sensors import SAMPLES_PER_BANDWIDTH
    from granchain_core.prescribed_drive.signal import MOST_KNOTS
    from granchain_core.results.recorded_motion import MOST_RECORDED

    needed = 1.0 / (SAMPLES_PER_BANDWIDTH * sensors.bandwidth)
    knots = min(MOST_RECORDED // chosen.N, MOST_KNOTS) - len(signal.time)
    finest = float(signal.time[-1] - signal.time[0]) / max(1, knots)
    if finest > needed:
        say(f"The low-pass of {sensors.bandwidth:g} Hz needs forces {needed:.3g} s apart; with {chosen.N} beads this "
            f"record holds them {finest:.3g} s apart, so the comparison is less exact; shorten the record to avoid "
            "this.")
    return signal.finer(max(needed, finest))


def chosen_signal(arguments: argparse.Namespace, chosen: Scene) -> tuple[Signal, Series | None]:
    """Return the signal that --drive names (a formula with the scene's A0, or a file), and the series in that file."""
    from granchain_core.prescribed_drive.formulas import formula_signal

    if not chosen.is_driven:
        raise BadInput("The scene has drive = rest, and --drive moves the driver: give one of them; the nearest valid "
                       "value is --set drive=harmonic.")
    signal = formula_signal(arguments.drive, chosen.A0)
    if signal is None:
        signal, series = with_answers(arguments, lambda given: _measured(arguments.drive, given, arguments.gap))
        say(f"{series.understood}.")
        say(_uses(series))
        return signal, series
    check_no_samples(arguments)
    if arguments.start != "rest":
        raise BadInput("--start is for --drive FILE, the samples of a measured motion; a formula starts at rest.")
    return signal, None


def check_no_samples(arguments: argparse.Namespace) -> None:
    """Refuse --gap, --bandwidth and --tip-mass if no samples are read."""
    if arguments.gap != "refuse":
        raise BadInput("--gap is for --drive FILE, the samples of a measured motion.")
    if math.isfinite(arguments.bandwidth):
        raise BadInput("--bandwidth is for --drive FILE, with which measured forces are compared.")
    if arguments.tip_mass:
        raise BadInput("--tip-mass is for --drive FILE, with which measured forces are compared.")


def _beginning(start: str, chosen: Scene, series: Series, sensors: Sensors) -> Beginning | None:
    """Return where chain and driver begin; None for rest, with a warning if the record does not begin at rest."""
    from granchain_core.fitting import settled_beginning
    from granchain_core.fitting.beginning import in_motion

    if start == "rest":
        if words := in_motion(series, chosen.F0):
            say(words)
        return None
    if start == "settled":
        return in_background(lambda stop: settled_beginning(chosen, series, sensors, stop))
    return _last_of(start, chosen)


def _last_of(path: str, chosen: Scene) -> Beginning:
    """Return the last sample of a recorded run as a beginning."""
    from granchain_core.fitting import Beginning
    from granchain_core.scene.state import State

    run = run_to_start_from(path, chosen)
    return Beginning(State(run.displacement[-1], run.velocity[-1]), float(run.drive_displacement[-1]),
                     f"the last sample of {path}")


def _measured(path: str, answers: Answers, gap: str) -> tuple[Signal, Series]:
    """Return the signal in a file (the velocity or, if none was measured, the displacement), and the whole series."""
    from granchain_core import Signal
    from granchain_core.experiment.reader import read_experiment
    from granchain_core.experiment.series import Series

    series = read_experiment(path, answers, wanted=("series",))
    assert isinstance(series, Series)
    lines, source = series.lines, series.source or path

    def place(index: int) -> str:
        return f"Line {lines[index]}"

    if series.velocity is not None:
        return Signal.from_velocity(series.time, series.velocity, f"the velocity in {source}", gap=gap,
                                    place=place), series
    if series.displacement is not None:
        return Signal.from_displacement(series.time, series.displacement, f"the displacement in {source}", gap=gap,
                                        place=place), series
    raise BadInput(f"{path} has neither velocity nor displacement of the driver; a force is for granchain observe.")


def _uses(series: Series) -> str:
    """Say how each column of a series is used."""
    from granchain_core.experiment.compare_forces import FORCES

    moves = "velocity" if series.velocity is not None else "displacement"
    unused = " The displacement is not used." if moves == "velocity" and series.displacement is not None else ""
    ends = [name.removesuffix("_force") for name in FORCES if getattr(series, name) is not None]
    if not ends:
        return f"The {moves} moves the driver; the file has no force to compare.{unused}"
    verb, ones = ("are", "ones") if len(ends) > 1 else ("is", "one")
    return (f"The {moves} moves the driver; the measured {' and '.join(ends)} force {verb} compared with the computed "
            f"{ones}. No offset of a sensor is subtracted.{unused}")


def _limited_by_samples(motion: Driven) -> str:
    """Return a sentence if the samples of a measured motion limit its accuracy; otherwise return ""."""
    steps = motion.displacement_error - motion.interpolation_error
    if motion.interpolation_error <= steps:
        return ""
    return (f" The samples limit it: the motion between them adds {motion.interpolation_error:.1e}, the steps "
            f"{steps:.1e}.")


def _json(motion: Driven, series: Series | None, differences: dict[str, ForceDifference]) -> dict[str, Any]:
    """Return a driven motion as one JSON object."""
    from granchain_core.experiment.compare_forces import FORCES

    return {**scene_json(motion.scene), "drive": motion.signal.words,
            "duration": float(motion.time[-1] - motion.time[0]), "status": motion.status, **forces_json(motion),
            **errors_json(motion), "interpolation_error": motion.interpolation_error,
            "understood": None if series is None else series.understood,
            **{f"residual_{name.removesuffix('_force')}": _residual_json(differences.get(name)) for name in FORCES},
            "cost": asdict(motion.cost)}


def _residual_json(difference: ForceDifference | None) -> dict[str, Any] | None:
    """Return the difference of a computed force from the measured one; None if no force was measured."""
    if difference is None:
        return None
    return {name: getattr(difference, name)
            for name in ("compared", "samples", "rms", "largest", "at", "mean", "relative")}


def _show(motion: Driven, differences: dict[str, ForceDifference]) -> None:
    """Print a driven motion in a few lines."""
    print(f"{motion.scene.name}: {motion.signal.words}; {status_in_words(motion.status)}")
    print(forces_in_words(motion))
    print(errors_in_words(motion))
    for difference in differences.values():
        print(difference.sentence)
