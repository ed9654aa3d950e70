"""`granchain spectrum`: the lines of a force, and the transfer from the input to the output force."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from .common import chosen_scene, finite_or_null, in_background, show_json
from .options import add_json, add_out, add_scene, whole
from .picture import add_option as add_picture
from .picture import check_files, write_files

if TYPE_CHECKING:
    from granchain_core import Run, Scene, Spectrum, Stop, Transfer

#: Number of lines that are printed.
_SHOWN = 12


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of `spectrum`."""
    add_scene(parser)
    parser.add_argument("--force", default="output", metavar="input|output|elastic", help="the force to analyse")
    parser.add_argument("--record", type=whole, default=64, metavar="R",
                        help="drive periods to record of a motion without a period; of an orbit, its period")
    parser.add_argument("--samples", type=whole, default=256, metavar="S", help="samples per period, an even number")
    add_out(parser)
    add_json(parser)
    add_picture(parser)


def do(arguments: argparse.Namespace) -> None:
    """Compute the spectrum of a force."""
    from granchain_core import spectrum, transfer
    from granchain_core.analysis.spectrum import FORCES
    from granchain_core.inputs.checks import unknown_name

    chosen = chosen_scene(arguments)
    check_files(arguments)
    if arguments.force not in FORCES:
        raise unknown_name("force", arguments.force, FORCES)
    motion = in_background(lambda stop: _motion(chosen, arguments.record, arguments.samples, stop))
    result, through = spectrum(motion, arguments.force), transfer(motion) if motion.regime.period else None
    write_files(arguments, f"Spectrum of {chosen.name}", result)
    if arguments.json:
        show_json(_json(result, through))
        return
    _show(result, through)


def _motion(chosen: Scene, record: int, samples: int, stop: Stop) -> Run:
    """Return one period of the orbit to which a scene settles, or a longer record of a motion without a period."""
    from granchain_core import run, settle

    settled = settle(chosen, samples=samples, stop=stop)
    return settled.run if settled.regime.period else run(chosen, 0, record, samples, start=settled.state, stop=stop)


def _json(result: Spectrum, through: Transfer | None) -> dict[str, Any]:
    lines = None if through is None else {"frequency": through.frequency.tolist(), "gain": through.gain.tolist(),
                                          "phase": through.phase.tolist(),
                                          "gain_error": [finite_or_null(float(x)) for x in through.gain_error],
                                          "phase_error": [finite_or_null(float(x)) for x in through.phase_error]}
    return {"force": result.force, "period": result.period, "resolution": result.resolution,
            "aliasing": result.aliasing, "frequency": result.frequency.tolist(),
            "amplitude": result.amplitude.tolist(), "phase": result.phase.tolist(), "transfer": lines}


def _show(result: Spectrum, through: Transfer | None) -> None:
    """Print the largest lines as a table."""
    gains = {} if through is None else dict(zip(through.frequency.tolist(), through.gain.tolist(), strict=True))
    kind = (f"Fourier series of a motion of period {result.period}" if result.period else
            "peaks of a windowed record (not periodic)")
    print(f"{result.run.scene.name}: {result.force} force, {kind}; resolution {result.resolution:.4g} Hz, "
          f"folded back about {result.aliasing:.1e} N")
    print("frequency_Hz  amplitude_N  phase_rad  output_over_input")
    for i in sorted(result.amplitude.argsort()[::-1][:_SHOWN]):
        gain = gains.get(float(result.frequency[i]))
        print(f"{result.frequency[i]:12.6g}  {result.amplitude[i]:11.5g}  {result.phase[i]:9.4f}  "
              f"{'–' if gain is None else f'{gain:.4g}':>17}")
