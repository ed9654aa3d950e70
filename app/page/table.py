"""The table of pages: layout, controller, the covers of page.html and the tabs are made from it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from ..pages.accuracy.page import AccuracyPage
from ..pages.accuracy.view import Accuracy
from ..pages.branches.page import BranchesPage
from ..pages.branches.view import Branches
from ..pages.effects.page import EffectsPanel
from ..pages.hard_cases.page import HardPage
from ..pages.hard_cases.view import Hard
from ..pages.map.page import MapTab
from ..pages.observer.page import ObserverPage
from ..pages.observer.view import Observer
from ..pages.paper.page import PaperPage
from ..pages.paper.view import Paper
from ..pages.stability.page import StabilityPage
from ..pages.stability.view import Stability
from ..parts.component import Component
from .hooks import Page
from .host import Host


@dataclass(frozen=True)
class Row:
    """One page: its name in messages, the words on its tab, what is computed and how it is drawn.

    `page` is made with the host and the view. `view` covers the pictures; a page without one is drawn in its tab by
    tabs.js. `words` stand in the tab until the page has something to say. `roomy` gives the tab more height.
    """

    name: str
    tab: str
    page: Callable[[Host, Any], Page]
    view: Callable[..., Component] | None
    words: str = ""
    roomy: bool = True


#: In the order of the tabs.
PAGES = (
    Row("stability", "stability", StabilityPage, Stability),
    Row("accuracy", "accuracy", AccuracyPage, Accuracy),
    Row("map", "map", MapTab, None),
    Row("effects", "effects", EffectsPanel, None),
    Row("branches", "branches", BranchesPage, Branches),
    Row("observer", "observer", ObserverPage, Observer,
        "A copy of the chain that feels its input force and nothing else."),
    Row("hard", "hard cases", HardPage, Hard,
        "Cases in which solvers of granular chains go wrong without warning, each compared with a known result.",
        roomy=False),
    Row("paper", "paper", PaperPage, Paper,
        "The figures of Zhang et al. (2016), computed from the presets, and where we differ.", roomy=False),
)


def described_pages() -> list[dict[str, Any]]:
    """What the tabs need of the table."""
    return [{"name": row.name, "tab": row.tab, "words": row.words, "roomy": row.roomy} for row in PAGES]
