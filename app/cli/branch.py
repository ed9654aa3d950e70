"""`granchain branch`: a branch of periodic orbits in one knob, with its special points."""

from __future__ import annotations

import argparse
import threading
from pathlib import Path
from typing import Any

from granchain_core import BadInput, Cancelled
from granchain_core.orbits import Arm, Branch, Continuation, begin_branch
from granchain_core.orbits.branch.branch import MOST_POINTS

from .common import check_points, chosen_scene, in_background, say, say_if, show_json
from .foundation import kept_along
from .options import add_result, whole
from .picture import add_option as add_picture
from .picture import check_picture, write_picture

#: Orbits between two lines about progress.
_EVERY = 25


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of `branch`."""
    add_result(parser)
    parser.add_argument("--knob", metavar="NAME", help="knob that is moved: f, A0, D, k, kappa or F0")
    parser.add_argument("--from", dest="start", metavar="a", help="its value where the branch begins")
    parser.add_argument("--to", dest="end", metavar="b", help="its value where it ends")
    parser.add_argument("--period", type=whole, metavar="n",
                        help="drive periods of the orbits; by default those of the settled motion")
    parser.add_argument("--both", action="store_true",
                        help="begin at the scene's own value of the knob and go both ways, to a and to b")
    parser.add_argument("--points", type=whole, default=MOST_POINTS, metavar="m", help="most orbits each way")
    parser.add_argument("--resume", metavar="FILE", help="continue a branch written by --out")
    add_picture(parser)


def do(arguments: argparse.Namespace) -> None:
    """Follow a branch of periodic orbits and report it."""
    from granchain_core.store import check_writable, save_branch

    check_picture(arguments.picture)
    if arguments.out:
        check_writable(arguments.out)
    check_points(arguments.points, 2, MOST_POINTS)
    kept: list[Branch] = []

    def work(stop: Any) -> Branch:
        kept.append(_begun(arguments, stop))
        return Continuation(kept[0], stop).run(arguments.points, _Progress())

    try:
        found = in_background(work)
    except (Cancelled, KeyboardInterrupt):
        if arguments.out and kept:  # the orbits found so far can be continued
            say(f"Saved {len(kept[0].points)} orbits to {save_branch(kept[0], arguments.out)}; go on with --resume.")
        raise
    if arguments.out:
        save_branch(found, arguments.out)
    write_picture(arguments.picture, f"A branch of {found.axis.scene.name}", lambda theme: _drawn(found, theme))
    for arm in found.arms:
        say(f"{len(arm.points)} orbits {_way(arm)}: {arm.reason or 'stopped after the number of orbits asked for'}")
    if arguments.json:
        show_json(branch_json(found))
    else:
        _show(found)


def branch_json(found: Branch) -> dict[str, Any]:
    """What `--json` prints."""
    return {
        "knob": [p.knob for p in found.points],
        "max_output_force_elastic": [p.max_output_force_elastic for p in found.points],
        "stable": [p.stable for p in found.points],
        "special": [{"kind": s.kind, "knob": s.knob, "interval": list(s.interval)} for s in found.special],
        "period": found.period, "max_output_force": [p.max_output_force for p in found.points],
        "max_input_force": [p.max_input_force for p in found.points],
        "ended": [{"how": arm.ended or "stopped", "reason": arm.reason} for arm in found.arms],
    }


def _begun(arguments: argparse.Namespace, stop: Any) -> Branch:
    """A new branch, or the one in the file of --resume."""
    from granchain_core.store import load_branch

    if arguments.resume:
        if arguments.knob or arguments.start or arguments.end or arguments.period or arguments.set:
            raise BadInput(f"--resume takes everything from {Path(arguments.resume).name}; it cannot be combined with "
                           "--knob, --from, --to, --period or --set.")
        found = load_branch(arguments.resume)
        if found.axis.scene.name != arguments.scene:
            raise BadInput(f"{arguments.resume} is a branch of {found.axis.scene.name}, not of {arguments.scene}.")
        return found
    for option, value in (("--knob", arguments.knob), ("--from", arguments.start), ("--to", arguments.end)):
        if value is None:
            raise BadInput(f"granchain branch needs {option}, for example --knob f --from 340 --to 100.")
    chosen = chosen_scene(arguments)
    say_if(kept_along(chosen, arguments.knob))
    return begin_branch(chosen, arguments.knob, arguments.start, arguments.end, arguments.period,
                        both=arguments.both, stop=stop)


class _Progress:
    """Reports progress on stderr; the threads of both arms call it after every orbit."""

    def __init__(self) -> None:
        self._lock = threading.Lock()

    def __call__(self, arm: Arm) -> None:
        last = arm.points[-1]
        if len(arm.points) % _EVERY == 0:
            with self._lock:
                say(f"{len(arm.points)} orbits {_way(arm)}, now at {last.knob:.6g}, "
                    f"{'stable' if last.stable else 'unstable'}, {len(arm.special)} special points")


def _drawn(found: Branch, theme: Any) -> Any:
    from app.pictures.branches import branches

    return branches([found], theme)


def _way(arm: Arm) -> str:
    return "upwards" if arm.direction > 0 else "downwards"


def _show(found: Branch) -> None:
    print(f"{found.axis.knob:>14}  max_output_force_elastic_N  stability")
    for p in found.points:
        print(f"{p.knob:14.8g}  {p.max_output_force_elastic:26.8g}  {'stable' if p.stable else 'unstable'}")
    for s in found.special:
        more = f", contact {s.contact}: {s.event}" if s.contact is not None else ""
        low, high = s.interval
        print(f"{s.kind} at {found.axis.knob} = {s.knob:.8g}, between {low:.9g} and {high:.9g}{more}")
