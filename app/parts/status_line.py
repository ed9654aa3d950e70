"""The status line: regime, force at the wall, error reached, computing time, method, effects."""

from __future__ import annotations

from typing import Any

from granchain_core import Run, Settled
from granchain_core.steady.curve.resonance import Place, place_words, push_words, pushes

from ..format import duration, short_error
from ..scripts import module
from .component import Component, text


class StatusLine(Component):
    """One line at the bottom, and above it one sentence when something needs saying."""

    _esm = module("status_line.js")
    _stylesheets = [text("controls.css"), text("status_line.css")]  # noqa: RUF012


def settled_entries(picture: Settled, place: Place | None, force: str) -> dict[str, Any]:
    """The line for a settled picture.

    `place` is where it lies on the curve from rest, None while there is none; `force` is the largest output force in
    words.
    """
    regime, pushed = picture.regime.sentence, pushes(picture.run)
    name = regime.split(",")[0]  # without the evidence
    return {
        "regime": regime_words(picture, pushed, place, regime),
        "regime_shorter": [regime_words(picture, pushed, place, name), regime_words(picture, pushed, Place(""), name)],
        "regime_hint": regime_hint(picture, pushed),
        "start": f"from {picture.start}",
        **run_entries(picture.run, force),
    }


def regime_words(picture: Settled, pushed: tuple[int, int] | None, place: Place | None, regime: str) -> str:
    """The motion in words: strong pushes of the driver in how many periods, what the curve has here, and its regime."""
    ready = "" if picture.final else "preview, "
    counted = place_words(pushed, place)
    return ready + (f"{counted}, " if counted else "") + regime


def regime_hint(picture: Settled, pushed: tuple[int, int] | None) -> str:
    """What the ratio and the multiplier in the line mean; empty where it has neither."""
    meanings = []
    if pushed is not None:
        meanings.append(f"{pushed[0]}:{pushed[1]}: {push_words(pushed)}.")
    if "|μ|" in picture.regime.sentence:
        meanings.append("|μ|: factor by which a small disturbance changes in one orbit; below 1 the orbit is stable.")
    return " ".join(meanings)


def error_words(error: float | None, before: str = "") -> str:
    """A relative error with what stands before it, or that there is none."""
    return "not estimated" if error is None else before + short_error(error)


def accuracy_words(run: Run) -> str:
    """The accuracy asked for and reached."""
    return f"asked {short_error(run.scene.accuracy)} · {error_words(run.error_estimate, 'reached ')}"


def force_hint(run: Run) -> str:
    """What the force of the line is, and its error."""
    return ("The largest output force in the periods shown, the dashpot's part included; relative error "
            f"{error_words(run.force_errors.output)}.")


def errors_hint(run: Run) -> str:
    """The error of each quantity: displacements, and the three largest forces."""
    errors = [f"{name} {error_words(error)}" for name, error in (
        ("displacements", run.error_estimate), ("largest output force", run.force_errors.output),
        ("its elastic part", run.force_errors.elastic), ("largest input force", run.force_errors.input))]
    return f"Relative errors: {', '.join(errors)}. Click to see what accuracy costs."


def run_entries(run: Run, force: str) -> dict[str, Any]:
    """Largest output force, accuracy, method and effects of a run."""
    return {
        "force": f"{force} at the wall",
        "force_hint": force_hint(run),
        "accuracy": f"{accuracy_words(run)} · in {duration(run.cost.wall_s)}",
        "accuracy_shorter": [accuracy_words(run)],
        "accuracy_hint": errors_hint(run),
        "energy": "" if run.energy_residual is None else f"energy residual {short_error(run.energy_residual)}",
        "method": run.cost.method,
        "effects": list(run.scene.effects),
    }
