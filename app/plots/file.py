"""A figure as an HTML file that needs no server and no network."""

from __future__ import annotations

import html
from typing import Any

from bokeh.embed import file_html
from bokeh.models import LayoutDOM
from bokeh.resources import INLINE

from .item import with_own_document
from .theme import Theme

#: Height of a line of a caption [px].
_CAPTION_LINE = 20
#: Room around a caption [px].
_CAPTION_ROOM = 22
#: Characters in a pixel of its width.
_CHARACTERS_PER_PIXEL = 1 / 7.6
_PAGE = """{%% block contents %%}
<style>
  html, body { height: 100%%; margin: 0; background: %(card)s; color: %(ink)s; }
  body { display: flex; flex-direction: column; }
  main { flex: 1; min-height: 0; }
  p { flex: none; margin: 6px 16px 14px; font: 15px/%(line)dpx system-ui, "DejaVu Sans", sans-serif; }
</style>
<main>{{ super() }}</main>
<p>%(caption)s</p>
{%% endblock %%}"""


def html_of(figure: LayoutDOM, title: str) -> str:
    """A whole page with a figure of this package, which fills the window; Bokeh's own scripts are in it."""
    return _page(figure, title)


def captioned_html(figure: LayoutDOM, title: str, caption: str, theme: Theme) -> str:
    """A whole page with a figure, its title in bold and a caption under it."""
    words = f"<b>{html.escape(title)}.</b> {html.escape(caption)}".replace("{", "&#123;")
    template = _PAGE % {"card": theme.card, "ink": theme.ink, "line": _CAPTION_LINE, "caption": words}
    return _page(figure, title, template=template)


def _page(figure: LayoutDOM, title: str, **options: Any) -> str:
    """Bokeh's page."""
    return with_own_document(lambda: str(file_html(figure, INLINE, title, **options)))


def caption_height(title: str, caption: str, width: int) -> int:
    """Room that `captioned_html` needs for its caption in a window of this width [px]."""
    return _CAPTION_ROOM + _CAPTION_LINE * -(-(len(title) + len(caption) + 2) // int(width * _CHARACTERS_PER_PIXEL))
