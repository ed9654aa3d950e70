"""A figure as a file: whatever else Bokeh does in this process."""

from __future__ import annotations

from bokeh.document import Document
from bokeh.io.doc import patch_curdoc
from bokeh.plotting import figure

from app.plots.file import html_of


def test_a_dashboard_whose_visitor_left_does_not_matter() -> None:
    """Bokeh refuses to name the current document where the last one is gone; a file needs none but its own."""
    gone = Document()
    with patch_curdoc(gone):
        del gone
        assert "<html" in html_of(figure(), "a picture")
