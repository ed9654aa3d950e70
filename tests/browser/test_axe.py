"""axe-core finds nothing on any tab, page and popover."""

from __future__ import annotations

import pytest
from axe_playwright_python.sync_playwright import Axe
from knobs import COMPILED, Visit
from playwright.sync_api import Page

from app.plots.theme import THEMES

POPOVERS = ("Help and keys (?)", "Export: pictures, tables, a program", "Link to this picture")


# What axe-core finds within an element in the light theme, and which words have too little contrast in the others. Only
# colours and sizes depend on the theme, and axe takes as long for one rule in another theme as for all rules in the
# first. So it is asked about another theme only where its colours are not simply those of a word and of the nearest
# background behind it; for all other words these are read in every theme, and in light they must be what axe has
# measured.
RUN = """async ([within, themes]) => {
  const root = document.documentElement.dataset, chosen = root.theme, place = within ?? document;
  const report = await axe.run(place, { resultTypes: ["violations", "passes"], selectors: false, elementRef: true,
    preload: !within }); // only two rules read the style sheets anew, both of the page as a whole
  const found = { [chosen]: report.violations.flatMap(({ id, nodes }) => nodes.map(({ html }) => `${id}: ${html.slice(0, 120)}`)) };
  const numbers = (colour) => colour.match(/[0-9.]+/g).map(Number);
  // The colour of the words of an element and that of the background behind them, of which none is transparent.
  const colours = (element) => {
    const { color } = getComputedStyle(element);
    let opacity = 1;
    for (let at = element; at; at = at.assignedSlot ?? at.parentElement ?? at.getRootNode().host ?? null) {
      const style = getComputedStyle(at), behind = numbers(style.backgroundColor);
      opacity *= at === element || behind[3] === 0 ? style.opacity : 1;
      if (behind[3] !== 0) return [numbers(color).slice(0, 3).map((one, i) => Math.round(opacity * one + (1 - opacity) * behind[i])), behind.slice(0, 3)];
    }
    return [];
  };
  const hex = (colour) => colour && `#${colour.map((one) => one.toString(16).padStart(2, "0")).join("")}`;
  const light = (colour) => colour.map((one) => one / 255).map((one) => (one <= 0.03928 ? one / 12.92 : ((one + 0.055) / 1.055) ** 2.4))
    .reduce((sum, one, i) => sum + one * [0.2126, 0.7152, 0.0722][i], 0.05);
  const texts = [...report.passes, ...report.violations].filter(({ id }) => id === "color-contrast").flatMap(({ nodes }) => nodes)
    .filter(({ element, any: [{ data }] }) => data.fgColor && element.isConnected).map(({ element, html, any: [{ data }] }) => ({ element, html, data }));
  const simple = texts.filter(({ element, data: { fgColor, bgColor } }) => colours(element).map(hex).join() === [fgColor, bgColor].join());
  const others = texts.filter((one) => !simple.includes(one)).map(({ element }) => element);
  for (const theme of themes) {
    root.theme = theme;
    found[theme] = simple.flatMap(({ element, html, data: { expectedContrastRatio } }) => {
      const [words, behind] = colours(element), [low, high] = [light(words), light(behind)].sort((a, b) => a - b);
      return high / low < parseFloat(expectedContrastRatio) ? [`color-contrast: ${hex(words)} on ${hex(behind)}, ${html.slice(0, 120)}`] : [];
    });
    if (others.length) {
      const { violations } = await axe.run({ include: others }, { resultTypes: ["violations"], runOnly: ["color-contrast"] });
      found[theme].push(...violations.flatMap(({ id, nodes }) => nodes.map(({ html }) => `${id}: ${html.slice(0, 120)}`)));
    }
  }
  root.theme = chosen;
  return found;
}"""


def violations(page: Page, within: str | None = None) -> dict[str, list[str]]:
    """Rule and element of everything that axe-core finds in light, and of words without contrast in the other themes,
    on the whole page or within one element. A theme's colours are all in the style sheet (app/plots/theme.py).
    """
    if not page.evaluate("'axe' in window"):
        page.evaluate(Axe().axe_script)  # once: it is half a megabyte, and many places are looked at
    found = page.evaluate(RUN, [within, list(THEMES)[1:]])
    return {theme: what for theme, what in found.items() if what}


@pytest.mark.long
def test_axe_finds_nothing(visit: Visit) -> None:
    page = visit("?v=1&look=light")
    page.wait_for_selector(".peak-names button", timeout=COMPILED)
    places = everywhere(page)
    assert len(places) > 20 and {where: what for where, what in places.items() if what} == {}
    # so it would be found, also in one of the other themes alone
    page.add_style_tag(content=":root[data-theme=dark] { --ink: #555 }")
    assert list(violations(page, "#bar")) == ["dark"]
    page.add_style_tag(content=":root { --ink: #999 !important }")  # enough on dark cards
    found = violations(page, "#bar")
    assert list(found) == [name for name, theme in THEMES.items() if theme.scheme == "light"]
    assert all("color-contrast" in one for rules in found.values() for one in rules)


def everywhere(page: Page) -> dict[str, dict[str, list[str]]]:
    """What axe-core finds on the page as it is, on every page and tab, and in every popover on a large screen."""
    page.evaluate("shown()")
    found = {"whole page": violations(page)}
    for name in page.evaluate("[...document.querySelectorAll('[data-overlay]')].map((one) => one.dataset.overlay)"):
        page.evaluate("(name) => granchain.openPage(name)", name)
        page.evaluate("shown()")
        found[f"page {name}"] = violations(page, "#overlay")
        if name in ("accuracy", "branches"):  # they go on although nobody looks, which takes a processor
            page.locator("#overlay").get_by_role("button", name="stop").click()
    page.evaluate("granchain.closePage()")
    for tab in page.get_by_role("tab").all():
        tab.click()
        page.evaluate("shown()")
        found[f"tab {tab.text_content()}"] = violations(page, "#tabs")
    page.set_viewport_size({"width": 1920, "height": 1080})
    for name in POPOVERS:
        page.get_by_role("button", name=name, exact=True).click()
        found[name] = violations(page, "#bar")
    return found
