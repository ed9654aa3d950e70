"""The badge that is always there: regime, error reached, time per picture, method, effects."""

from __future__ import annotations

from typing import Any

from granchain_core import Run, Settled

from .component import Component, text


class Badge(Component):
    """One line at the bottom, and above it one sentence when something needs saying."""

    _esm = text("badge.js")
    _stylesheets = [text("controls.css"), text("badge.css")]  # noqa: RUF012


def settled_entries(picture: Settled) -> dict[str, Any]:
    """The badge of a settled picture."""
    ready = "" if picture.final else "preview, "
    return {
        "regime": ready + regime_words(picture),
        "start": f"from {picture.start}",
        **run_entries(picture.run),
    }


def regime_words(picture: Settled) -> str:
    """The regime in words, as the core found it."""
    regime = picture.regime
    return regime.sentence if regime.name in regime.sentence or regime.name == "periodic" else (
        f"{regime.name}, {regime.sentence}")


def _duration(seconds: float) -> str:
    return f"{seconds:.1f} s" if seconds >= 1.0 else f"{1e3 * seconds:.3g} ms"


def run_entries(run: Run) -> dict[str, Any]:
    """Error, cost, method and effects of a run."""
    error = run.error_estimate
    return {
        "error": "no claim" if error is None else f"{error:.0e}".replace("e-0", "e-"),
        "time": _duration(run.cost.wall_s),
        "method": run.cost.method,
        "effects": list(run.scene.effects),
    }
