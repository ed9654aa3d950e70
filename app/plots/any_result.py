"""The figure of any result, which `granchain.figure` returns."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

from bokeh.layouts import column
from bokeh.models import LayoutDOM

from granchain_core import (
    Attractors,
    BadInput,
    Basins,
    BifurcationCurve,
    BifurcationDiagram,
    Branch,
    Curve,
    Driven,
    Fit,
    LyapunovSpectrum,
    Observation,
    Orbit,
    ParameterMap,
    Pulse,
    RotationNumber,
    Run,
    Settled,
    Spectrum,
    Transfer,
    WorkPrecision,
)
from granchain_core.experiment import Measured
from granchain_core.inputs.checks import unknown_name, whole_number
from granchain_core.paper import (
    EnergyMaps,
    Observers,
    Rig,
    RigResponse,
    ShakerAmplitude,
    Trains,
    Transmission,
)

from .accuracy import Annotations, accuracy
from .attractors import attractors
from .basins import basins
from .bifurcation_diagram import bifurcation_diagram
from .branches import branches
from .curve import curve
from .fit import fit
from .lyapunov import lyapunov
from .motion import driven, motion
from .multipliers import multipliers
from .observation import observation
from .paper import paper_figure, size_of
from .parameter_map import parameter_map
from .probe import FIGURES, probe
from .rotation import rotation
from .spectrum import spectrum
from .theme import THEMES, Theme
from .transfer import transfer

#: Default width of a figure [px]: the width of a notebook's cell.
WIDTH = 900
#: Default height of a figure [px].
HEIGHT = 420


def _settled(settled: Settled, theme: Theme) -> LayoutDOM:
    return motion(settled.run, theme)


def _pulse(pulse: Pulse, theme: Theme) -> LayoutDOM:
    return motion(pulse.run, theme)


def _curve(swept: Curve, theme: Theme, elastic: bool = False, measured: Measured | None = None) -> LayoutDOM:
    if measured is not None and not isinstance(measured, Measured):
        raise BadInput("A measured curve must be the value that granchain_core.experiment.read_experiment returns for "
                       f"a table of frequency and force, not a value of type {type(measured).__name__}.")
    return curve([swept], theme, elastic, measured)


def _branch(branch: Branch, theme: Theme, now: float | None = None) -> LayoutDOM:
    return branches([branch], theme, now)


def both_maps(result: ParameterMap, theme: Theme, shown: str = "both",
              curves: Sequence[BifurcationCurve] = ()) -> LayoutDOM:
    """Draw the map of forces above the map of regimes; if `shown` is "force" or "regime", draw only that one."""
    if shown != "both":
        return parameter_map(result, theme, shown, curves=curves)
    both = (parameter_map(result, theme, quantity, curves=curves) for quantity in ("force", "regime"))
    return column(*both, sizing_mode="stretch_both")


def measured_accuracy(result: WorkPrecision, theme: Theme, asked: float | None = None) -> LayoutDOM:
    """Draw error against time, with the cheapest way to the accuracy `asked`, by default the scene's."""
    wanted = result.scene.accuracy if asked is None else asked
    best = result.cheapest(wanted)
    agreement = result.agreement if math.isfinite(result.agreement) else None
    return accuracy(result.rows, Annotations(wanted, agreement, None if best is None else (best.wall_s, best.error)),
                    theme)


def _bifurcation_diagram(diagram: BifurcationDiagram, theme: Theme, bead: int | None = None) -> LayoutDOM:
    return bifurcation_diagram(diagram, diagram.scene.N if bead is None else bead, theme)


def _bead(name: str, motion_shown: Run | Settled, theme: Theme, bead: int | None = None) -> LayoutDOM:
    run = motion_shown.run if isinstance(motion_shown, Settled) else motion_shown
    return probe(name, run, run.scene.N if bead is None else whole_number("bead =", bead, 1, run.scene.N), theme)


#: The function that draws each class of results.
DRAWERS: dict[type, Callable[..., LayoutDOM]] = {
    Run: motion, Settled: _settled, Driven: driven, Pulse: _pulse, Curve: _curve, Orbit: multipliers, Branch: _branch,
    ParameterMap: both_maps, Observation: observation, WorkPrecision: measured_accuracy, Fit: fit, Spectrum: spectrum,
    Transfer: transfer, LyapunovSpectrum: lyapunov, RotationNumber: rotation, BifurcationDiagram: _bifurcation_diagram,
    Basins: basins, Attractors: attractors,
}
#: The functions that draw further figures, by the class of results and the figure's name in `kind`.
FURTHER_DRAWERS: dict[tuple[type, str], Callable[..., LayoutDOM]] = {
    **{(Run, name): partial(_bead, name) for name in FIGURES},
    **{(Settled, name): partial(_bead, name) for name in FIGURES},
}
_PAPER = (EnergyMaps, Observers, Rig, RigResponse, ShakerAmplitude, Trains, Transmission)
#: The functions for lists of results that are drawn over each other.
_TOGETHER: dict[type, Callable[..., LayoutDOM]] = {Curve: curve, Branch: branches}


def bokeh_figure_of(result: Any, theme: str = "light", width: int | None = None, height: int | None = None,
                    kind: str = "", **options: Any) -> LayoutDOM:
    """Draw the figure of a result with a fixed size; the docstring of `granchain.figure` describes the parameters."""
    drawn, size = _drawn(result, theme, kind, options)
    drawn.update(sizing_mode="fixed", width=width or size[0], height=height or size[1])
    return drawn


def stretched(result: Any, theme: str = "light", kind: str = "", **options: Any) -> LayoutDOM:
    """Draw the figure of a result so that it fills its page."""
    return _drawn(result, theme, kind, options)[0]


def _drawn(result: Any, theme: str, kind: str, options: Mapping[str, Any]) -> tuple[LayoutDOM, tuple[int, int]]:
    """Return the figure of a result, and the size in which it is easy to read."""
    if theme not in THEMES:
        raise unknown_name("theme", theme, THEMES)
    draw, size = (_further(result, kind), (WIDTH, HEIGHT)) if kind else _drawing(result)
    try:
        drawn = draw(result, THEMES[theme], **options)
    except TypeError as problem:
        unknown = [name for name in options if repr(name) in str(problem)]
        if not unknown:
            raise
        raise BadInput(f"The figure of a {type(result).__name__} has no option {unknown[0]!r}.") from None
    return drawn, size


def _further(result: Any, kind: str) -> Callable[..., LayoutDOM]:
    """Return the function that draws a further figure of a result."""
    offered = {name: draw for (drawn, name), draw in FURTHER_DRAWERS.items() if isinstance(result, drawn)}
    if not offered:
        raise BadInput(f"A result of type {type(result).__name__} has no figure of the kind {kind!r}; leave it out.")
    if kind not in offered:
        raise unknown_name("kind of figure", kind, tuple(offered))
    return offered[kind]


def _drawing(result: Any) -> tuple[Callable[..., LayoutDOM], tuple[int, int]]:
    """Return the function that draws a result, and the size in which it is easy to read."""
    if isinstance(result, _PAPER):
        return paper_figure, size_of(result)
    for kind, draw in DRAWERS.items():
        if isinstance(result, kind):
            return draw, (WIDTH, 2 * HEIGHT if kind is ParameterMap else HEIGHT)
    if isinstance(result, Sequence) and not isinstance(result, str) and result:
        for kind, draw in _TOGETHER.items():
            if all(isinstance(item, kind) for item in result):
                return draw, (WIDTH, HEIGHT)
    raise BadInput(f"A result of type {type(result).__name__} has no figure; there are figures of "
                   f"{', '.join(kind.__name__ for kind in DRAWERS)}, of lists of curves or branches, and of the "
                   "results of granchain_core.paper.compute.")
