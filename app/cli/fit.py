"""`granchain fit`: parameters of a scene from a measurement, with intervals, and whether the model can describe it."""

from __future__ import annotations

import argparse
import math
import re
import sys
from typing import TYPE_CHECKING, Any

from granchain_core import BadInput
from granchain_core.inputs.text import number_in

from .common import check_points, chosen_scene, in_background, say, show_json, unbroken
from .data_options import add_answers, add_bandwidth, with_answers
from .options import add_json, add_scene, add_scheduler, number, scheduler_of, whole
from .picture import add_option as add_picture
from .picture import check_files, write_picture

if TYPE_CHECKING:
    from granchain_core import Fit, Scene
    from granchain_core.fitting import Free


#: Examples of --error by the unit of the data.
_EXAMPLES = {"%": "3%", "N": "0.2N", "Hz": "3Hz"}


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of `fit`."""
    add_scene(parser)
    parser.add_argument("--data", action="append", default=[], metavar="FILE",
                        help="a measured curve, or a series; several series at once, each with its --at")
    parser.add_argument("--at", action="append", type=number, default=[], metavar="f",
                        help="drive frequency of a series [Hz]; once for each --data, in their order; for one series "
                             "without it the scene's f")
    parser.add_argument("--features", metavar="paper", help="the peaks and valleys that the paper states, instead of "
                                                            "--data")
    parser.add_argument("--free", action="append", default=[], metavar="NAME=low:high",
                        help="a parameter with its bounds [SI]: A0, k, kappa, D, K, F0 or wall; once for each")
    parser.add_argument("--prior", action="append", default=[], metavar="NAME=mean:sd",
                        help="mean and standard deviation of a parameter as known from elsewhere than the data")
    parser.add_argument("--per-frequency", action="store_true", help="one A0 for each frequency")
    parser.add_argument("--error", metavar="E",
                        help="standard deviation of the data if the file states none: a fraction of each force or "
                             "per cent (curve: 0.03 or 3%%), newtons (series: 0.2 or 0.2N), hertz (features: 3 or 3Hz)")
    parser.add_argument("--elastic", action="store_true", help="compare the elastic part of the output force")
    add_bandwidth(parser, ", which is applied to the model's forces before they are compared with a series")
    parser.add_argument("--start", default="rest", metavar="rest|up|down")
    parser.add_argument("--design", type=whole, default=0, metavar="n", help="sets of parameters to try first")
    parser.add_argument("--points", type=whole, default=71, metavar="n",
                        help="frequencies, over the scene's range, at which to look for peaks and valleys")
    parser.add_argument("--no-intervals", action="store_true", help="compute the best values only")
    add_scheduler(parser)
    parser.add_argument("--out", metavar="FILE.json", help="write the result, with its landscape, as JSON")
    add_answers(parser)
    add_json(parser)
    add_picture(parser)


def do(arguments: argparse.Namespace) -> None:
    """Fit parameters of a scene."""
    import json
    from pathlib import Path

    from granchain_core import fit
    from granchain_core.fitting import per_frequency

    chosen = chosen_scene(arguments)
    check_files(arguments)
    free = _free(arguments)  # errors of the options are reported before a file is read
    target = _target(arguments, chosen)
    if arguments.per_frequency:
        free = per_frequency(free, target.frequencies)

    def progress(count: int) -> None:
        if sys.stderr.isatty():
            print(f"\r{count} sets of parameters", end="", file=sys.stderr, flush=True)

    with scheduler_of(arguments) as client:
        result = in_background(lambda stop: fit(chosen, target, free, arguments.design, not arguments.no_intervals,
                                                stop, progress, client), reports=True)
    if sys.stderr.isatty():
        say()
    data = {**result.to_json(), "bandwidth": arguments.bandwidth if math.isfinite(arguments.bandwidth) else None}
    with unbroken(arguments.out):
        if arguments.out:
            values, misfits = result.landscape
            landscape = {parameter.name: values[:, i].tolist() for i, parameter in enumerate(result.free)}
            Path(arguments.out).write_text(json.dumps({**data, "landscape": {
                **landscape, "misfit": misfits.tolist()}}, indent=1), encoding="utf-8")
        write_picture(arguments.picture, f"A fit of {chosen.name}", result)
    if arguments.json:
        show_json(data)
    else:
        _show(result)


def _target(arguments: argparse.Namespace, chosen: Scene) -> Any:
    """Return the quantities that are compared."""
    import numpy as np

    from granchain_core.experiment import stated_features
    from granchain_core.fitting import FeatureTarget

    if bool(arguments.data) == (arguments.features is not None):
        raise BadInput("Give either --data FILE or --features paper.")
    if arguments.features is not None:
        _only_series(arguments)
        error = _error(arguments.error, "Hz")
        if arguments.features != "paper":
            raise BadInput(f"--features {arguments.features!r} is not known; the only choice is 'paper'.")
        if arguments.per_frequency:
            raise BadInput("The paper states no forces at its frequencies, so one A0 for each could make any heights; "
                           "fit a constant one, or give --data.")
        check_points(arguments.points, 3, 1000)
        low, high = next(((low, high) for name, low, high in chosen.ranges if name == "f"), (20.0, 160.0))
        grid = np.linspace(low, high, arguments.points)
        return FeatureTarget(stated_features(), grid, error or 3.0, arguments.start)
    return _measured_target(arguments)


def _measured_target(arguments: argparse.Namespace) -> Any:
    """Read the measurement: a curve, a series, or series at several frequencies."""
    from granchain_core.experiment import Measured, Series, read_experiment
    from granchain_core.fitting import CurveTarget, RecordsTarget, SeriesTarget

    files, at = arguments.data, arguments.at
    if len(at) not in ((0, 1) if len(files) == 1 else (len(files),)):
        raise BadInput(f"{len(files)} {'files are' if len(files) > 1 else 'file is'} given with --data and "
                       f"{len(at)} drive frequencies with --at; give one for each.")
    kinds = ("curve", "series") if len(files) == 1 else ("series",)
    data = with_answers(arguments, lambda answers: [read_experiment(file, answers, kinds) for file in files])
    for measured in data:
        say(f"{measured.understood}.")
    if isinstance(data[0], Measured):
        if at:
            raise BadInput("A curve has its own frequencies; --at is for series.")
        _only_series(arguments)
        return CurveTarget(data[0], _error(arguments.error, "%"), arguments.elastic, arguments.start)
    if arguments.elastic or (arguments.per_frequency and len(files) == 1):
        raise BadInput("A series has one frequency and total forces; --per-frequency is for curves and several series, "
                       "--elastic for curves.")
    error = _error(arguments.error, "N")
    records = [SeriesTarget(measured, error, f, arguments.bandwidth)
               for measured, f in zip(data, at or [None], strict=True) if isinstance(measured, Series)]
    return RecordsTarget(tuple(records)) if len(records) > 1 else records[0]


def _only_series(arguments: argparse.Namespace) -> None:
    """Refuse --bandwidth if no series is compared."""
    if math.isfinite(arguments.bandwidth):
        raise BadInput("--bandwidth is for a series; largest forces alone do not show what a low-pass did to them.")


def _error(text: str | None, unit: str) -> float | None:
    """Return the standard deviation that --error gives, with or without unit; 1 % is a hundredth of each force."""
    if text is None:
        return None
    plain = text.removesuffix(unit)
    error = number_in(plain)
    if error is None:
        raise BadInput(f"--error {text[:40]!r} is not a number, or not in {unit}; these data take {unit}, for example "
                       f"--error {_EXAMPLES[unit]}.")
    if not error > 0.0:
        raise BadInput(f"--error {text[:40]} must be above 0.")
    return error / 100.0 if unit == "%" and plain != text else error


def _free(arguments: argparse.Namespace) -> list[Free]:
    """Return the parameters to be fitted."""
    from granchain_core.fitting.parameters import free_of

    if not arguments.free:
        raise BadInput("Say what to fit, for example --free A0=5e-6:14e-6 --free D=10:100.")
    priors = {text.partition("=")[0]: text for text in arguments.prior}
    free = [free_of(text, priors.pop(text.partition("=")[0], None)) for text in arguments.free]
    if priors:
        raise BadInput(f"--prior {next(iter(priors))} has no matching --free.")
    if arguments.per_frequency and not any(parameter.name == "A0" for parameter in free):
        raise BadInput("--per-frequency needs --free A0=low:high.")
    return free


def _show(result: Fit) -> None:
    """Print a fit as a table and a sentence."""
    print("parameter        best                95 % interval             bounds")
    for i, parameter in enumerate(result.free):
        interval = "–"
        if result.profiles:
            profile = result.profiles[i]
            interval = (f"{'below ' if profile.open_low else ''}{profile.low:.5g} to "
                        f"{'above ' if profile.open_high else ''}{profile.high:.5g}")
        print(f"{parameter.name:12s} {result.best[i]:12.6g} {parameter.unit:9s} {interval:>26s}   "
              f"{parameter.low:g} to {parameter.high:g}")
    for name, other, value in _correlations(result):
        print(f"correlation of {name} and {other}: {value:+.2f}")
    print(result.sentence)
    for row in _rows(result):
        print(row)
    say(f"{len(result.landscape[1])} sets of parameters in {result.wall_s:.1f} s")


def _correlations(result: Fit) -> list[tuple[str, str, float]]:
    """Return each pair of parameters whose estimates have a correlation, with that correlation."""
    if result.correlation is None:
        return []
    names = [parameter.name for parameter in result.free]
    return [(names[i], names[j], float(result.correlation[i, j])) for i in range(len(names)) for j in range(i)
            if result.correlation[i, j] == result.correlation[i, j]]


def _rows(result: Fit) -> list[str]:
    """Return a line for each point of a curve, each feature or each of several records; none for a single series."""
    from granchain_core.fitting import CurveTarget, FeatureTarget, RecordsTarget

    target, evaluation = result.target, result.evaluation
    if isinstance(target, RecordsTarget):
        return [f"{record.frequency:10.6g} Hz  χ² {float((evaluation.residuals[samples] ** 2).sum()):10.5g} of "
                f"{samples.stop - samples.start} samples  {_in_words(regime)}"
                for record, samples, regime in target.parts(evaluation)]
    if isinstance(target, CurveTarget):
        rows = zip(target.frequencies, target.measured.force, evaluation.model, evaluation.residuals,
                   evaluation.regimes, strict=True)
        return [f"{f:10.6g} Hz  measured {measured:10.5g} N  model {model:10.5g} N  "
                f"{residual:+6.2f} standard deviations  {_in_words(regime)}"
                for f, measured, model, residual, regime in rows]
    if isinstance(target, FeatureTarget):
        stated = zip(target.frequencies, evaluation.model, evaluation.residuals, strict=True)
        return [f"stated {f:10.6g} Hz  model {model:10.5g} Hz  {residual:+6.2f} standard deviations"
                for f, model, residual in stated]
    return []


def _in_words(regime: str) -> str:
    """Return a fit's regime in words: "period 3" for "periodic3"."""
    return re.sub(r"^periodic(\d+)$", r"period \1", regime)
