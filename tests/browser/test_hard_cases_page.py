"""The page "Hard cases" as a visitor sees it: opened from its tab, idle until asked, run, drawn, stopped."""

from __future__ import annotations

import re

from knobs import COMPILED, Visit
from playwright.sync_api import Locator, Page, expect
from server import resize

from granchain_core.hard_cases import CASES

#: A case that has a picture and takes a second once its kernels are compiled.
QUICK = "solitary wave, Hertz collision, cradle, a bead on a chain"
LONG = "near a bifurcation"
#: The lines and titles of the picture in the browser.
DRAWN = """() => {
  const figure = figures.documentOf("check")?.roots()[0];
  if (!figure) return null;
  const lines = figure.renderers.filter((one) => one.name);
  return { dashes: lines.map((one) => String(one.glyph.line_dash.value ?? one.glyph.line_dash)),
           titles: [figure.title.text, figure.below.find((one) => one.axis_label).axis_label] };
}"""


def opened(page: Page) -> Locator:
    """Open the page from its tab."""
    page.get_by_role("tab", name="hard-cases").click()
    page.locator("#tabs").get_by_role("button", name="open the page").click()
    overlay = page.locator('[data-overlay="hard-cases"]')
    expect(overlay.get_by_role("button", name="run all (quick)")).to_be_visible()
    return overlay


def card(overlay: Locator, name: str) -> Locator:
    """Return the card of one case."""
    return overlay.locator(f'[data-case="{name}"]')


def test_a_case_runs_when_asked_and_shows_rows_and_picture(visit: Visit) -> None:
    page = visit()
    overlay = opened(page)
    expect(overlay.locator("article")).to_have_count(len(CASES))
    expect(overlay.locator("article").first).to_contain_text("Naive:")
    assert not [one for one in page.evaluate("sent") if one.startswith("hard-cases-")]  # no case was asked to run
    expect(overlay.locator("table")).to_have_count(0)
    one = card(overlay, QUICK)
    one.get_by_role("button", name="run").click()
    expect(one.locator("tbody tr").first).to_be_visible(timeout=COMPILED)
    assert [one for one in page.evaluate("sent") if one.startswith("hard-cases-")] == ["hard-cases-run"]
    rows = one.locator("tbody tr")
    expect(rows.first).to_contain_text("Hertz collision, duration")
    assert rows.count() == 9
    for verdict, figure, bar in zip(one.locator(".verdict").all_inner_texts(),
                                    one.locator("td.number:nth-child(3)").all_inner_texts(),
                                    one.locator("td.number:nth-child(4)").all_inner_texts(), strict=True):
        assert verdict == ("✓ passed" if float(figure) <= float(bar.removeprefix("≤ ")) else "✕ FAILED")
    page.wait_for_function(f"({DRAWN})()", timeout=COMPILED)
    picture = page.evaluate(DRAWN)
    assert len(picture["dashes"]) == 4 and len(set(picture["dashes"])) == 4  # distinguishable without colour
    assert picture["titles"] == ["velocity over the first bead's", "scaled time"]
    box = one.locator(".drawn canvas").first.bounding_box()
    assert box is not None and box["width"] > 300 and box["height"] > 250
    expect(one.get_by_role("button", name="run")).to_have_text("run again")
    expect(overlay).to_contain_text(f"1 of {len(CASES)} cases run")
    # the result is reported in its tab and stays
    page.keyboard.press("Escape")
    expect(page.locator("#tabs")).to_contain_text(f"1 of {len(CASES)} cases run")


def test_run_all_is_stopped_at_once_and_all_cases_fit(visit: Visit) -> None:
    page = visit()
    overlay = opened(page)
    overlay.get_by_role("button", name="run all").click()
    expect(card(overlay, LONG)).to_contain_text("computing")
    expect(card(overlay, QUICK)).to_contain_text("waiting for its turn …")
    overlay.get_by_role("button", name="stop", exact=True).click()
    expect(card(overlay, QUICK)).to_contain_text("stopped")
    expect(card(overlay, LONG)).to_contain_text("stopped")
    expect(overlay.get_by_role("button", name="run all (quick)")).to_be_visible()
    for width, height in ((1280, 800), (1920, 1080), (390, 844)):
        resize(page, width, height)
        for one in overlay.locator("article").all():
            box = one.bounding_box()
            assert box is not None and box["x"] >= 0 and box["x"] + box["width"] <= width
            expect(one).to_have_text(re.compile("Hard:.*Naive:.*Known from:", re.DOTALL))
