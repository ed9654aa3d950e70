"""`granchain curve`: largest forces over the drive frequency."""

from __future__ import annotations

import argparse
import math
import sys
from typing import TYPE_CHECKING, Any

import numpy as np

from granchain_core import BadInput
from granchain_core.precompile.pieces import BESIDE_A_BATCH

from .checkpoints import add_resume, finished, writing_checkpoints
from .common import (
    accuracy_unused,
    check_points,
    chosen_scene,
    finite_or_null,
    in_background,
    say,
    say_if,
    show_json,
    show_percent,
    unbroken,
)
from .compiling import compiling_beside
from .data_options import add_amplitude, chosen_amplitude, with_answers
from .options import add_result, add_scheduler, number, scheduler_of, whole
from .picture import add_option as add_picture
from .picture import check_files, write_picture

if TYPE_CHECKING:
    from granchain_core import Curve, CurvePoint
    from granchain_core.experiment import Difference, Measured
    from granchain_core.steady.curve.request import CurveRequest

#: The numbers behind a point's regime that the JSON contains.
_EVIDENCE = ("decay", "distance", "multiplier", "lyapunov", "lyapunov_periods", "return_distance", "return_limit",
             "window_ratios", "orbit_found_by")


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of `curve`."""
    add_result(parser, "; a batch does not use it, and a point settled alone is computed to 1e-5 at best")
    parser.add_argument("--from", dest="low", type=number, required=True, metavar="F", help="lowest frequency [Hz]")
    parser.add_argument("--to", dest="high", type=number, required=True, metavar="F", help="highest frequency [Hz]")
    parser.add_argument("--points", type=whole, required=True, metavar="n")
    parser.add_argument("--start", default="rest", metavar="rest|up|down")
    parser.add_argument("--data", metavar="FILE",
                        help="a measured curve, drawn over the computed one in --picture; the misfit is printed")
    parser.add_argument("--elastic", action="store_true",
                        help="compare and draw the elastic part of the output force, as the paper does")
    add_amplitude(parser)
    add_scheduler(parser)
    add_resume(parser, "curve")
    add_picture(parser)


def do(arguments: argparse.Namespace) -> int:
    """Compute the resonance curve of a scene; return 3, the status of a failure, if every point failed."""
    from granchain_core.steady.curve.request import CurveRequest
    from granchain_core.steady.curve.resonance_curve import MOST_POINTS

    chosen = chosen_scene(arguments)
    check_files(arguments)
    check_points(arguments.points, 1, MOST_POINTS)
    low, high = chosen.evolve(f=arguments.low).f, chosen.evolve(f=arguments.high).f
    if low > high:
        raise BadInput(f"--from {low:g} is above --to {high:g}; exchange them, and sweep with --start down.")
    measured = _measured(arguments)
    amplitude = chosen_amplitude(arguments, chosen)
    with compiling_beside(chosen, *BESIDE_A_BATCH):
        swept = _swept(arguments, CurveRequest(chosen, tuple(np.linspace(low, high, arguments.points).tolist()),
                                               arguments.start, amplitude))
    write_picture(arguments.picture, f"Resonance curve of {chosen.name}", swept, elastic=arguments.elastic,
                  measured=measured)
    difference = None if measured is None else _difference(swept, measured, arguments.elastic)
    if arguments.json:
        show_json({**_curve_json(swept), **({} if difference is None else {"misfit": _misfit_json(difference)})})
    else:
        _show_curve(swept)
        if difference is not None:
            print(f"{'Elastic part' if arguments.elastic else 'Total'} of the output force. {difference.sentence}")
    return 3 if all(point.failure for point in swept.points) else 0


def _measured(arguments: argparse.Namespace) -> Measured | None:
    """Read the curve of --data and report how it was understood; return None without it."""
    from granchain_core.experiment import Measured, read_experiment

    if arguments.data is None:
        return None
    measured = with_answers(arguments, lambda answers: read_experiment(arguments.data, answers, ("curve",)))
    assert isinstance(measured, Measured), "nothing else was wanted"
    say(f"{measured.understood}.")
    return measured


def _difference(swept: Curve, measured: Measured, elastic: bool) -> Difference:
    """Compare the computed curve with the measured one; failed points are left out."""
    from granchain_core.experiment import compared

    force = swept.column("max_output_force_elastic" if elastic else "max_output_force")
    known = np.isfinite(force)
    return compared(measured, swept.column("frequency")[known], force[known])


def _misfit_json(difference: Difference) -> dict[str, Any]:
    """Return the misfit as an object; its values are null if no measured frequency lies on the curve."""
    misfit = difference.misfit
    return {"compared": int(difference.compared.sum()), "rms": None if misfit is None else misfit.rms,
            "mean": None if misfit is None else misfit.mean}


def _swept(arguments: argparse.Namespace, request: CurveRequest) -> Curve:
    """Compute the points of the curve that are still missing, and write its file."""
    from granchain_core.steady.curve.point_checkpoints import point_checkpoints, points_in
    from granchain_core.steady.curve.request import CurveRequest
    from granchain_core.store import save_curve
    from granchain_core.store.curves import load_curve

    written = finished(arguments, "curve", load_curve,
                       lambda curve: CurveRequest.answered_by(curve).digest == request.digest)
    folder = point_checkpoints(request, arguments.out) if arguments.out else None
    points = len(request.frequencies)
    known: list[CurvePoint] = []
    if folder is not None:
        if written is not None:
            folder.remove()
            return written
        folder.open(arguments.resume)
        known = points_in(folder)
    if known:
        say(f"{len(known)} of {points} points have already been computed.")
    done = [len(known)]

    def count(point: CurvePoint) -> None:
        done[0] += 1
        if folder is not None:
            folder.add(point)
        if point.failure:
            say(f"{point.frequency:g} Hz: {point.failure}")
        if sys.stderr.isatty():
            show_percent(done[0] / points)

    with (scheduler_of(arguments) as client,
          writing_checkpoints(folder, lambda: f"{done[0]} of {points} points")):
        swept = in_background(lambda stop: request.compute(stop=stop, on_point=count, known=known, scheduler=client),
                              reports=True)
    if folder is not None:
        with unbroken(arguments.out):
            save_curve(swept, arguments.out)
            folder.remove()
    return swept


def _curve_json(swept: Any) -> dict[str, Any]:
    """Return a curve as one JSON object."""
    return {
        "frequency": [p.frequency for p in swept.points],
        **{name: [finite_or_null(getattr(p, name)) for p in swept.points]
           for name in ("max_output_force", "max_output_force_elastic", "max_input_force")},
        "regime": [p.regime.name for p in swept.points], "period": [p.regime.period for p in swept.points],
        "status": [p.status for p in swept.points], "failure": [p.failure or None for p in swept.points],
        "error_estimate": [p.force_errors.output for p in swept.points],
        "error_estimate_elastic": [p.force_errors.elastic for p in swept.points],
        "error_estimate_input": [p.force_errors.input for p in swept.points],
        **{name: [_plain(p.regime.evidence_by_key()[name]) for p in swept.points] for name in _EVIDENCE},
        "wall_s": swept.wall_s,
        **({} if swept.amplitude is None else {"drive_amplitude": [float(a) for a in swept.drive_amplitude]}),
    }


def _plain(value: float | tuple[float, ...] | None) -> float | list[float | None] | None:
    """Return a regime's number, or several, in a form that JSON can represent."""
    if isinstance(value, tuple):
        return [finite_or_null(number) for number in value]
    return value if value is None or isinstance(value, str) else finite_or_null(value)


def _show_curve(swept: Any) -> None:
    """Print a curve as a table."""
    print("frequency_Hz  max_output_force_N    error  elastic_N    error  max_input_force_N    error  regime")
    for p in swept.points:
        regime = f"period {p.regime.period}" if p.regime.period else p.regime.name
        inward, outward, elastic = (f"{'–':>7}" if math.isnan(e) else f"{e:7.1e}" for e in p.force_errors.row)
        print(f"{p.frequency:12.6g}  {p.max_output_force:18.6g}  {outward}  {p.max_output_force_elastic:9.6g}  "
              f"{elastic}  {p.max_input_force:17.6g}  {inward}  {regime}")
    say(f"{len(swept.points)} points in {swept.wall_s:.2f} s")
    if swept.start == "rest":
        say_if(accuracy_unused(swept.scene, "points"))
