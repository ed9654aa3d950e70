"""A figure as an HTML file that needs no server and no network."""

from __future__ import annotations

import html
from textwrap import wrap
from typing import Any

from bokeh.embed import file_html
from bokeh.models import LayoutDOM
from bokeh.resources import INLINE

from .json_item import with_own_document
from .theme import Theme

#: Fonts of a caption.
FONT = "system-ui, DejaVu Sans, sans-serif"
#: Size of a caption's text, and the height of a line [px].
CAPTION_SIZE, CAPTION_LINE = 15, 20
#: Room around a caption [px].
CAPTION_ROOM = 22
#: Average width of a character in a caption [px].
_CHARACTER_WIDTH = 7.6
_PAGE = """{%% block contents %%}
<style>
  html, body { height: 100%%; margin: 0; background: %(card)s; color: %(ink)s; }
  body { display: flex; flex-direction: column; %(body)s }
  main { flex: 1; min-height: 0; }
  p { flex: none; margin: 6px 16px 14px; font: %(size)dpx/%(line)dpx %(font)s; }
</style>
<main>{{ super() }}</main>
<p>%(caption)s</p>
{%% endblock %%}"""


def html_of(figure: LayoutDOM, title: str) -> str:
    """Return a complete page with a figure that fills the window; BokehJS is part of the page."""
    return _page(figure, title)


def captioned_html(figure: LayoutDOM, title: str, caption: str, theme: Theme,
                   body_size: tuple[int, int] | None = None) -> str:
    """Return a page with a figure, its title in bold and its caption; it is `body_size` [px] or the window's size."""
    body = "" if body_size is None else f"width: {body_size[0]}px; height: {body_size[1]}px;"
    words = f"<b>{html.escape(title)}.</b> {html.escape(caption)}".replace("{", "&#123;")
    template = _PAGE % {"card": theme.card, "ink": theme.ink, "body": body, "size": CAPTION_SIZE,
                        "line": CAPTION_LINE, "font": FONT, "caption": words}
    return _page(figure, title, template=template)


def _page(figure: LayoutDOM, title: str, **options: Any) -> str:
    """Return Bokeh's page."""
    return with_own_document(lambda: str(file_html(figure, INLINE, title, **options)))


def caption_height(title: str, caption: str, width: int) -> int:
    """Return the height of a caption in a window of this width [px]."""
    return CAPTION_ROOM + CAPTION_LINE * len(caption_lines(title, caption, width))


def caption_lines(title: str, caption: str, width: float) -> list[str]:
    """Return title and caption, divided into lines of this width [px]."""
    return wrap(f"{title}. {caption}", int(width / _CHARACTER_WIDTH))
