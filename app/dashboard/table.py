"""The table of pages, from which layout, controller, overlays and tabs are made."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from ..pages.accuracy.page import AccuracyPage
from ..pages.accuracy.view import Accuracy
from ..pages.analysis.page import AnalysisPage
from ..pages.analysis.view import Analysis
from ..pages.branches.page import BranchesPage
from ..pages.branches.view import Branches
from ..pages.data.page import DataPage
from ..pages.effects.page import EffectsPage
from ..pages.hard_cases.page import HardCasesPage
from ..pages.hard_cases.view import ABOUT, HardCases
from ..pages.map.page import MapPage
from ..pages.numbers.page import NumbersPage
from ..pages.observer.page import ObserverPage
from ..pages.observer.view import Observer
from ..pages.paper.page import PaperPage
from ..pages.paper.view import Paper
from ..pages.probe.page import ProbePage
from ..pages.probe.view import Probe
from ..pages.stability.page import StabilityPage
from ..pages.stability.view import Stability
from ..pages.stories.page import StoriesPage
from ..parts.toolkit.component import Component
from ..session.host import PageHost
from ..session.page import Page
from ..session.page_constants import CURVE_NAME

#: The heights of a tab.
Height = Literal["usual", "taller", "tallest"]


@dataclass(frozen=True)
class TabSpec:
    """A tab without a page. The fields have the same meaning as in `PageSpec`."""

    name: str
    group: str
    height: Height = "usual"
    placeholder: str = ""


@dataclass(frozen=True)
class PageSpec:
    """One page: its name in messages, in links and on its tab, its class and its view.

    `page` is made with the host and the view. `view` is an overlay; tabs.js draws a page without an overlay in its tab.
    `placeholder` is the text of the tab until the page has results. A tab with the `height` "taller" gets more room
    than usual, and a "tallest" tab also takes the place of the curve, except on a phone. `group` is one of `GROUPS`. A
    page with `works_hidden` keeps working while its window is hidden or its tab is scrolled off the screen; any other
    page then counts as hidden (`Page.visibility_changed`). While an overlay with `needs_curve` is open, the resonance
    curve is computed as if it were on the screen. `label` is the text on the tab, if its row has no room for the name.
    """

    name: str
    page: Callable[[PageHost, Any], Page]
    view: Callable[..., Component] | None
    placeholder: str = ""
    height: Height = "taller"
    works_hidden: bool = True
    group: str = "try"
    needs_curve: bool = False
    label: str = ""


#: The groups of tabs; a tab without a group is at the end, separate from the others.
GROUPS = ("learn", "try", "check")

#: The pages, and the tabs without a page, in the order of the tabs; the first tab is open by default.
TABS: tuple[PageSpec | TabSpec, ...] = (
    PageSpec("stories", StoriesPage, None, group="learn"),
    TabSpec("look at", "learn"),
    TabSpec("regimes", "learn"),
    PageSpec("probe", ProbePage, Probe),
    PageSpec("stability", StabilityPage, Stability, works_hidden=False),
    PageSpec("accuracy", AccuracyPage, Accuracy, group="check"),
    PageSpec("map", MapPage, None, height="tallest"),
    PageSpec("effects", EffectsPage, None, group="check"),
    PageSpec("branches", BranchesPage, Branches,
        "Periodic orbits followed over the drive frequency, stable and unstable.", needs_curve=True),
    PageSpec("analysis", AnalysisPage, Analysis,
        "Spectrum, bifurcation diagram, basins and Lyapunov exponents of the present scene."),
    PageSpec("observer", ObserverPage, Observer,
        "A copy of the chain that is driven only by its input force.", works_hidden=False),
    PageSpec("hard-cases", HardCasesPage, HardCases, ABOUT, height="usual", group="check", label="cases"),
    PageSpec("paper", PaperPage, Paper,
        "The figures of Zhang et al. (2016), computed from the presets, and where we differ.", height="usual",
        group="learn"),
    PageSpec("numbers", NumbersPage, None, group=""),
    PageSpec("data", DataPage, None, group=""),
)
PAGES = tuple(row for row in TABS if isinstance(row, PageSpec))

def check_names(rows: Sequence[PageSpec | TabSpec]) -> None:
    """Raise `ValueError` if two tabs have the same name, or a tab has the name of the curve."""
    names = [CURVE_NAME, *(row.name for row in rows)]
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"{name!r} in app/dashboard/table.py is taken; give the page another name.")


check_names(TABS)


def described_tabs() -> list[dict[str, Any]]:
    """Return the tabs as the browser gets them, in the order of the groups."""
    order = (*GROUPS, "")
    return [{"name": row.name, "placeholder": row.placeholder, "height": row.height, "group": row.group,
             "label": getattr(row, "label", "") or row.name}
            for row in sorted(TABS, key=lambda row: order.index(row.group))]


def watched_pages() -> dict[str, dict[str, bool]]:
    """Return the pages as the browser gets them; it determines which of them are visible."""
    return {row.name: {"overlay": row.view is not None, "works_hidden": row.works_hidden,
                       "needs_curve": row.needs_curve} for row in PAGES}


def tab_names() -> tuple[str, ...]:
    """Return the names of the tabs in links."""
    return tuple(row.name for row in TABS)


def overlay_names() -> tuple[str, ...]:
    """Return the names of the overlays."""
    return tuple(row.name for row in PAGES if row.view)
