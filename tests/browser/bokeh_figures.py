"""Figures of app/plots in the browser: the data of their sources, and positions of points on the screen."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from playwright.sync_api import Page, TimeoutError

#: Undocumented parts of BokehJS that tests use, as `figures` in every page that they open: the document of a figure by
#: the figure's name, the first model of a name, the view of a model, and all models.
FIGURES = """
window.figures = {
  documentOf: (name) => Bokeh.documents.find((one) => one.roots()[0]?.name === name),
  model: (name) => Bokeh.documents.map((one) => one.get_model_by_name(name)).find(Boolean),
  viewOf: (model) => Bokeh.index.find_one(model),
  // The view of a figure by name; `large` is the figure with tools, not its tab's.
  view: (name, large) => Object.values(Bokeh.index.roots ?? Bokeh.index)
    .filter(({ model }) => model.name === name && (model.toolbar_location !== null) === large).at(-1),
  models: () => (window.Bokeh?.documents ?? []).flatMap((one) => [...(one.all_models ?? one._all_models.values())]),
};
"""


def source(page: Page, figure: str, name: str, large: bool = True) -> dict[str, Any]:
    """Return the data of a figure's source, empty until it exists; `large` is the figure with tools, not its tab's."""
    return dict(page.evaluate("""([name, source, large]) => {
      const view = figures.view(name, large);
      return view?.model.document?.get_model_by_name(source)?.data ?? {}; }""", [figure, name, large]))


def place(page: Page, figure: str, x: float, y: float) -> tuple[float, float]:
    """Return the position of a large figure's point on the screen."""
    across, down = page.evaluate("""([name, large, x, y]) => {
      const view = figures.view(name, large);
      const box = view.el.getBoundingClientRect(), { x_scale, y_scale } = view.frame;
      return [box.x + x_scale.compute(x), box.y + y_scale.compute(y)]; }""", [figure, True, x, y])
    return across, down


# The text of all visible tooltips.
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
#: Time that one hover may take to show its tooltip before the pointer is moved again [ms].
_ONE_HOVER = 2000


def tooltips(page: Page) -> str:
    """Return the text of all visible tooltips."""
    return str(page.evaluate(_TOOLTIPS))


def hover(page: Page, where: Callable[[], tuple[float, float]], *words: str) -> None:
    """Move the pointer to a point until tooltips with these words are shown.

    While a figure is redrawn, a hover may be lost and the point may move. In that case, the pointer is moved again.
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
