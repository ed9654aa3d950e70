"""Figure 3: kinetic energy over bead and time, next to the driver's displacement and the force on bead 1."""

from __future__ import annotations

from bokeh.layouts import row
from bokeh.models import LayoutDOM, Range1d

from granchain_core.paper import EnergyMaps
from granchain_core.paper.results import repeated

from ..motion import Units, drive_panel, energy_panel
from ..theme import Theme

_UNITS = Units((1e-3, "ms"), (1e-6, "µm"), (1.0, "N"), (1e-6, "µJ"))
_LETTERS = {"fig3a": "(a)", "fig3b": "(b)"}


def energy(shown: EnergyMaps, theme: Theme) -> LayoutDOM:
    """Draw a pair of panels for each orbit, with time downwards on both."""
    panels = []
    for settled, periods in shown.parts:
        index, seconds = repeated(settled.run, periods)
        time = Range1d(periods / (_UNITS.time[0] * settled.run.scene.f), 0.0)
        drive = drive_panel(settled.run, index, seconds, time, _UNITS, theme)
        drive.title.text = _LETTERS[settled.run.scene.name]
        panels += [drive, energy_panel(settled.run, index, time, _UNITS, theme)]
    return row(panels, sizing_mode="stretch_both")
