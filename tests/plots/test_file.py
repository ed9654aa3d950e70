"""A figure can be written to a file whatever else Bokeh does in this process."""

from __future__ import annotations

from pathlib import Path

import pytest
from bokeh.document import Document
from bokeh.io.doc import patch_curdoc
from bokeh.plotting import figure

from app.headless.chromium import installed_browser
from app.plots.file import CAPTION_LINE, CAPTION_ROOM, caption_height, caption_lines, captioned_html, html_of
from app.plots.theme import THEMES


def test_a_dashboard_whose_visitor_left_does_not_matter() -> None:
    """Bokeh raises an error if its current document no longer exists; a file needs only its own document."""
    gone = Document()
    with patch_curdoc(gone):
        del gone
        assert "<html" in html_of(figure(), "a picture")


def test_the_body_of_a_page_has_the_size_of_its_picture() -> None:
    """Headless Chromium takes a screenshot of a window, whose frame needs some of the space."""
    page = captioned_html(figure(), "A picture", "of {nothing}", THEMES["light"], body_size=(640, 480))
    assert "flex-direction: column; width: 640px; height: 480px; }" in page
    assert "width: 640px" not in captioned_html(figure(), "A picture", "of nothing", THEMES["light"])


def test_a_caption_has_the_room_of_its_lines() -> None:
    lines = caption_lines("A picture", "of nothing, " * 20, 400)
    assert max(map(len, lines)) <= 400 / 7.6 and " ".join(lines) == ("A picture. " + "of nothing, " * 20).strip()
    assert caption_height("A picture", "of nothing, " * 20, 400) == CAPTION_ROOM + CAPTION_LINE * len(lines)


def test_the_browser_that_draws_is_the_first_on_the_path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    assert installed_browser() is None
    for name in ("chromium", "chromium-headless-shell"):
        (tmp_path / name).write_text("#!/bin/sh\n")
        (tmp_path / name).chmod(0o755)
    assert installed_browser() == str(tmp_path / "chromium-headless-shell")
    assert installed_browser(with_window=True) == str(tmp_path / "chromium")
