"""`granchain observe`: a scene's chain, pushed by a measured force instead of its driver (the paper's model 3)."""

from __future__ import annotations

import argparse
import math
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from granchain_core import BadInput

from .common import chosen_scene, in_background, say, show_json
from .data_options import add_answers, add_bandwidth, with_answers
from .forces import cost_in_words, forces_in_words, forces_json, scene_json, status_in_words
from .options import add_result
from .picture import add_option as add_picture
from .picture import check_picture, write_files

if TYPE_CHECKING:
    from granchain_core.observers import Observation


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of `observe`."""
    add_result(parser)
    parser.add_argument("--input", required=True, metavar="FILE",
                        help="a table of time, force and, if measured, output force; or an HDF5 file of granchain")
    parser.add_argument("--time-unit", metavar="UNIT", help="s, ms or µs (also us), if the header names no unit")
    parser.add_argument("--force-unit", metavar="UNIT", help="N, mN, µN, kN, lbf or kgf, if the header names no unit")
    add_answers(parser)
    parser.add_argument("--offset", default="0", metavar="N|median",
                        help="force [N] to subtract, or the median of all samples")
    parser.add_argument("--gap", default="refuse", metavar="refuse|zero|interpolate",
                        help="what to do where samples are missing")
    parser.add_argument("--start", default="rest", metavar="rest|input",
                        help="start at rest, or in the state an HDF5 input begins with")
    add_bandwidth(parser, ", which is applied to the computed output force before it is compared with a measured one")
    add_picture(parser)


def do(arguments: argparse.Namespace) -> None:
    """Push a scene's chain with a measured force."""
    from granchain_core import observe as push
    from granchain_core.observers import first_state, read_force
    from granchain_core.store import check_writable

    chosen = chosen_scene(arguments)
    if arguments.start not in ("rest", "input"):
        raise BadInput(f"--start {arguments.start!r} is not one of rest, input.")
    record = with_answers(arguments, lambda answers: read_force(arguments.input, arguments.time_unit,
                                                                arguments.force_unit, answers))
    begin = first_state(arguments.input, chosen.N) if arguments.start == "input" else None
    check_picture(arguments.picture)
    if arguments.out:
        check_writable(arguments.out)
    say(f"{record.understood}.")
    seen = in_background(lambda stop: push(chosen, record, start=begin, offset=arguments.offset, gap=arguments.gap,
                                           stop=stop, bandwidth=arguments.bandwidth))
    for note in seen.record.notes:
        say(f"{note[0].upper()}{note[1:]}.")
    if seen.integration_error > chosen.accuracy:
        say(f"The accuracy asked for, {chosen.accuracy:g}, was not reached: the error of integration may be "
            f"{seen.integration_error:.1e} of the largest displacement; an unstable observer amplifies every error.")
    elif seen.interpolation_error > chosen.accuracy:
        say(f"The samples limit this observer to an error of about {seen.interpolation_error:.1e}; integration itself "
            f"is good to {seen.integration_error:.1e}.")
    write_files(arguments, f"An observer of {chosen.name}", seen)
    if arguments.json:
        show_json({**_json(seen), "bandwidth": arguments.bandwidth if math.isfinite(arguments.bandwidth) else None})
        return
    print(f"{chosen.name}: {len(seen.time)} samples, {seen.time[-1] - seen.time[0]:.6g} s; "
          f"{status_in_words(seen.status)}")
    print(forces_in_words(seen))
    if seen.residual is not None:
        at = f"{seen.time[seen.residual.index]:.5g} s"
        print(f"output force, model − measured at {len(seen.time)} samples: {seen.residual.words(at)}")
    print(f"relative error {seen.integration_error:.1e} of integration, "
          f"{seen.interpolation_error:.1e} between samples; {cost_in_words(seen.cost)}")


def _json(seen: Observation) -> dict[str, Any]:
    """Return an observation as one JSON object."""
    from granchain_core.observers.observation import written

    scene = scene_json(seen.scene)
    # the given force has the slot of the driver (kernels/effects/given_force.py)
    return {**scene, "effects": ["given force" if e.startswith("driver") else e for e in scene["effects"]],
            "status": seen.status, "input": {
                "understood": seen.record.understood, "notes": list(seen.record.notes), "samples": len(seen.time),
                "spacing": seen.record.spacing, "from": float(seen.time[0]), "to": float(seen.time[-1])},
            **forces_json(seen),
            "residual": written(seen.residual), "residual_elastic": written(seen.residual_elastic),
            "error_estimate": seen.displacement_error, "integration_error": seen.integration_error,
            "interpolation_error": seen.interpolation_error, "error_estimate_output": seen.force_errors.output,
            "error_estimate_elastic": seen.force_errors.elastic, "cost": asdict(seen.cost)}
