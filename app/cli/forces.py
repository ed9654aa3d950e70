"""The output for a motion, in JSON and in words: the scene, the largest forces, the errors and the cost."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from .common import say

if TYPE_CHECKING:
    from granchain_core import Driven, Run, Scene
    from granchain_core.results.forces import LargestForces
from granchain_core.results.run import Cost


def scene_json(scene: Scene) -> dict[str, Any]:
    """Return the scene of a result: its name, knobs and effects."""
    return {"scene": scene.name, "knobs": scene.knobs, "effects": scene.effects}


def forces_json(forces: LargestForces) -> dict[str, Any]:
    """Return the largest forces [N]."""
    return {"max_output_force": forces.max_output_force, "max_output_force_elastic": forces.max_output_force_elastic,
            "max_input_force": forces.max_input_force}


def errors_json(motion: Run | Driven) -> dict[str, Any]:
    """Return the relative errors of displacements and of each largest force, and the energy residual."""
    errors = motion.force_errors
    return {"error_estimate": motion.displacement_error, "error_estimate_output": errors.output,
            "error_estimate_input": errors.input, "error_estimate_elastic": errors.elastic,
            "energy_residual": motion.energy_residual}


def forces_in_words(forces: LargestForces) -> str:
    """Return the largest forces in one line."""
    return (f"largest output force {forces.max_output_force:.6g} N (elastic {forces.max_output_force_elastic:.6g} N), "
            f"input force {forces.max_input_force:.6g} N")


def errors_in_words(motion: Run | Driven) -> str:
    """Return the errors, the energy residual and the cost in one line."""
    errors = motion.force_errors
    inward, outward, elastic = ("none stated" if e is None else f"{e:.1e}"
                                for e in (errors.input, errors.output, errors.elastic))
    return (f"relative errors: displacement {motion.displacement_error:.1e}, "
            f"output force {outward} (elastic {elastic}), input force {inward}; "
            f"{energy_in_words(motion.energy_residual)}; {cost_in_words(motion.cost)}")


def status_in_words(status: str) -> str:
    """Say, from a `status`, whether the requested accuracy was reached."""
    return {"done": "accuracy reached", "accuracy-not-reached": "accuracy not reached",
            "over-budget": "accuracy not reached within the budget"}[status]


def energy_in_words(residual: float | None) -> str:
    """Say how well the energy account closes; a method in (u, v) does not have one."""
    return "no energy account" if residual is None else f"energy closes to {residual:.1e}"


def cost_in_words(cost: Cost) -> str:
    """Return method, steps, events and time in one line."""
    return f"{cost.method}, {cost.steps} steps, {cost.events} contact events, {1e3 * cost.wall_s:.1f} ms"


def warn(result: Run, budget: float) -> None:
    """Report on stderr what the numbers do not show: warnings, an accuracy not reached, unresolved touches."""
    from granchain_core.runs.to_accuracy import warnings

    for warning in warnings(result):
        say(warning)
    accuracy, error = result.scene.accuracy, result.displacement_error
    if result.status == "accuracy-not-reached":
        say(f"The accuracy asked for, {accuracy:g}, was not reached: the error may be {error:.1e} of the largest "
            f"displacement.{_forces_in_words(result)}")
    if result.status == "over-budget":
        say(f"A finer computation would not fit the budget of {budget:g} s: the error may be {error:.1e} of the "
            f"largest displacement, and {accuracy:g} was asked for.")
    if result.jumps.unresolved:
        say(f"{result.jumps.unresolved} touches were shorter than a step of {result.cost.method} and are not resolved: "
            "their jumps are read off the step's ends.")


def _forces_in_words(result: Run) -> str:
    """Return a sentence if the largest forces are accurate enough and a displacement is not; otherwise return ""."""
    stated = [error for error in asdict(result.force_errors).values() if error is not None]
    if not stated or max(stated) > result.scene.accuracy:
        return ""
    return f" The largest forces reached it, with {max(stated):.1e}."
