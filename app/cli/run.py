"""`granchain run`: one run of a scene, with its forces, regime, error, energy residual and cost."""

from __future__ import annotations

import argparse
import sys
from dataclasses import asdict
from typing import Any

from granchain_core import BadInput, Run, Scene
from granchain_core.integrate import method_for
from granchain_core.precompile.pieces import REGIME_KERNELS
from granchain_core.prescribed_drive.formulas import FORMULAS
from granchain_core.results.regime import Regime
from granchain_core.results.run import start_words
from granchain_core.runs.budget import BUDGET
from granchain_core.version import __version__

from .checkpoints import add_resume, finished, writing_checkpoints
from .common import chosen_scene, in_background, show_json, show_percent, unbroken
from .compiling import compiling_beside
from .data_options import add_answers, add_bandwidth, add_tip_mass
from .driven import PERIODIC, check_no_samples, do_driven
from .forces import errors_in_words, errors_json, forces_in_words, forces_json, scene_json, status_in_words, warn
from .options import add_result, number, whole
from .picture import add_option as add_picture
from .picture import check_picture, write_picture


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of `run`."""
    add_result(parser)
    parser.add_argument("--periods", type=whole, default=PERIODIC["periods"], metavar="P",
                        help="periods computed and discarded")
    parser.add_argument("--record", type=whole, default=PERIODIC["record"], metavar="R", help="periods recorded")
    parser.add_argument("--samples", type=whole, default=PERIODIC["samples"], metavar="S", help="samples per period")
    parser.add_argument("--method", metavar="M", help="integration method, instead of the one that accuracy selects")
    parser.add_argument("--budget", type=number, default=BUDGET, metavar="SECONDS",
                        help="refuse a computation that would take longer")
    parser.add_argument("--explain", action="store_true", help="say which effects and method are used, and why")
    parser.add_argument("--drive", metavar="SIGNAL",
                        help="another motion of the driver, from its start to its end: "
                             f"{', '.join(f'{name}={formula.form}' for name, formula in FORMULAS.items())} with A0, or "
                             "a FILE of its velocity or displacement over time; measured forces in the file are "
                             "compared with the computed ones")
    parser.add_argument("--gap", default="refuse", metavar="refuse|zero|interpolate",
                        help="what to do where samples of --drive FILE are missing")
    parser.add_argument("--start", default="rest", metavar="rest|settled|FILE",
                        help="where a motion under --drive begins: at rest; for --drive FILE also on the settled "
                             "motion at the phase of the file's first sample, or where the recorded run FILE ends")
    add_bandwidth(parser, ", which is applied to the computed forces before they are compared with those of --drive "
                          "FILE")
    add_tip_mass(parser, ", whose inertia is added to the computed input force before it is compared with that of "
                         "--drive FILE")
    add_answers(parser)
    add_resume(parser, "run")
    add_picture(parser)


def do(arguments: argparse.Namespace) -> None:
    """Run a scene and record it."""
    chosen = chosen_scene(arguments)
    check_picture(arguments.picture)
    if arguments.drive:
        do_driven(arguments, chosen)
        return
    check_no_samples(arguments)
    if arguments.start != "rest":
        raise BadInput("--start is for --drive SIGNAL; a harmonic drive starts at rest.")
    if arguments.out:
        from granchain_core.store import check_writable

        check_writable(arguments.out)
    if arguments.explain:
        _explain(chosen, arguments, sys.stderr if arguments.json else sys.stdout)
    with compiling_beside(chosen, REGIME_KERNELS):
        result = _result(chosen, arguments)
    warn(result, arguments.budget)
    write_picture(arguments.picture, f"A motion of {chosen.name}", result)
    if arguments.json:
        show_json(_run_json(result))
    else:
        _show_run(result)


def _result(chosen: Scene, arguments: argparse.Namespace) -> Run:
    """Compute the run and write its file; an interrupted run continues after the discarded periods already finished."""
    from granchain_core.runs.run_checkpoints import RunCheckpoints
    from granchain_core.runs.to_accuracy import run as run_scene

    progress = show_percent if sys.stderr.isatty() else None
    sizes = arguments.periods, arguments.record, arguments.samples

    def computed(stop: Any, checkpoints: RunCheckpoints | None) -> Run:
        return run_scene(chosen, *sizes, arguments.method, stop=stop, progress=progress, budget=arguments.budget,
                         kept=checkpoints)

    if not arguments.out:
        if arguments.resume:
            raise BadInput("--resume needs --out FILE, the file of the run that was interrupted.")
        return in_background(lambda stop: computed(stop, None), reports=True)
    from granchain_core.store import load, save

    checkpoints = RunCheckpoints(chosen, *sizes, arguments.method, arguments.out)
    written = finished(arguments, "run", load, lambda run: _is_asked_for(run, chosen, arguments))
    if written is not None:
        checkpoints.folder.remove()
        return written
    checkpoints.open(arguments.resume)
    with writing_checkpoints(checkpoints.folder, lambda: f"{checkpoints.done} of {arguments.periods} discarded periods "
                                                         f"of computation {checkpoints.computation}"):
        result = in_background(lambda stop: computed(stop, checkpoints), reports=True)
    with unbroken(arguments.out):
        save(result, arguments.out)
        checkpoints.folder.remove()
    return result


def _is_asked_for(run: Run, chosen: Scene, arguments: argparse.Namespace) -> bool:
    """Return whether the run in a file has the options of the command line."""
    method = arguments.method or method_for(chosen.accuracy, chosen.cuts_tension).method
    sizes = {"periods": arguments.periods, "record": arguments.record, "samples": arguments.samples}
    return (run.scene.digest, run.start, _sizes(run), run.cost.method) == (
        chosen.digest, start_words(chosen, None), sizes, method)


def _sizes(run: Run) -> dict[str, int]:
    """Return the sizes that a run, from a file or just computed, was asked for, by the names of the options."""
    return {"periods": round(float(run.time[0]) / run.scene.period), "record": (len(run.time) - 1) // run.samples,
            "samples": run.samples}


def _explain(chosen: Scene, arguments: argparse.Namespace, stream: Any) -> None:
    from .explain import explanation

    print(explanation(chosen, arguments.method, arguments.samples), file=stream, flush=True)


def _run_json(result: Run) -> dict[str, Any]:
    """Return a run as one JSON object, including everything needed to cite it."""
    return {**scene_json(result.scene), "granchain_version": __version__, "scene_digest": result.scene.digest,
            **_sizes(result), "status": result.status, "regime": result.regime.name,
            "period": result.regime.period, "driven": result.regime.driven,
            "evidence": _evidence(result.regime), **forces_json(result), **errors_json(result),
            "cost": asdict(result.cost)}


def _evidence(regime: Regime) -> dict[str, Any]:
    """Return the numbers behind the regime; null for a number that was not computed."""
    known = regime.evidence_by_key()
    return {name: known[name] for name in (
        "periods_run", "decay", "distance", "multiplier", "lyapunov", "lyapunov_periods", "approaches",
        "return_distance", "return_limit", "window_ratios", "orbit_found_by")}


def _show_run(result: Run) -> None:
    """Print a run in a few lines."""
    of_record = result.regime.driven and result.regime.name == "unsettled"
    print(f"{result.scene.name}: {result.regime.sentence}; {status_in_words(result.status)}"
          f"{'; forces and errors are those of the recorded periods' if of_record else ''}")
    print(forces_in_words(result))
    print(errors_in_words(result))
