"""Figures and pages of the dashboard follow the chosen theme, without a browser."""

from __future__ import annotations

import pytest
from headless_dashboard import Dashboard

from app.plots.theme import THEMES, Theme


def test_another_theme_reaches_the_pages_and_their_figures(dashboard: Dashboard) -> None:
    told: list[Theme] = []
    for page in dashboard.pages:
        page.theme_changed = told.append  # type: ignore[method-assign]
    dashboard.received({"do": "theme", "value": "dark"})
    dashboard.received({"do": "theme", "value": "none of them"})
    assert told == [THEMES["dark"]] * len(dashboard.pages)
    assert dashboard.views.overlays["branches"].theme == THEMES["dark"]  # type: ignore[attr-defined]


def test_the_figures_of_the_page_and_of_its_pages_follow_a_theme(dashboard: Dashboard) -> None:
    views, theme = dashboard.views, THEMES["projector"]
    widths = [line.glyph.line_width for line in views.trains._lines]
    views.apply_theme(theme)
    ring = views.curve._dot.glyph
    assert (ring.line_color, ring.size) == (theme.ink, 15 * theme.line_scale)
    assert [line.glyph.line_width for line in views.trains._lines] == [pytest.approx(theme.line_scale * width) for width in widths]
    assert views.overlays["branches"].theme == theme


def test_models_added_to_a_figure_follow_its_theme(dashboard: Dashboard) -> None:
    """Names of pins and measured data are created when they are first needed."""
    views = dashboard.views
    views.apply_theme(THEMES["dark"])
    views.curve._pinned.places = [("A", 400.0, 1.0)]
    views.curve._pinned.draw(1.0)
    rings, names = views.curve._pinned._marks
    for theme in (THEMES["dark"], THEMES["projector"]):
        views.apply_theme(theme)
        assert rings.glyph.line_color == names.glyph.text_color == theme.ink
