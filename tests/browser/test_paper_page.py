"""The page "The paper" as a visitor sees it: a figure is drawn with caption and rows, in both themes, and abandoned
when the page is left.
"""

from __future__ import annotations

import re
from collections.abc import Callable

from playwright.sync_api import Locator, Page, expect
from server import resize, until

Visit = Callable[..., Page]
#: Long enough for a first visit that has to compile kernels on a machine busy with tests.
COMPILED = 150_000


def opened(page: Page) -> Locator:
    """Open the page from its tab."""
    page.get_by_role("tab", name="paper").click()
    page.locator("#tabs").get_by_role("button", name="open the page").click()
    return page.locator('[data-overlay="paper"]')


def chosen(sheet: Locator, number: str) -> None:
    """Click on the button of a figure."""
    sheet.get_by_role("button", name=re.compile(rf"^figure {number}:")).click()


def test_figures_are_drawn_with_caption_and_rows(visit: Visit) -> None:
    page = visit()
    sheet = opened(page)
    expect(sheet.get_by_role("img", name="Figure 2")).to_be_visible(timeout=COMPILED)  # it does not start empty
    chosen(sheet, "5")
    expect(sheet.locator(".caption")).to_contain_text("Figure 5: What the shaker does")
    expect(sheet.locator(".caption")).to_contain_text("are images, whose numbers we do not have")
    expect(sheet.locator("tbody tr")).to_have_count(1)
    expect(sheet.locator("tbody b").first).to_have_text("0.88")
    picture = sheet.get_by_role("img", name="Figure 5")
    expect(picture.locator("canvas").first).to_be_visible()
    chosen(sheet, "3a")
    expect(sheet.get_by_role("img", name="Figure 3a")).to_be_visible(timeout=COMPILED)
    until(page, lambda: bool(page.evaluate("granchain.pages.get('paper').figure.model('input force')?.data.force.length > 700")))
    page.evaluate("window.kept = granchain.pages.get('paper').figure.document; granchain.theme.next()")  # another theme, another figure
    until(page, lambda: bool(page.evaluate(
        "granchain.pages.get('paper').figure.document && kept !== granchain.pages.get('paper').figure.document")))
    assert page.evaluate("granchain.pages.get('paper').figure.model('drive').background_fill_color") == "#161a21"


def test_leaving_the_page_stops_a_figure_and_every_figure_fits(visit: Visit) -> None:
    page = visit()
    sheet = opened(page)
    chosen(sheet, "9")  # the longest one: four curves
    expect(sheet.get_by_role("button", name="stop")).to_be_visible()
    page.keyboard.press("Escape")
    page.locator("#tabs").get_by_role("button", name="open the page").click()
    expect(sheet.locator(".status")).to_have_text("stopped")
    expect(sheet.locator(".figure")).to_be_hidden()
    chosen(sheet, "1")
    expect(sheet.get_by_role("img", name="Figure 1")).to_be_visible()
    page.set_viewport_size({"width": 390, "height": 844})
    chosen(sheet, "4")
    picture = sheet.get_by_role("img", name="Figure 4")
    expect(picture.locator("canvas").first).to_be_visible()
    for width, height in ((390, 844), (1280, 800)):
        resize(page, width, height)
        box = picture.bounding_box()
        assert box is not None and box["x"] >= 0 and box["x"] + box["width"] <= width and box["height"] > 200
