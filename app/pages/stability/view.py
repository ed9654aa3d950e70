"""The Stability page: multipliers, a mode, the section and the evidence, in words and as data for the browser."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from granchain_core import Settled
from granchain_core.integrate.methods import RK4_SPLIT
from granchain_core.orbits import Orbit
from granchain_core.orbits.modes import Mode
from granchain_core.orbits.unit_circle import nearest_to_circle
from granchain_core.results.regime import exponent_words, modulus_words
from granchain_core.steady.poincare import Section
from granchain_core.steady.regime_criteria import LONGEST_LOCKED_PERIOD

from ...format import UNSURE_FIGURES, duration, figures_of, prefixed, short_error, with_figures
from ...parts.chain.chain import drawn_chain
from ...parts.figures.streamed_figure import StreamedFigure
from ...parts.toolkit.component import text
from ...plots.json_item import figure_item
from ...plots.multipliers import multiplier_words, plane, plane_state
from ...plots.section import SectionPoints, close_up, section, section_state
from ...plots.theme import Theme
from ...scripts import module
from .work import PHASES, OrbitAnalysis

#: Most significant figures of a |μ| with its error.
_FIGURES_OF_A_MULTIPLIER = 6


@cache
def empty_figures(theme: Theme) -> dict[str, Any]:
    """Return the plane, also small for the tab, and the section, all without points."""
    empty = plane_state(None)
    nothing = SectionPoints(np.zeros((1, 2)), np.zeros((0, 2)), 1, 0, False, 1, ("m", "m/s"))
    return {"section": figure_item(section(nothing, theme)), "plane": figure_item(plane(empty, theme)),
            "small": figure_item(plane(empty, theme, compact=True))}


class Stability(StreamedFigure):
    """The overlay; its script shares the data of the small version in its tab."""

    _esm = module("stability.js")
    _stylesheets = [text(f"{name}.css") for name in ("controls", "drawing", "stability")]  # noqa: RUF012
    empty_figures = staticmethod(empty_figures)

    def __init__(self, receive: Callable[[dict[str, Any]], None] | None = None, **params: Any) -> None:
        super().__init__(receive, state={"longest_period": LONGEST_LOCKED_PERIOD, "phases": PHASES}, **params)

    def section(self, shown: SectionPoints) -> None:
        """Show another section."""
        self.need_figures()
        self.send(**section_message(shown))


def period_words(orbit: Orbit) -> str:
    """Return one period of the orbit in drive periods and seconds."""
    n = orbit.period
    return f"{n} drive period{'s' if n > 1 else ''}, {duration(n * orbit.scene.period)}"


def verdict(orbit: Orbit) -> str:
    """Say whether a disturbance of the orbit dies out or, if it does not, how it grows."""
    leading = complex(orbit.multipliers[0])
    size = abs(leading)
    if orbit.multiplier_errors is not None and not orbit.stability_certain:
        nearest = nearest_to_circle(orbit.multipliers, orbit.multiplier_errors, orbit.scene.has_dissipation)
        return (f"Not decided: a |μ| is {modulus_words(abs(orbit.multipliers[nearest]))} ± "
                f"{short_error(orbit.multiplier_errors[nearest])}, no farther from 1 than its error, for one period of "
                f"the orbit ({period_words(orbit)}).{_observed(orbit)}")
    if orbit.stable and not orbit.scene.has_dissipation:
        return (f"Stable: without damping, a disturbance neither grows nor shrinks in one period of the orbit "
                f"({period_words(orbit)}).{_observed(orbit)}")
    if orbit.stable:
        return (f"Stable: a disturbance shrinks to {modulus_words(size)} of itself in one period of the orbit "
                f"({period_words(orbit)}).{_observed(orbit)}")
    outside = int(orbit.multipliers_outside.sum())
    rest = "" if outside <= 1 + (leading.imag != 0.0) else f" {outside} multipliers are outside the circle."
    return (f"Unstable: a disturbance grows {modulus_words(size)}-fold in one period of the orbit "
            f"({period_words(orbit)}) and {_leaves(leading)}.{rest}{_observed(orbit)}")


def _observed(orbit: Orbit) -> str:
    """Describe the observer's stability, if its multipliers were computed."""
    if orbit.observer_multipliers is None:
        return ""
    size = float(np.abs(orbit.observer_multipliers).max())
    certain = orbit.observer_multiplier_errors is None or orbit.observer_stability_certain
    decided = "stable" if orbit.observer_stable else "unstable"
    stability = decided if certain else "not decided to be stable or unstable"
    return f" Its observer is {stability}, |μ| {modulus_words(size)}."


def _leaves(leading: complex) -> str:
    if leading.imag != 0.0:
        return "turns while it grows: a complex pair outside the circle, as beyond a Neimark–Sacker bifurcation"
    if leading.real > 0.0:
        return "leaves to one side: a multiplier above +1, as beyond a fold"
    return "changes sides in each orbit: a multiplier below −1, as beyond a period doubling"


def no_multipliers(settled: Settled) -> str:
    """Say why a motion that does not repeat has no multipliers."""
    regime = settled.regime
    if not regime.driven:
        return "No multipliers: nothing drives the chain, and only a motion that repeats has them."
    if regime.lyapunov is None or regime.name == "unsettled":
        return (f"No multipliers: the chain has not settled after {regime.periods_run} periods, and only a motion that "
                "repeats has them.")
    mean, error = regime.lyapunov
    parts = (f"Neighbouring motions part {math.exp(mean):.2f}-fold per drive period" if regime.name == "chaotic" else
             "Neighbouring motions neither part nor meet")
    return (f"No multipliers: the motion is {regime.name} and never repeats. {parts} (Lyapunov exponent "
            f"{exponent_words(mean, error)}).")


def multiplier_sentence(orbit: Orbit, rank: int) -> str:
    """Describe the multiplier of this rank, or the last one, in one sentence."""
    value, modulus, *_ = multiplier_words(complex(orbit.multipliers[:rank + 1][-1]), orbit)
    return f"ringed: μ = {value}, |μ| {modulus}"


def evidence(settled: Settled, analysis: OrbitAnalysis | None, section: Section | None) -> list[dict[str, str]]:
    """Return name, value and meaning of all evidence for the verdict; a number that was not computed has no row."""
    regime, rows = settled.regime, []

    def row(name: str, value: str, meaning: str) -> None:
        rows.append({"name": name, "value": value, "meaning": meaning})

    kind = regime.name + (f", period {regime.period}" if regime.period else "")
    row("regime", f"{kind}, {regime.periods_run} period{'s' * (regime.periods_run != 1)} run from {settled.start}",
        "The regime, and the number of drive periods after which it was decided.")
    if regime.distance is not None:
        row("distance to the orbit", f"≤ {short_error(regime.distance)}, same method",
            "Bound on the relative distance of the settled picture from the orbit of the method that settled it: its "
            "change over one orbit times r/(1 − r), where r is |μ|, or the decay if |μ| was not computed, or ½ if "
            "neither is known.")
    if regime.lyapunov is not None:
        row("Lyapunov exponent", f"{exponent_words(*regime.lyapunov)} per drive period",
            "Mean rate at which neighbouring motions separate, with its standard error over blocks of periods"
            + (f"; measured over {regime.lyapunov_periods} periods." if regime.lyapunov_periods else "."))
    if regime.return_distance is not None:
        row("return of the section", f"{regime.return_distance:.2g}, limit {regime.return_limit or 0.0:.2g}",
            "Median distance from later states of the section to the nearest earlier one, relative to the motion; a "
            "quasi-periodic motion stays below the limit.")
    if regime.window_ratios is not None:
        row("change from window to window", " to ".join(f"{ratio:.3f}" for ratio in regime.window_ratios),
            "Smallest and largest ratio of the largest change in 100 periods to that in the 100 before, over all "
            "periods tried: 1 if nothing shrinks or grows.")
    if analysis is not None:
        _orbit_rows(row, settled, analysis)
    cost = settled.run.cost
    row("settled by", f"{cost.method}, {cost.steps} steps, {duration(cost.wall_s)}",
        "Method, steps and computing time of the settled picture.")
    if section is not None:
        row("section", f"{section.periods} periods at {section.samples} phases, {RK4_SPLIT}",
            "Computed again from the same start by the fixed-step method.")
    return rows


def _orbit_rows(row: Any, settled: Settled, analysis: OrbitAnalysis) -> None:
    orbit = analysis.orbit
    size = abs(orbit.multipliers[0])
    seen = settled.regime.observed_contraction
    decay = f"; {modulus_words(seen)} per orbit seen while it settled" if analysis.target.followed and seen else ""
    row("|μ| largest", _size_words(float(size), orbit) + decay,
        "The largest multiplier with its error (the change to a map of ten times the tolerance, by the multiplier's "
        "condition), and how fast the changes from period to period died out while settling.")
    residuals = analysis.target.residuals or orbit.newton_residuals
    row("Newton's residual", " → ".join(short_error(r) for r in residuals),
        "Change over one orbit, relative to the largest displacement and w, before each Newton step and at the end.")
    if analysis.target.followed:
        row("settled state", f"{short_error(analysis.distance)} away",
            "Relative distance of the settled picture from the orbit of the exact map, which Newton's method found "
            "from it: the error of the method that settled it.")
    if analysis.target.distance_of_motion is not None:
        row("nearest to the motion", f"{analysis.target.distance_of_motion:.2g} of its size",
            "Newton's method was started near the motion and may end elsewhere: smallest distance of the orbit from "
            "the states of the section, relative to their largest displacement and velocity.")
    why = ("the smallest multipliers are below rounding" if len(orbit.multipliers) == 2 * orbit.scene.N
           else f"only the {len(orbit.multipliers)} leading multipliers are computed")
    row("product of all μ", why if orbit.liouville_error is None else f"{short_error(orbit.liouville_error)} off",
        "Liouville's theorem: the logarithm of the multipliers' product and the integral of the equations' trace are "
        "equal; their relative difference.")
    row("disturbance followed", f"{short_error(max(analysis.mode.closure, 1e-16))} off",
        "A small disturbance along the eigenvector, integrated over one orbit: the relative distance of its end from "
        "μ times its start.")
    row("multipliers by", f"linearised equations, {duration(analysis.wall_s)}",
        "The equations linearised along the orbit are integrated with it (the tangent flow, by dop853); computing time "
        "of orbit, multipliers and mode.")


def _size_words(size: float, orbit: Orbit) -> str:
    """Return the largest |μ| with the significant figures that its error allows, and the error."""
    if orbit.multiplier_errors is None:
        return modulus_words(size)
    error = float(orbit.multiplier_errors[0])
    figures = figures_of(error / size, _FIGURES_OF_A_MULTIPLIER) if size > 0.0 else UNSURE_FIGURES
    return f"{with_figures(size, figures)} ± {short_error(error)}"


def mode_message(mode: Mode, orbit: Orbit) -> dict[str, Any]:
    """Return a mode for the chain: real and imaginary part, (rows, beads), and the direction of its multiplier."""
    turn = mode.multiplier / abs(mode.multiplier) if mode.multiplier else 1.0
    factor, letter = prefixed(orbit.period * orbit.scene.period)
    return {
        "type": "mode", **drawn_chain(orbit.scene), "samples": mode.samples, "period": mode.period,
        "turn_re": float(turn.real), "turn_im": float(turn.imag), "size": abs(mode.multiplier),
        "time": orbit.period * orbit.scene.period / factor, "time_unit": f"{letter}s",
        "values": np.concatenate([np.real(mode.displacement).ravel(), np.imag(mode.displacement).ravel()],
                                 dtype=np.float32),
    }


def section_points(section: Section, on_the_way: int, orbit: Section | None, bead: int, phase: int, period: int = 0,
                   unstable: bool = False) -> SectionPoints:
    """Return the points of one bead at one phase, and the orbit's points; all were computed at exactly this phase."""
    points = section.points(bead, phase)
    own = np.zeros((0, 2)) if orbit is None else orbit.points(bead, phase)
    factors, units = zip(*(prefixed(float(np.abs(np.concatenate([points, own])[:, i]).max())) for i in (0, 1)),
                         strict=True)
    return SectionPoints(points / np.array(factors), own / np.array(factors), on_the_way, period, unstable, bead,
                         (f"{units[0]}m", f"{units[1]}m/s"))


def section_message(shown: SectionPoints) -> dict[str, Any]:
    """Return the data that the browser puts into its figure, and the ranges of the close-up."""
    return {"type": "section", "drawn": section_state(shown), "near": close_up(shown), "count": len(shown.points),
            "own": len(shown.own)}
