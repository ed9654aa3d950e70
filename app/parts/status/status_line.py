"""The status line: regime, force at the wall, error reached, computing time, method, effects."""

from __future__ import annotations

from typing import Any

from granchain_core import Run, Settled
from granchain_core.integrate import METHODS
from granchain_core.kernels.strobes.periodicity import SETTLED_DISTANCE
from granchain_core.results.regime import NEVER_REPEATING, Regime, modulus_words
from granchain_core.steady.curve.resonance import STOP_BAND_FRACTION, Place, place_words, push_words, pushes

from ...format import duration, short_error
from ...scripts import module
from ..toolkit.component import Component, text

#: The meanings of the names of places on the curve.
_PLACES = {
    "peak": "Resonance: a peak of the curve, where more arrives at the wall than at neighbouring frequencies.",
    "valley": "Anti-resonance: a valley of the curve, where less arrives at the wall than at neighbouring frequencies.",
    "flank": "Flank: between a peak of the curve and the valley next to it.",
    "stop band": f"Stop band: above the last peak, less than {100 * STOP_BAND_FRACTION:.0f} % of the input force "
                 "reaches the wall.",
}
#: The meanings of the names of regimes that are not periodic.
_REGIME_MEANINGS = {
    "quasi-periodic": "Quasi-periodic: it returns close to every earlier state, but never exactly.",
    "chaotic": "Chaotic: it never repeats, and small disturbances grow.",
    "unsettled": "Not settled: the regime could not be determined in the periods that were run.",
}
_UNDRIVEN = "Nothing drives the chain: the picture begins at the start of the motion."
_NOT_ITS_PLACE = "The ratio counts pushes, not peaks: every anti-resonance is 1:1, whatever peaks it lies between."
_CONTRACTION = "Transient shrinks to: observed factor by which the distance to the orbit shrinks per orbit."
_LYAPUNOV = ("Lyapunov exponent: mean growth of a small disturbance, as the logarithm of its factor per drive period. "
             "If it is clearly above zero, the motion is chaotic.")
_FOLLOWED = ("Followed to its orbit: the motion approached it so slowly that the orbit was computed from the last "
             "periods, by Newton's method or extrapolation.")
_SETTLED = ("Settled: number of drive periods run until the bound on the distance to the periodic orbit was "
            f"at most {SETTLED_DISTANCE:g} of the motion.")


class StatusLine(Component):
    """One line at the bottom, and above it a message if there is one."""

    _esm = module("status_line.js")
    _stylesheets = [text("controls.css"), text("status_line.css")]  # noqa: RUF012


def settled_entries(settled: Settled, place: Place | None, force: str) -> dict[str, Any]:
    """Return the entries of the line for a settled picture.

    `place` is where it lies on the curve from rest, None while that is being computed; `force` is the largest output
    force in words.
    """
    regime, pushed = settled.regime.sentence, pushes(settled.run)
    name = regime.split(",")[0]  # without the evidence
    return {
        "regime": regime_words(settled, pushed, place, regime),
        "regime_shorter": [regime_words(settled, pushed, place, name), regime_words(settled, pushed, Place(""), name)],
        "regime_hint": regime_hint(settled.regime, pushed, place),
        "start": "from its initial velocities" if settled.run.scene.moves_at_start and settled.start == "rest" else
                 f"from {settled.start}",
        **run_entries(settled.run, force),
    }


def regime_words(settled: Settled, pushed: tuple[int, int] | None, place: Place | None, regime: str) -> str:
    """Return the motion in words: strong pushes of the driver in n periods, its place on the curve, and its regime."""
    ready = "" if settled.final else "preview, "
    counted = place_words(pushed, place)
    return ready + (f"{counted}, " if counted else "") + regime


def regime_hint(regime: Regime, pushed: tuple[int, int] | None, place: Place | None) -> str:
    """Return an explanation of the line's words: ratio, place on the curve, regime and its evidence."""
    meanings = []
    if pushed is not None:
        meanings.append(f"{pushed[0]}:{pushed[1]}: {push_words(pushed)}.")
        meanings.append(_PLACES.get(place.kind, "") if place is not None else "")
        meanings.append(_NOT_ITS_PLACE if place is not None and place.kind == "valley" else "")
    if regime.name == "periodic":
        meanings.append(_FOLLOWED if regime.is_approach else _SETTLED)
    else:
        meanings.append(_REGIME_MEANINGS[regime.name] if regime.driven else _UNDRIVEN)
    if regime.lyapunov is not None and regime.name != "periodic":
        meanings.append(_LYAPUNOV)
    if regime.evidence:
        meanings.append(_CONTRACTION if regime.multiplier is None else
                        multiplier_words(regime.multiplier, regime.period or regime.approaches or 1))
    return " ".join(meaning for meaning in meanings if meaning)


def multiplier_words(modulus: float, period: int) -> str:
    """Return the meaning of |μ| for a small disturbance of an orbit of `period` drive periods."""
    orbit = "drive period" if period == 1 else f"{period} drive periods"
    words = modulus_words(modulus)
    change = f"shrinks to {100.0 * modulus:.3g} %" if modulus < 1.0 else f"grows by the factor {words}"
    return (f"|μ| {words}: the slowest-decaying part of a small disturbance {change} in every {orbit}; "
            "below 1 the orbit is stable.")


def error_words(error: float | None, before: str = "") -> str:
    """Return a relative error after `before`, or the words for an error that is not estimated."""
    return "not estimated" if error is None else before + short_error(error)


def accuracy_words(run: Run) -> str:
    """Return the accuracy asked for and reached."""
    reached = error_words(run.displacement_error, "reached ")
    return f"asked {short_error(run.scene.accuracy)} · {reached}{_worse_forces(run)}"


#: If the accuracy asked for is reached, errors of forces up to this factor above the error of displacements are shown
#: only in the hint: the line has room for one number.
_ALIKE_FACTOR = 10.0


def _worse_forces(run: Run) -> str:
    """Return the larger error of the two largest forces if it misses the accuracy or is far above the one reached."""
    errors = [(error, name) for error, name in ((run.force_errors.output, "output force"),
                                                (run.force_errors.input, "input force")) if error is not None]
    worst, name = max(errors, default=(0.0, ""))
    if run.displacement_error is None or worst <= min(run.scene.accuracy, _ALIKE_FACTOR * run.displacement_error):
        return ""
    return f" ({name} {short_error(worst)})"


def why_no_error(run: Run) -> str:
    """Return the reason why no error of the displacements is stated; empty if one is."""
    if run.displacement_error is not None:
        return ""
    if run.regime.name in NEVER_REPEATING:
        grows = "grows in every period" if run.regime.name == "chaotic" else "adds up from period to period"
        return f" Why none: in a {run.regime.name} motion the error of an instant {grows}, however small the steps are."
    return " Why none: the motion has not settled, and errors are stated for steady states."


def force_hint(run: Run) -> str:
    """Return an explanation of the force in the line, with its error."""
    return ("The largest output force in the periods shown, the dashpot's part included; relative error "
            f"{error_words(run.force_errors.output)}. A force is positive where the bodies push; below zero, "
            "the dashpot of an opening contact pulls. The force at the wall may be larger than that of the driver: a "
            f"wave presses harder where it is reflected."
            f"{why_no_error(run) if run.force_errors.output is None else ''}")


def errors_hint(run: Run) -> str:
    """Return the error of each quantity: displacements, and the three largest forces."""
    errors = [f"{name} {error_words(error)}" for name, error in (
        ("displacements", run.displacement_error), ("largest output force", run.force_errors.output),
        ("its elastic part", run.force_errors.elastic), ("largest input force", run.force_errors.input))]
    return ("“Asked” is the knob ε, “reached” the relative error of the displacements, and the time is "
            "that of the computation, longer if the machine is busy. Relative errors of the numerical solution: "
            f"{', '.join(errors)}.{why_no_error(run)} How well the model fits an experiment is another question: the "
            "tab “data” compares it with yours, and the page “paper” with what the paper states about its rig.")


def run_entries(run: Run, force: str) -> dict[str, Any]:
    """Return the entries for largest output force, accuracy, method and effects of a run."""
    return {
        "force": f"{force} at the wall",
        "force_hint": force_hint(run),
        "accuracy": f"{accuracy_words(run)} · in {duration(run.cost.wall_s)}",
        "accuracy_shorter": [accuracy_words(run)],
        "accuracy_hint": errors_hint(run),
        "energy": "" if run.energy_residual is None else f"energy residual {short_error(run.energy_residual)}",
        "method": run.cost.method,
        "method_hint": f"Integration method: {METHODS[run.cost.method].title}.",
        "effects": list(run.scene.effects),
    }
