"""`granchain pulse`: the first pulse that runs along a chain, contact by contact."""

from __future__ import annotations

import argparse
import math
from typing import TYPE_CHECKING, Any

from ..former_names import KEYS
from .common import chosen_scene, finite_or_null, in_background, show_json
from .forces import energy_in_words, warn
from .options import add_result, whole
from .picture import add_option as add_picture
from .picture import check_files, write_files

if TYPE_CHECKING:
    from granchain_core import Pulse


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of `pulse`."""
    add_result(parser)
    parser.add_argument("--samples", type=whole, default=4000, metavar="S", help="samples in the time 1/f")
    add_picture(parser)


def do(arguments: argparse.Namespace) -> None:
    """Record the motion from the start over the time 1/f and follow its first pulse."""
    from granchain_core import pulse, run
    from granchain_core.former_names import with_former_keys
    from granchain_core.runs.budget import BUDGET

    chosen = chosen_scene(arguments)
    check_files(arguments)
    motion = in_background(lambda stop: run(chosen, periods=0, record=1, samples=arguments.samples, stop=stop))
    result = pulse(motion)
    warn(motion, BUDGET)
    write_files(arguments, f"A pulse along {chosen.name}", result)
    if arguments.json:
        show_json(with_former_keys("pulse", _json(result), KEYS))
    else:
        _show(result)


def _json(result: Pulse) -> dict[str, Any]:
    beads, metres, width = ([finite_or_null(float(x)) for x in values]
                            for values in (result.speed_beads_s, result.speed_m_s, result.width))
    return {"contact": result.contact.tolist(), "time": result.time.tolist(), "force": result.force.tolist(),
            "speed_beads_s": beads, "speed_m_s": metres, "width": width,
            "velocity": result.velocity.tolist(),
            "error_estimate": result.run.displacement_error, "sampling_error": result.sampling_error,
            "sampling_error_time": result.sampling_error_time,
            "sampling_error_speed": finite_or_null(result.sampling_error_speed),
            "sampling_error_width": finite_or_null(result.sampling_error_width),
            "energy_residual": result.run.energy_residual}


def _show(result: Pulse) -> None:
    """Print one line for each contact; next to its speed is that of a solitary wave with the same force."""
    from granchain_core.analysis.pulse import CONTINUUM, solitary_speed

    chosen = result.run.scene
    print("contact     time_s     force_N  speed_m_s  speed_beads_s  solitary_wave  continuum  width_beads")
    for i, contact in enumerate(result.contact):
        force = float(result.force[i])
        row = (result.speed_m_s[i], 9, 6), (result.speed_beads_s[i], 13, 6), (solitary_speed(chosen, force), 13, 6), \
            (solitary_speed(chosen, force, CONTINUUM), 9, 6), (result.width[i], 11, 4)
        shown = "  ".join(f"{'–' if math.isnan(x) else f'{x:.{digits}g}':>{wide}}" for x, wide, digits in row)
        print(f"{contact:7}  {result.time[i]:9.4e}  {force:10.6g}  {shown}")
    by_sampling = {"forces": result.sampling_error, "speeds": result.sampling_error_speed,
                   "widths": result.sampling_error_width}
    print(f"relative error of displacements {result.run.displacement_error:.1e}; by sampling of "
          f"{', '.join(f'{name} {error:.1e}' for name, error in by_sampling.items() if not math.isnan(error))}; "
          f"{energy_in_words(result.run.energy_residual)}")
