"""A figure as PNG or SVG, drawn by BokehJS in headless Chromium.

Bokeh's `export_png` and `export_svg` need Selenium and a driver in addition to the browser. Chromium alone is enough:
it takes a picture of a page (`--screenshot`) and prints the final DOM of a page (`--dump-dom`), into which a script
puts the result of BokehJS's `export("svg")`.
"""

from __future__ import annotations

import html
import os
import re
import subprocess
import tempfile
from pathlib import Path

from bokeh.models import GridPlot, LayoutDOM, Plot
from PIL import Image

from granchain_core import BadInput

from ..plots.file import (
    CAPTION_LINE,
    CAPTION_ROOM,
    CAPTION_SIZE,
    FONT,
    caption_height,
    caption_lines,
    captioned_html,
    html_of,
)
from ..plots.theme import Theme
from .chromium import installed_browser

#: Chromium's sandbox does not start for root, the user in many containers; for any other user the sandbox is kept.
_FOR_ROOT = ["--no-sandbox"] if os.geteuid() == 0 else []
_OPTIONS = ["--headless", *_FOR_ROOT, "--disable-gpu", "--hide-scrollbars", "--no-first-run", "--disable-sync",
            "--disable-background-networking", "--virtual-time-budget=20000"]
#: Room around the page in the window [px]. The window's frame takes part of it; the rest is cut off.
_FRAME_ROOM = 200
#: Longest time for one figure [s].
_LONGEST_TIME = 120
#: Script added to the page: once everything is drawn, it puts the SVG into an element of its own.
_EXPORT = """<script>
const wait = setInterval(() => {
  const drawn = window.Bokeh?.documents?.[0];
  if (!drawn?.is_idle || !Bokeh.index.roots?.length) return;
  clearInterval(wait);
  const { ctx } = Bokeh.index.roots[0].export("svg", true);
  const pre = document.createElement("pre");
  pre.id = "exported";
  pre.textContent = ctx.get_serialized_svg(true);
  document.body.append(pre);
}, 50);
</script></body>"""


def browser() -> str:
    """Return the path of the browser that draws. Raise `BadInput` if none is installed."""
    path = installed_browser()
    if path is None:
        raise BadInput("A PNG or SVG is drawn by Chromium or Chrome, and neither is on the PATH; install one (on "
                       "Debian: apt install chromium), or write an HTML file, whose own menu saves a picture.")
    return path


def png_of(figure: LayoutDOM, title: str, caption: str, theme: Theme, size: tuple[int, int],
           scale: float = 1.5) -> bytes:
    """Return the figure of `size` [px] with its caption as PNG, with `scale` image pixels per pixel."""
    _without_tools(figure)
    width, height = size[0], size[1] + caption_height(title, caption, size[0])
    with tempfile.TemporaryDirectory(prefix="granchain-") as folder:
        image = Path(folder) / "picture.png"
        # The page's body is as large as the image, however much of the window its frame takes.
        page = captioned_html(figure, title, caption, theme, body_size=(width, height))
        _run(folder, page, f"--screenshot={image}", f"--force-device-scale-factor={scale}",
             f"--window-size={width + _FRAME_ROOM},{height + _FRAME_ROOM}")
        if not image.exists():
            raise BadInput(f"{browser()} wrote no picture; write an HTML file instead.")
        with Image.open(image) as screenshot:
            screenshot.crop((0, 0, round(scale * width), round(scale * height))).convert("RGB").quantize(256).save(
                image, optimize=True)
        return image.read_bytes()


def svg_of(figure: LayoutDOM, title: str, caption: str, theme: Theme, size: tuple[int, int]) -> str:
    """Return a figure of `size` [px] with its title and caption as the text of an SVG image."""
    _without_tools(figure)
    for plot in _plots(figure):
        plot.output_backend = "svg"
    page = html_of(figure, title).replace("</body>", _EXPORT)
    with tempfile.TemporaryDirectory(prefix="granchain-") as folder:
        dom = _run(folder, page, "--dump-dom", f"--window-size={size[0]},{size[1]}")
    match = re.search(r'<pre id="exported">(.*?)</pre>', dom, re.DOTALL)
    if match is None:
        raise BadInput(f"{browser()} drew no SVG; write an HTML file instead.")
    return _with_caption(html.unescape(match[1]), title, caption, theme)


def _plots(figure: LayoutDOM) -> list[Plot]:
    return [*figure.select({"type": Plot}), *([figure] if isinstance(figure, Plot) else [])]


def _without_tools(figure: LayoutDOM) -> None:
    """Remove the toolbars: an image has no buttons."""
    for plot in _plots(figure):
        plot.toolbar_location = None
    for panels in [*figure.select({"type": GridPlot}), *([figure] if isinstance(figure, GridPlot) else [])]:
        panels.toolbar_location = None


def _with_caption(drawn: str, title: str, caption: str, theme: Theme) -> str:
    """Return the drawn SVG inside another SVG, with the lines of the caption below."""
    sizes = re.search(r'<svg[^>]* width="([\d.]+)" height="([\d.]+)"', drawn)
    if sizes is None:
        raise BadInput("The browser's SVG has no size; write an HTML file instead.")
    width, height = float(sizes[1]), float(sizes[2])
    lines = caption_lines(title, caption, width)
    text = "".join(f'<text x="16" y="{height + CAPTION_ROOM + CAPTION_LINE * i:g}">{html.escape(line)}</text>'
                   for i, line in enumerate(lines))
    total_height = height + CAPTION_ROOM + CAPTION_LINE * len(lines)
    return (f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:g}" height="{total_height:g}" '
            f'viewBox="0 0 {width:g} {total_height:g}">'
            f'<title>{html.escape(title)}</title><rect width="100%" height="100%" fill="{theme.card}"/>{drawn}'
            f'<g font-family="{FONT}" font-size="{CAPTION_SIZE}" fill="{theme.ink}">{text}</g></svg>\n')


def _run(folder: str, page: str, *options: str) -> str:
    """Open a page in the browser and return the browser's output."""
    file = Path(folder) / "page.html"
    file.write_text(page, encoding="utf-8")
    try:
        done = subprocess.run([browser(), *_OPTIONS, f"--user-data-dir={folder}/profile", *options, file.as_uri()],
                              capture_output=True, text=True, timeout=_LONGEST_TIME, check=False,
                              env={**os.environ, "HOME": folder})
    except subprocess.TimeoutExpired:
        raise BadInput(f"{browser()} did not finish the picture within {_LONGEST_TIME} s; "
                       "write an HTML file.") from None
    return done.stdout
