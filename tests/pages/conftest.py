"""Fixtures for pages without a browser: one page on a host of its own, and one of a whole dashboard."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from headless_dashboard import dashboard
from page_host import PageUnderTest, picture

from app.dashboard.table import PAGES
from app.pages.map import page as map_page

__all__ = ["dashboard"]

OpenPage = Callable[[str], PageUnderTest]


@pytest.fixture
def page_of(monkeypatch: pytest.MonkeyPatch) -> OpenPage:
    """Return a function that opens a hidden page by name; the visitor has a picture, and the map has few cells."""
    monkeypatch.setattr(map_page, "COLUMNS", 6)
    monkeypatch.setattr(map_page, "ROWS", 4)

    def made(name: str) -> PageUnderTest:
        tested = PageUnderTest(next(row for row in PAGES if row.name == name), monkeypatch)
        tested.host.session.settled = picture()
        return tested
    return made
