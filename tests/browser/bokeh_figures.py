"""Figures of app/pictures in the browser: the data of their sources, and where on the screen a point is."""

from __future__ import annotations

from typing import Any

from playwright.sync_api import Page

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


def tooltips(page: Page) -> str:
    """The words of all tooltips that are shown."""
    return str(page.evaluate("""() => {
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
    }"""))
