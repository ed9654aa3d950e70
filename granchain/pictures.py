"""Figures of results, as the dashboard draws them."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from bokeh.models import LayoutDOM


def figure(result: Any, theme: str = "light", width: int | None = None, height: int | None = None,
           kind: str = "", **options: Any) -> LayoutDOM:
    """Draw a Bokeh figure of a result, with the functions that draw it on the dashboard's pages.

    Only the dashboard's main picture and its resonance curve have separate drawing code, because they follow every move
    of a knob. `bokeh.io.show` displays the figure (in a notebook, after `bokeh.io.output_notebook()`), and
    `bokeh.plotting.save` writes it to a file.

    Parameters
    ----------
    result : Run, Settled, Driven, Pulse, Curve, Orbit, Branch, ParameterMap, Observation, Fit, Spectrum, …
        The return value of a function of granchain, a list of curves or of branches, or a result of
        `granchain_core.paper.compute`.
    theme : str
        Name of a theme, "light" by default; `granchain figure --help` lists the names.
    width, height : int, optional
        Size of the figure [px]; by default a size that suits a notebook's cell.
    kind : str
        Another figure of the same result. Of a run or a settled motion: "displacement", "velocity", "forces", "phase"
        and "spectrum" of one `bead`, the last by default, and "contacts", as on the page Probe.
    **options
        Options of some figures: `elastic` of a curve, `measured` of a curve and of a driven motion (a measurement that
        `read_experiment` of granchain_core.experiment has read), `shown` ("force", "regime" or "both") and `curves`
        (the result of `bifurcation_curves`) of a parameter map, `bead` of a bifurcation diagram, `asked` (an accuracy)
        of a work-precision diagram, `now` (a value of the knob) of a branch, `rank` of an orbit.

    Returns
    -------
    bokeh.models.LayoutDOM
        The figure.

    Raises
    ------
    BadInput
        The result has no figure, or there is no such theme, kind or option.

    Examples
    --------
    >>> import granchain
    >>> curve = granchain.resonance_curve(granchain.scene("sec2").evolve(N=2), [1800.0, 2000.0, 2200.0])
    >>> granchain.figure(curve).xaxis[0].axis_label
    'drive frequency f (Hz)'
    """
    return part_of_app("plots.any_result").bokeh_figure_of(result, theme, width, height, kind, **options)


def part_of_app(name: str) -> Any:
    """Import a module of the dashboard's package, which is `app` in the source tree and `granchain_app` when installed.

    `entry` of granchain_start finds the package in the same way.
    """
    try:
        return importlib.import_module(f"granchain_app.{name}")
    except ModuleNotFoundError as missing:
        if missing.name != "granchain_app":
            raise
    return importlib.import_module(f"app.{name}")
