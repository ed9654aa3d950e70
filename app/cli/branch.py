"""`granchain branch`: a branch of periodic orbits in one knob, with its special points."""

from __future__ import annotations

import argparse
import math
import threading
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from granchain_core import BadInput, Cancelled, ComputationError
from granchain_core.execution.checkpoints import folder_of
from granchain_core.former_names import EVENTS
from granchain_core.orbits import CONTINUOUS, Branch, Continuation, HalfBranch, KnobAxis, begin_branch
from granchain_core.orbits.branch.branch import MOST_POINTS
from granchain_core.orbits.branch.orbit_checkpoints import OrbitCheckpoints
from granchain_core.orbits.branch.special import SpecialPoint

from . import ending
from .common import check_points, chosen_scene, finite_or_null, in_background, say, say_if, show_json, unbroken
from .data_options import add_amplitude, chosen_amplitude
from .foundation import kappa_changes_along
from .options import add_result, whole
from .picture import add_option as add_picture
from .picture import check_files, write_picture

#: Orbits between two lines about progress.
_EVERY = 25


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of `branch`."""
    add_result(parser)
    parser.add_argument("--knob", metavar="NAME", help=f"the knob that varies: {', '.join(CONTINUOUS)}")
    parser.add_argument("--from", dest="start", metavar="a", help="its value where the branch begins")
    parser.add_argument("--to", dest="end", metavar="b", help="its value where it ends")
    parser.add_argument("--period", type=whole, metavar="n",
                        help="drive periods of the orbits; by default those of the settled motion, 1 if it has none")
    parser.add_argument("--both", action="store_true",
                        help="begin at the scene's own value of the knob and continue both ways, to a and to b")
    parser.add_argument("--points", type=whole, default=MOST_POINTS, metavar="m", help="most orbits each way")
    add_amplitude(parser)
    parser.add_argument("--resume", nargs="?", const="", metavar="FILE",
                        help="continue the interrupted branch of --out, or the branch in FILE")
    add_picture(parser)


def do(arguments: argparse.Namespace) -> None:
    """Follow a branch of periodic orbits and report it."""
    check_files(arguments)
    check_points(arguments.points, 2, MOST_POINTS)
    branch = _computed(arguments)
    write_picture(arguments.picture, f"A branch of {branch.axis.scene.name}", branch)
    for half in branch.half_branches:
        say(f"{len(half.points)} orbits {_way(half)}: {half.reason or 'stopped after the number of orbits asked for'}")
    say_if(branch.period_note)
    if arguments.json:
        show_json(branch_json(branch))
    else:
        _show(branch)


def branch_json(branch: Branch) -> dict[str, Any]:
    """Return the output of `--json`."""
    return {
        "knob": [p.knob for p in branch.points],
        "max_output_force_elastic": [p.max_output_force_elastic for p in branch.points],
        "stable": [p.stable for p in branch.points],
        "unstable_multipliers": [p.unstable_multipliers for p in branch.points],
        "special": [{"kind": s.kind, "knob": s.knob, "interval": list(s.interval)} for s in branch.special],
        "evidence": [_evidence(point) for point in branch.special],
        "normal_form": [_normal_form(point) for point in branch.special],
        "period": branch.period, "max_output_force": [p.max_output_force for p in branch.points],
        "max_input_force": [p.max_input_force for p in branch.points],
        **({} if branch.axis.amplitude is None else
           {"drive_amplitude": [branch.axis.amplitude.held(p.knob) for p in branch.points]}),
        "ended": [{"how": half.ended or "stopped", "reason": half.reason} for half in branch.half_branches],
    }


def _evidence(point: SpecialPoint) -> dict[str, Any]:
    """Return the evidence for a special point's kind: the multiplier that passes the circle, or a contact's event."""
    passing = point.multiplier
    return {"multiplier": None if passing is None else [passing.real, passing.imag], "contact": point.contact,
            "event": point.gained and EVENTS[point.gained], "gained": point.gained, "gained_side": point.gained_side}


def _normal_form(point: SpecialPoint) -> dict[str, Any] | None:
    """Return the criticality of a special point and its coefficient; None for a grazing."""
    form = point.normal_form
    return None if form is None else {
        "criticality": form.criticality, "coefficient": finite_or_null(form.coefficient),
        "error": finite_or_null(form.error), "reason": form.reason, "angle": point.angle}


def _computed(arguments: argparse.Namespace) -> Branch:
    """Compute the branch and write its file; of an interrupted branch, only the missing orbits are computed."""
    from granchain_core.store import save_branch

    followed: _Followed | None = None
    if arguments.out:
        ending.note_checkpoints(str(folder_of(arguments.out)))

    def work(stop: Any) -> Branch:
        nonlocal followed
        followed = _start_or_resume(arguments, stop)
        if followed.checkpoints is not None:
            followed.checkpoints.begin(followed.branch)
        return Continuation(followed.branch, stop).run(arguments.points, _Progress(followed))

    try:
        branch = in_background(work, reports=True)
    except (Cancelled, KeyboardInterrupt):
        if arguments.out and followed:  # --resume continues from the orbits found so far
            save_branch(followed.branch, arguments.out)
            written = f"{len(followed.branch.points)} orbits are in {arguments.out}; continue with --resume"
            ending.wrote(written)
            followed.remove_checkpoints()
            raise Cancelled(written) from None
        raise
    except ComputationError:
        if followed and followed.checkpoints is not None:
            followed.checkpoints.folder.write()
        raise
    if arguments.out:
        assert followed is not None
        with unbroken(arguments.out):
            save_branch(branch, arguments.out)
            followed.remove_checkpoints()
    return branch


@dataclass
class _Followed:
    """A branch that is followed, and the checkpoints with its orbits; None without --out."""

    branch: Branch
    checkpoints: OrbitCheckpoints | None

    def remove_checkpoints(self) -> None:
        """Remove the checkpoints, because the result's file has all orbits."""
        if self.checkpoints is not None:
            self.checkpoints.folder.remove()


def _start_or_resume(arguments: argparse.Namespace, stop: Any) -> _Followed:
    """Return a new branch, or the branch that --resume continues."""
    if arguments.resume:
        branch = _in_file(arguments)
        if not arguments.out:
            return _Followed(branch, None)
        checkpoints = OrbitCheckpoints(branch.axis, len(branch.half_branches) > 1, arguments.out)
        checkpoints.folder.open(resume=True)
        return _Followed(checkpoints.branch() or branch, checkpoints)
    if arguments.resume is not None and not arguments.out:
        raise BadInput("--resume needs a FILE, or --out FILE, the file of the branch that was interrupted.")
    for option, value in (("--knob", arguments.knob), ("--from", arguments.start), ("--to", arguments.end)):
        if value is None:
            raise BadInput(f"granchain branch needs {option}, for example --knob f --from 340 --to 100.")
    chosen = chosen_scene(arguments)
    say_if(kappa_changes_along(chosen, arguments.knob))
    amplitude = chosen_amplitude(arguments, chosen)
    new, interrupted = None, None
    if arguments.out:
        new = OrbitCheckpoints(KnobAxis.of(chosen, arguments.knob, arguments.start, arguments.end, amplitude),
                               arguments.both, arguments.out)
        new.folder.open(resume=arguments.resume is not None)
        interrupted = _interrupted(arguments, new)
    return _Followed(interrupted or begin_branch(chosen, arguments.knob, arguments.start, arguments.end,
                                                 arguments.period, both=arguments.both, stop=stop,
                                                 amplitude=amplitude), new)


def _interrupted(arguments: argparse.Namespace, checkpoints: OrbitCheckpoints) -> Branch | None:
    """Return the orbits found before an interruption, from their blocks or from --out; None if there are none."""
    from granchain_core.store import load_branch

    if arguments.resume is None:
        return None
    interrupted, file = checkpoints.branch(), Path(arguments.out)
    if file.exists():
        try:
            written = load_branch(file)
        except BadInput:
            if interrupted is None:
                raise
        else:
            # some blocks may be missing, if the command was killed while it removed them
            if checkpoints.asks_for(written):
                interrupted = max(filter(None, (interrupted, written)), key=lambda branch: len(branch.points))
            elif interrupted is None:
                raise BadInput(f"{file} holds another branch; give another --out.")
    if interrupted is not None:
        if arguments.period not in (None, interrupted.period):
            raise BadInput(f"The branch to be continued has period {interrupted.period}, not {arguments.period}.")
        say(f"{len(interrupted.points)} orbits have already been computed.")
    return interrupted


def _in_file(arguments: argparse.Namespace) -> Branch:
    """Load the branch in the file of --resume."""
    from granchain_core.store import load_branch

    if arguments.knob or arguments.start or arguments.end or arguments.period or arguments.set or arguments.amplitude:
        raise BadInput(f"--resume takes everything from {Path(arguments.resume).name}; it cannot be combined with "
                       "--knob, --from, --to, --period, --amplitude or --set.")
    branch = load_branch(arguments.resume)
    if branch.axis.scene.name != arguments.scene.removesuffix(".toml").rpartition("/")[2]:
        raise BadInput(f"{arguments.resume} is a branch of {branch.axis.scene.name}, not of {arguments.scene}.")
    return branch


class _Progress:
    """Callback after each orbit, from the threads of both half-branches: it adds checkpoints and reports progress."""

    def __init__(self, followed: _Followed) -> None:
        self._followed = followed
        self._lock = threading.Lock()

    def __call__(self, half: HalfBranch) -> None:
        if self._followed.checkpoints is not None:
            self._followed.checkpoints.add(self._followed.branch.period, half)
        last = half.points[-1]
        if len(half.points) % _EVERY == 0:
            with self._lock:
                say(f"{len(half.points)} orbits {_way(half)}, now at {last.knob:.6g}, "
                    f"{'stable' if last.stable else 'unstable'}, {len(half.special)} special points")


def _way(half: HalfBranch) -> str:
    return "upwards" if half.direction > 0 else "downwards"


def _show(branch: Branch) -> None:
    print(f"{branch.axis.knob:>14}  max_output_force_elastic_N  stability  unstable_multipliers")
    for p in branch.points:
        stability = "stable" if p.stable else "unstable"
        print(f"{p.knob:14.8g}  {p.max_output_force_elastic:26.8g}  {stability:9}  {p.unstable_multipliers:20}")
    for s in branch.special:
        more = f", {_grazing_words(s, branch.axis)}" if s.contact is not None else normal_form_words(s)
        low, high = s.interval
        print(f"{s.kind_words} at {branch.axis.knob} = {s.knob:.8g}, between {low:.9g} and {high:.9g}{more}")


def _grazing_words(point: SpecialPoint, axis: KnobAxis) -> str:
    """Say which contact event an orbit has once more, and on which side of the grazing."""
    value = axis.text(point.knob).partition(" = ")[2]
    side = "on one side" if point.gained_side is None else f"{point.gained_side} {value}"
    return f"contact {point.contact}: one {point.gained} more {side}"


def normal_form_words(point: SpecialPoint) -> str:
    """Return the criticality, the coefficient with its error, and the angle of a Neimark–Sacker point."""
    form = point.normal_form
    if form is None:
        return ""
    value = "" if math.isnan(form.coefficient) else f", coefficient {form.coefficient:.5g} ± {form.error:.2g}"
    angle = "" if point.angle is None else f", angle {math.degrees(point.angle):.4g}°"
    return f", {point.criticality_words()}{value}{angle}"
