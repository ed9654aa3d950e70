"""axe-core finds no violation on any tab, page or popover, nor in the tour, an error, a bubble or a story."""

from __future__ import annotations

from pathlib import Path

import pytest
from axe_playwright_python.sync_playwright import Axe
from knobs import COMPILED, POPOVERS, Visit, type_into
from playwright.sync_api import Page, expect

from app.plots.theme import THEMES

#: Its `granchainViolations` finds axe-core's violations within an element, and words that are too faint in other
#: themes.
SCRIPT = Path(__file__).with_name("violations.js").read_text(encoding="utf-8")


def violations(page: Page, within: str | None = None) -> dict[str, list[str]]:
    """Return rule and element of all violations that axe-core finds in light, and of low-contrast words in other
    themes, on the whole page or within one element. A theme's colours are all in the style sheet (app/plots/theme.py).
    """
    if not page.evaluate("'axe' in window"):
        page.evaluate(Axe().axe_script)  # only once: it is half a megabyte, and many elements are checked
        page.evaluate(SCRIPT)
    found = page.evaluate("(given) => granchainViolations(given)", [within, list(THEMES)[1:]])
    return {theme: what for theme, what in found.items() if what}


@pytest.mark.long
def test_axe_finds_no_violations(visit: Visit) -> None:
    page = visit("?v=1&look=light")
    page.wait_for_selector(".peak-names button", timeout=COMPILED)
    places = everywhere(page)
    assert len(places) > 20 and {where: what for where, what in places.items() if what} == {}
    # a violation would be found, even in only one of the other themes
    page.add_style_tag(content=":root[data-theme=dark] { --ink: #555 }")
    assert list(violations(page, "#bar")) == ["dark"]
    page.add_style_tag(content=":root { --ink: #999 !important }")  # sufficient on dark cards
    found = violations(page, "#bar")
    assert list(found) == [name for name, theme in THEMES.items() if theme.scheme == "light"]
    assert all("color-contrast" in one for rules in found.values() for one in rules)


def everywhere(page: Page) -> dict[str, dict[str, list[str]]]:
    """Return what axe-core finds on the current page, on every page and tab, in every popover, and then in a bubble,
    the tour, an error and a story.
    """
    page.evaluate("shown()")
    found = {"whole page": violations(page)}
    for name in page.evaluate("[...document.querySelectorAll('[data-overlay]')].map((one) => one.dataset.overlay)"):
        page.evaluate("(name) => granchain.openOverlay(name)", name)
        page.evaluate("shown()")
        found[f"page {name}"] = violations(page, "#overlay")
        if name in ("accuracy", "branches"):  # they continue when hidden, which occupies a processor
            page.locator("#overlay").get_by_role("button", name="stop").click()
    page.evaluate("granchain.closeOverlay()")
    for tab in page.get_by_role("tab").all():
        tab.click()
        page.evaluate("shown()")
        found[f"tab {tab.text_content()}"] = violations(page, "#tabs")
    for name, (_, width) in POPOVERS.items():
        page.set_viewport_size({"width": width, "height": 1080})
        page.get_by_role("button", name=name, exact=True).click()
        expect(page.get_by_role("button", name=name, exact=True)).to_have_attribute("aria-expanded", "true")
        found[name] = violations(page, "#bar")
        page.keyboard.press("Escape")
    page.set_viewport_size({"width": 1920, "height": 1080})
    page.locator("#foot #accuracy").click()
    found["bubble"] = violations(page, "#term")
    page.keyboard.press("Escape")
    page.get_by_role("button", name="Help and keys (?)").click()
    page.get_by_role("button", name="show the tour again").click()
    found["tour"] = violations(page, "#tour")
    page.keyboard.press("Escape")
    type_into(page, "f", "fast")
    expect(page.locator("#foot .sentence")).to_be_visible()
    found["error"] = violations(page, "#foot")
    page.get_by_role("tab", name="stories", exact=True).click()
    page.locator("#tabs .story button").first.click()
    expect(page.locator("#curves.in-story")).to_be_visible()
    page.evaluate("shown()")
    found["story"] = violations(page, "#curves")
    return found
