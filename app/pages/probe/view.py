"""The Probe page: six figures of one bead, and a small one in its tab."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

from granchain_core import Run

from ...format import in_words
from ...parts.figures.streamed_figure import StreamedFigure
from ...parts.toolkit.component import text
from ...plots.json_item import figure_item
from ...plots.probe import FIGURES, closed_spells, probe_state, without_points
from ...plots.theme import Theme
from ...scripts import module


@cache
def empty_figures(theme: Theme) -> dict[str, Any]:
    """Return all figures without data, including the tab's small one."""
    full_size = {name: figure_item(without_points(name, theme)) for name in FIGURES}
    return {**full_size, "small": figure_item(without_points("phase", theme, compact=True))}


class Probe(StreamedFigure):
    """The overlay; its script shares the data of the small figure in its tab."""

    _esm = module("probe.js")
    _stylesheets = [text(f"{name}.css") for name in ("controls", "probe")]  # noqa: RUF012
    empty_figures = staticmethod(empty_figures)

    def __init__(self, receive: Callable[[dict[str, Any]], None] | None = None, **params: Any) -> None:
        super().__init__(receive, state={"bead": 1, "beads": 1, "sentence": ""}, **params)

    def fill(self, motion: Run, bead: int) -> None:
        """Fill the figures with a motion."""
        self.need_figures()
        self.update_state(bead=bead, beads=motion.scene.N, sentence=words(motion, bead))
        self.send(type="probe", drawn=probe_state(motion, bead))


def words(motion: Run, bead: int) -> str:
    """Describe the motion of the bead in one sentence."""
    u, v = (abs(values[:, bead - 1]).max() for values in (motion.displacement, motion.velocity))
    lasting = motion.time[-1] - motion.time[0]
    shut = [sum(end - begin for contact, begin, end in closed_spells(motion) if contact == beside) / lasting
            for beside in (bead - 1, bead)]
    return (f"Bead {bead} of {motion.scene.N}: up to {in_words(float(u), 'm', 3)} from its rest position, up to "
            f"{in_words(float(v), 'm/s', 3)} fast; its contacts are closed for {100 * shut[0]:.0f} % (driver’s side) "
            f"and {100 * shut[1]:.0f} % (wall’s side) of the time.")
