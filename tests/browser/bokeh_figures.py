"""Figures of app/pictures in the browser: the data of their sources, and where on the screen a point is."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from playwright.sync_api import Page, TimeoutError

_VIEW = """const view = Object.values(Bokeh.index.roots ?? Bokeh.index)
  .filter((one) => one.model.name === name && (one.model.toolbar_location !== null) === large).at(-1);"""


def source(page: Page, figure: str, name: str, large: bool = True) -> dict[str, Any]:
    """The data of a source of a figure, empty until that is there; `large` is the one with tools, not that of its tab.
    """
    return dict(page.evaluate(f"""([name, source, large]) => {{ {_VIEW}
      return view?.model.document?.get_model_by_name(source)?.data ?? {{}}; }}""", [figure, name, large]))


def place(page: Page, figure: str, x: float, y: float) -> tuple[float, float]:
    """Where a point of a large figure is on the screen."""
    across, down = page.evaluate(f"""([name, large, x, y]) => {{ {_VIEW}
      const box = view.el.getBoundingClientRect(), {{ x_scale, y_scale }} = view.frame;
      return [box.x + x_scale.compute(x), box.y + y_scale.compute(y)]; }}""", [figure, True, x, y])
    return across, down


# The words of all tooltips that are shown.
_TOOLTIPS = """() => {
  const found = [], look = (node) => {
    for (const one of node.querySelectorAll("*")) {
      if (one.shadowRoot) {
        if (one.className.includes?.("bk-Tooltip") && one.getClientRects().length) found.push(one.shadowRoot.textContent);
        look(one.shadowRoot);
      }
    }
  };
  look(document);
  return found.join(" ");
}"""
_SHOWN = f"(words) => {{ const shown = ({_TOOLTIPS})(); return words.every((one) => shown.includes(one)); }}"
#: How long one hover may take to show its tooltip, before the pointer comes again [ms].
_ONE_HOVER = 2000


def tooltips(page: Page) -> str:
    """The words of all tooltips that are shown."""
    return str(page.evaluate(_TOOLTIPS))


def hover(page: Page, where: Callable[[], tuple[float, float]], *words: str) -> None:
    """Move the pointer to a point until tooltips with these words are shown.

    While a figure is drawn anew a hover may be lost, and the point may move: then the pointer comes again.
    """
    end = time.monotonic() + 60.0
    while True:
        page.mouse.move(0, 0)
        page.mouse.move(*where(), steps=3)
        try:
            page.wait_for_function(_SHOWN, arg=list(words), timeout=_ONE_HOVER)
        except TimeoutError:
            assert time.monotonic() < end, f"no tooltip has {words}, but: {tooltips(page)}"
        else:
            return
