"""`granchain orbit`: a periodic orbit by Newton's method and its Floquet multipliers."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import Any

import numpy as np

from granchain_core import BadInput, Orbit, Scene, Stop
from granchain_core.inputs.checks import check_range
from granchain_core.precompile.pieces import ORBIT_KERNELS
from granchain_core.scene.state import State

from .common import chosen_scene, in_background, run_to_start_from, say, say_if, show_json
from .compiling import compiling_beside
from .options import add_json, add_out, add_scene, whole
from .picture import add_option as add_picture
from .picture import check_files, write_files

ORBIT_STARTS = ("settled", "rest", "random", "near")


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of `orbit`."""
    add_scene(parser)
    parser.add_argument("--period", type=whole, metavar="n",
                        help="drive periods of the orbit; by default those of the settled motion, or 1 if it has none "
                             "or with another --start")
    parser.add_argument("--start", default="settled", metavar="settled|rest|random|near|FILE",
                        help="where Newton's method starts; near: near the settled motion, for an orbit that it does "
                             "not follow; FILE: at the last sample of a recorded run")
    parser.add_argument("--seed", type=whole, default=0, help="seed of the random start")
    parser.add_argument("--observer", action="store_true",
                        help="also compute the multipliers of the observer of model (4)")
    add_out(parser)
    add_json(parser)
    add_picture(parser)


def do(arguments: argparse.Namespace) -> None:
    """Find the periodic orbit of a scene and its multipliers."""
    check_files(arguments)
    chosen = chosen_scene(arguments)
    find = _search(chosen, arguments)
    with compiling_beside(chosen, ORBIT_KERNELS):
        orbit = in_background(find)
    write_files(arguments, f"Multipliers of {chosen.name}", orbit)
    say_if(orbit.period_note)
    if arguments.json:
        data: dict[str, Any] = {
            "period": orbit.period, "residual": orbit.residual, "newton_residuals": list(orbit.newton_residuals),
            "multipliers": _pairs(orbit.multipliers), "stable": orbit.stable,
            "multiplier_errors": _numbers(orbit.multiplier_errors), "stability_certain": orbit.stability_certain,
            "period_note": orbit.period_note or None, "distance_of_motion": orbit.distance_of_motion,
        }
        if orbit.observer_multipliers is not None:
            data["observer_multipliers"] = _pairs(orbit.observer_multipliers)
            data["observer_stable"] = orbit.observer_stable
            data["observer_multiplier_errors"] = _numbers(orbit.observer_multiplier_errors)
            data["observer_stability_certain"] = orbit.observer_stability_certain
        show_json(data)
        return
    count = len(orbit.newton_residuals) - 1
    print(f"{chosen.name}: orbit of period {orbit.period}, {orbit.stability_words()}, "
          f"residual {orbit.residual:.1e} after {count} Newton iteration{'' if count == 1 else 's'}")
    if orbit.distance_of_motion is not None:
        print(orbit.distance_words())
    _show_multipliers("multipliers", orbit.multipliers, orbit.multipliers_outside, orbit.multiplier_errors)
    if orbit.observer_multipliers is not None:
        _show_multipliers(f"observer, {orbit.observer_stability_words()}", orbit.observer_multipliers,
                          orbit.observer_multipliers_outside, orbit.observer_multiplier_errors)


def _pairs(multipliers: Any) -> list[list[float]]:
    return [[float(mu.real), float(mu.imag)] for mu in multipliers]


def _numbers(errors: Any) -> list[float | None] | None:
    """Return the errors for JSON, which has no infinity."""
    return None if errors is None else [float(error) if np.isfinite(error) else None for error in errors]


def _show_multipliers(title: str, multipliers: Any, outside: Any, errors: Any) -> None:
    shown = ", ".join(f"{mu.real:+.4f}{mu.imag:+.4f}i (|μ| {abs(mu):.4f})" for mu in multipliers[:4])
    known = "" if errors is None else f"; each to ± {max(errors[:4]):.0e}"
    print(f"{title}: {outside.sum()} of {len(multipliers)} outside the unit circle; leading {shown}{known}")


def _search(chosen: Scene, arguments: argparse.Namespace) -> Callable[[Stop], Orbit]:
    """Return the function that finds the orbit."""
    from granchain_core.orbits import orbit_near_motion, periodic_orbit

    if arguments.start == "near":
        if arguments.observer:
            raise BadInput("--observer cannot be combined with --start near.")
        return lambda stop: orbit_near_motion(chosen, arguments.period, stop)
    start = _start(chosen, arguments.start, arguments.seed)
    return lambda stop: periodic_orbit(chosen, arguments.period, start, arguments.observer, stop)


def _start(chosen: Scene, name: str, seed: int) -> State | None:
    """Return the state in which Newton's method starts: None for the settled motion, the last sample of a file."""
    from granchain_core.orbits import random_state
    from granchain_core.scene.state import rest

    if name == "settled":
        return None
    if name == "rest":
        return rest(chosen)
    if name == "random":
        check_range("--seed", seed, 0, 2**63 - 1)
        return random_state(chosen, seed)
    run = run_to_start_from(name, chosen)
    if others := _other_values(chosen, run.scene):
        say(f"--start {name} was recorded with {others}: its last state is only where Newton's method begins.")
    phase = round(float(run.time[-1]) * run.scene.f * run.samples) % run.samples / run.samples
    return State(run.displacement[-1], run.velocity[-1], phase)


def _other_values(chosen: Scene, recorded: Scene) -> str:
    """Say in which values a recorded chain differs from the chosen one, apart from those that do not change its motion.
    """
    names = [f"{name} = {value:g}" if isinstance(value, float) else f"{name} = {value}"
             for name, value in {**recorded.knobs, "reference_overlap": recorded.reference_overlap}.items()
             if value != getattr(chosen, name) and name not in ("accuracy", "kappa")]  # kappa follows from k and A0
    others = ["other beads"] if (recorded.pattern, recorded.impurities) != (chosen.pattern, chosen.impurities) else []
    return ", ".join(others + names)
