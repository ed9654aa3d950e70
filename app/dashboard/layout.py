"""All views of the dashboard, and the document that contains them."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from bokeh.document import Document
from bokeh.models import Plot, Range1d

from granchain_core.experiment.formats import FORMATS

from ..curve.curve_bar import KINDS, CurveBar
from ..curve.view import CurveFigure
from ..parts.chain.chain import SCALES, ChainPart
from ..parts.equation.equation import EquationPart
from ..parts.figures.figure_style import BOTTOM, GAP, LEFT, TOP
from ..parts.header.header import Header
from ..parts.knobs.knobs import Knobs
from ..parts.status.status_line import StatusLine
from ..parts.time_figures.energy import EnergyMap
from ..parts.time_figures.trains import WIDEST_TITLES, ForceTrains
from ..parts.toolkit.component import text
from ..plots.curve import KEY
from ..plots.energies import ENERGY_COLOURS
from ..plots.theme import Theme, style_sheet
from ..plots.themed import follow_theme
from ..scripts import INLINE_SCRIPTS, modules
from ..serve.http.limits import LARGEST_UPLOAD
from ..session.page_constants import page_constants
from ..session.session import Session
from .scales import PictureScales
from .table import GROUPS, PAGES, described_tabs, watched_pages
from .tabs import Tabs
from .template import put_into

_HERE = Path(__file__).resolve().parent


class Views:
    """All parts of the page; their messages go to `receive`."""

    def __init__(self, session: Session, receive: Callable[[dict[str, Any]], None],
                 choose: Callable[[object], None]) -> None:
        self.time = Range1d(start=1.0, end=0.0)
        self.scales = PictureScales(session)
        self.header = Header(receive)
        self.knobs = Knobs(receive, sizing_mode="stretch_width")
        self.equation = EquationPart(receive)
        self.chain = ChainPart(receive, sizing_mode="stretch_both",
                               state={"palette": ENERGY_COLOURS, "titles": WIDEST_TITLES, "scales": SCALES})
        self.trains = ForceTrains(self.time)
        self.energy = EnergyMap(self.time)
        self.curve = CurveFigure(choose)
        self.curve_bar = CurveBar(receive)
        self.tabs = Tabs(receive, sizing_mode="stretch_both", state={
            "largest_file": LARGEST_UPLOAD, "lines": KEY, "tabs": described_tabs(), "groups": GROUPS,
            "pages": watched_pages(), "regimes": KINDS,
            "endings": [ending for form in FORMATS for ending in form.endings]})
        self.overlays = {row.name: row.view(receive, sizing_mode="stretch_both") for row in PAGES if row.view}
        self.status_line = StatusLine(receive)

    def set_compact(self, compact: bool) -> None:
        """Shorten titles and leave out numbers on the time axes if there is little room."""
        self.trains.set_compact(compact)
        self.energy.set_compact(compact)
        self.curve.set_compact(compact)

    def apply_theme(self, theme: Theme) -> None:
        """Draw the figures of the main page and of all pages in another theme; the style sheet does the rest.

        The energy map has the same colours in every theme; dashboard.css styles its surroundings.
        """
        for plot in self._plots:
            follow_theme(plot, theme)
        for overlay in self.overlays.values():
            overlay.apply_theme(theme)

    def put_into(self, document: Document) -> None:
        """Make all parts roots of a session's document; dashboard.css lays them out in a grid."""
        parts = {
            "header": self.header, "knobs": self.knobs, "equation": self.equation, "chain": self.chain,
            "curvebar": self.curve_bar, "tabs": self.tabs, "status_line": self.status_line, **self.overlays,
        }
        put_into(document, parts, self._plots, *_template())

    @property
    def _plots(self) -> tuple[Plot, ...]:
        return self.trains.left, self.energy.figure, self.trains.right, self.curve.figure


@cache
def _template() -> tuple[str, dict[str, Any]]:
    """Return the template of the page and its variables, the same for every session."""
    return (_HERE / "dashboard.html").read_text(encoding="utf-8"), {
        "dashboard_css": style_sheet() + text("dashboard.css") + text("skeleton.css"),
        "inline_scripts": "".join(map(text, INLINE_SCRIPTS)),
        "page_constants": page_constants(),
        "modules": modules(),
        "frame_top": TOP, "frame_bottom": BOTTOM, "frame_left": LEFT, "gap": GAP,
        "overlays": [(row.name, row.name.capitalize()) for row in PAGES if row.view],
    }
