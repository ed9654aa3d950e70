"""The Branches page: periodic orbits over the drive frequency, stable and unstable, with their special points."""

from __future__ import annotations

from typing import Any

from granchain_core.orbits import BranchPoint, SpecialPoint

from ...parts.component import Component, text
from ...scripts import module

_WORDS = {"fold": "fold", "period_doubling": "period doubling", "neimark_sacker": "Neimark–Sacker",
          "grazing": "grazing"}


class Branches(Component):
    """The page over the pictures; the growing branch comes in messages."""

    _esm = module("branches.js")
    _stylesheets = [text("controls.css"), text("drawing.css"), text("branches.css")]  # noqa: RUF012


def drawn_orbits(points: list[BranchPoint], special: list[SpecialPoint]) -> list[BranchPoint]:
    """What is drawn of a piece of a branch, in order.

    The two orbits around each special point belong to it: so the line changes its dash where stability changes.
    """
    return sorted([*points, *(p for s in special for p in (s.before, s.after))], key=lambda point: point.arclength)


def described_orbit(point: BranchPoint) -> list[float]:
    """Frequency, largest elastic output force, whether it is stable, largest |μ|, input and total output force."""
    return [point.knob, point.max_output_force_elastic, int(point.stable), float(abs(point.multipliers[0])),
            point.max_input_force, point.max_output_force]


def described_special(special: SpecialPoint, place: int) -> dict[str, Any]:
    """A special point with the words of its hover; `place` is its number on the page."""
    low, high = special.interval
    half = 0.5 * (high - low)
    told = f"{_WORDS[special.kind]} at {special.knob:.4f} ± {half:.4f} Hz"
    if special.contact is not None:
        told += f": contact {special.contact} has one {special.event} more on one side"
    elif special.kind == "neimark_sacker" and special.multiplier is not None:
        told += f": a pair μ = {special.multiplier.real:+.3f} ± {abs(special.multiplier.imag):.3f}i passes the circle"
    return {"kind": special.kind, "f": special.knob, "force": special.before.max_output_force_elastic, "told": told,
            "place": place}
