"""The tabs: all can be reached at any width, and the server is told which one is visible."""

from __future__ import annotations

import pytest
from knobs import Visit, looks
from playwright.sync_api import Page, expect
from server import until

#: Largest number of tab rows at a window width [px]: one for each group, and one more on a phone.
MOST_ROWS = {390: 5, 1280: 4}


@pytest.mark.parametrize("width", MOST_ROWS)
def test_all_tabs_fit_and_arrows_reach_them(at: Visit, width: int) -> None:
    page = at(viewport={"width": width, "height": 844})
    page.evaluate("shown()")
    tabs_fit(page, width)
    page.get_by_role("tab", name="look at").focus()
    page.keyboard.press("ArrowRight")
    expect(page.get_by_role("tab", name="regimes")).to_be_focused()
    page.keyboard.press("End")
    expect(page.get_by_role("tab").last).to_have_attribute("aria-selected", "true")
    page.keyboard.press("Home")
    expect(page.get_by_role("tab", name="stories")).to_be_focused()


def tabs_fit(page: Page, width: int) -> None:
    """Check that no tab leaves its area, and that there are not too many rows."""
    edge = page.locator("#tabs").bounding_box()
    assert edge is not None
    rows = set()
    for button in page.locator("#tabs [role=tab]").all():
        box = button.bounding_box()
        assert box is not None and edge["x"] <= box["x"] and box["x"] + box["width"] <= edge["x"] + edge["width"]
        rows.add(button.evaluate("one => one.offsetTop"))
    assert len(rows) <= MOST_ROWS[width]


def test_a_name_of_no_page_opens_none(at: Visit) -> None:
    """The tab "map" has no overlay; opening one by that name used to show an empty overlay."""
    page = at("?v=1&scene=sec2&page=probe")
    page.wait_for_function("granchain.overlay === 'probe'")
    page.evaluate("granchain.openOverlay('map')")
    assert page.evaluate("[granchain.overlay, document.getElementById('dashboard').classList.contains('overlaid')]") == [None, False]
    expect(page.locator("#tabs")).to_be_visible()


def test_a_hidden_window_pauses_an_analysis_and_not_a_map(visit: Visit) -> None:
    """An analysis pauses; a map continues, and so does the curve unless the map or a page covers it."""
    page = visit()
    hide = """(hidden) => {
      Object.defineProperty(document, "hidden", { configurable: true, get: () => hidden });
      document.dispatchEvent(new Event("visibilitychange"));
    }"""
    page.get_by_role("tab", name="stability").click()
    page.evaluate(hide, True)
    page.evaluate(hide, False)
    until(page, lambda: looks(page, "stability") == ["true", "false", "true"])
    page.get_by_role("tab", name="map").click()
    # the page reports this when it has been laid out again
    until(page, lambda: (looks(page, "map"), looks(page, "curve")) == (["true"], ["false"]))
    page.evaluate(hide, True)
    page.evaluate(hide, False)
    page.get_by_role("tab", name="stability").click()
    until(page, lambda: looks(page, "stability") == ["true", "false", "true", "false", "true"])
    until(page, lambda: (looks(page, "map"), looks(page, "curve")) == (["true", "false"], ["false", "true"]))
    page.get_by_role("button", name="open the page").click()
    until(page, lambda: looks(page, "curve") == ["false", "true", "false"])
    page.keyboard.press("Escape")
    until(page, lambda: looks(page, "curve") == ["false", "true", "false", "true"])
    assert looks(page, "stability") == ["true", "false", "true", "false", "true"]  # from its tab to the page and back
