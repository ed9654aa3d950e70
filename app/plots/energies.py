"""The colours of kinetic energy, from 0 to the largest value that a picture shows, and their colour bar.

The page, files and notebooks share the colours; each chooses the largest value in its own way.
"""

from __future__ import annotations

import math

from bokeh.models import BasicTicker, ColorBar, LinearColorMapper
from bokeh.palettes import Inferno256

from .theme import Theme

#: Number of colours.
_STEPS = 1024
#: Colours of evenly spaced energies from 0 to the largest. They follow the square root of the energy, which is
#: proportional to the speed, so that weak motion stays visible next to strong motion. The root is steepest where the
#: colours are dark, and this many steps are fine enough there.
ENERGY_COLOURS = [Inferno256[round(255 * math.sqrt(step / (_STEPS - 1)))] for step in range(_STEPS)]


def energy_mapper(high: float) -> LinearColorMapper:
    """Return the mapper from energies, from 0 to `high`, to colours."""
    return LinearColorMapper(palette=ENERGY_COLOURS, low=0.0, high=high)


def energy_hover(time_unit: str, energy_unit: str) -> list[tuple[str, str]]:
    """Return the tooltip for the place under the pointer."""
    return [("bead", "$x{0}"), ("time", f"$y{{0.000}} {time_unit}"),
            ("kinetic energy", f"@image{{0.000}} {energy_unit}")]


def bead_interval(beads: int, most: int) -> int:
    """Return the round interval between beads that are numbered on the axis, such that at most `most` are."""
    decade = 10 ** int(math.log10(max(1, beads / most)))
    return next(step * decade for step in (1, 2, 5, 10) if beads <= most * step * decade)


def energy_bar(mapper: LinearColorMapper, theme: Theme) -> ColorBar:
    """Return the colour bar, with the energies on its axis."""
    return ColorBar(color_mapper=mapper, width=12, padding=6, ticker=BasicTicker(desired_num_ticks=5),
                    background_fill_color=theme.card, major_label_text_color=theme.ink,
                    major_label_text_font_size=theme.smallest_figure_text, bar_line_color=None, name="energies")
