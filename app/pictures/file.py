"""A figure as an HTML file that needs no server and no network."""

from __future__ import annotations

from bokeh.embed import file_html
from bokeh.models import LayoutDOM
from bokeh.resources import INLINE


def page_of(figure: LayoutDOM, title: str) -> str:
    """A whole page with a figure of this package, which fills the window; Bokeh's own scripts are in it."""
    return str(file_html(figure, INLINE, title))
