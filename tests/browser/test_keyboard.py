"""The keyboard: its sheet, time, and where the focus is after an overlay or a popover is opened and closed."""

from __future__ import annotations

import pytest
from knobs import Visit, settled
from playwright.sync_api import Locator, Page, expect
from server import until

from app.dashboard.table import PAGES

#: The button of each popover, and what has the focus in the popover.
POPOVERS = {"Help and keys (?)": ".popover.help",
            "Export: pictures, tables, a program": ".popover .export-menu :is(button, select) >> nth=0",
            "Link to this picture": "input[aria-label='link to this picture']"}


def opener(page: Page, name: str) -> Locator:
    """The button that opens the overlay of a tab."""
    page.get_by_role("tab", name=name, exact=True).click()
    return page.locator("#tabs").get_by_role("button", name="open the page")


@pytest.mark.parametrize("name", [row.name for row in PAGES if row.view])
def test_the_focus_moves_to_an_overlay_and_back(name: str, at: Visit) -> None:
    page = at()
    button = opener(page, name)
    for close in ("Escape", "Enter"):
        button.focus()
        page.keyboard.press("Enter")
        expect(page.locator(f"[data-overlay={name}] h2").first).to_be_focused()
        if close == "Enter":
            page.locator(f"[data-overlay={name}]").get_by_role("button", name="✕").focus()
        page.keyboard.press(close)
        expect(page.locator(f"[data-overlay={name}]")).to_be_hidden()
        expect(button).to_be_focused()


@pytest.mark.parametrize("overlaid", [False, True], ids=["tab", "overlay"])
def test_the_focus_stays_at_a_button_that_is_drawn_again(overlaid: bool, at: Visit) -> None:
    """The open tab is made anew whenever the state of the tabs changes, such as by a warning about the amplitude."""
    page = at()
    settled(page)
    button = opener(page, "analysis")
    button.focus()
    if overlaid:
        page.keyboard.press("Enter")
        expect(page.locator("[data-overlay=analysis] h2").first).to_be_focused()
    page.locator("#tabs button.open").evaluate("button => { button.old = true; }")
    page.evaluate("""() => {
        const [tabs] = figures.models().filter(({ data }) => data?.attributes?.state?.tabs);
        tabs.data.setv({ state: { ...tabs.data.attributes.state, validity: [`At ${performance.now()} ms.`] } }, { sync: false });
    }""")
    until(page, lambda: page.locator("#tabs button.open").evaluate("button => !button.old"))
    if overlaid:
        page.keyboard.press("Escape")
    expect(button).to_be_focused()


@pytest.mark.parametrize("name", POPOVERS)
def test_the_focus_moves_to_a_popover_and_back(name: str, at: Visit) -> None:
    page = at(viewport={"width": 1920, "height": 1080})
    button = page.get_by_role("button", name=name, exact=True)
    button.focus()
    page.keyboard.press("Enter")
    expect(page.locator(POPOVERS[name])).to_be_focused()
    page.keyboard.press("Escape")
    expect(page.locator(POPOVERS[name])).to_be_hidden()
    expect(button).to_be_focused()


def test_the_focus_goes_back_to_where_a_key_was_pressed(at: Visit) -> None:
    page = at()
    tab = page.get_by_role("tab", name="effects", exact=True)
    tab.click()
    page.keyboard.press("?")
    expect(page.locator(".popover.help")).to_be_focused()
    page.keyboard.press("?")
    expect(tab).to_be_focused()


def test_the_keyboard_has_a_sheet_and_moves_time(visit: Visit) -> None:
    page = visit()
    settled(page)
    page.keyboard.press("?")
    expect(page.get_by_text("play or pause", exact=True)).to_be_visible()
    page.keyboard.press("Escape")
    expect(page.get_by_text("play or pause", exact=True)).to_be_hidden()
    cursor = page.get_by_role("slider", name="time cursor")
    cursor.focus()
    for key, told in (("Home", "0.00"), ("PageDown", "1.00"), ("End", "4.00"), ("PageUp", "3.00")):
        page.keyboard.press(key)
        expect(cursor).to_have_attribute("aria-valuetext", f"{told} drive periods")
