"""The keyboard: elements that Tab reaches, the keys of the help, and the focus after overlays and popovers close."""

from __future__ import annotations

import pytest
from knobs import POPOVERS, Visit, field, play_button, settled, type_into
from playwright.sync_api import Locator, Page, expect
from server import until

from app.dashboard.table import PAGES

#: Numbers every visible and enabled control; of the tabs, only the open one is in the Tab order.
CONTROLS = """() => {
  const controls = [];
  const collect = (root) => {
    for (const one of root.querySelectorAll("*")) {
      const control = one.matches('button, input, select, textarea, summary, a[href], [tabindex="0"]');
      if (control && one.tabIndex >= 0 && !one.disabled && one.checkVisibility({ visibilityProperty: true }))
        controls.push(one);
      if (one.shadowRoot) collect(one.shadowRoot);
    }
  };
  collect(document.body);
  controls.forEach((one, number) => { one.controlNumber = number; });
  return controls.map((one) => one.ariaLabel || one.title || one.textContent.trim() || one.outerHTML.slice(0, 100));
}"""


def opener(page: Page, name: str) -> Locator:
    """Return the button that opens the overlay of a tab."""
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
    """The open tab is rebuilt whenever the state of the tabs changes, for example by a warning about the amplitude."""
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
    focused, width = POPOVERS[name]
    page = at(viewport={"width": width, "height": 1080})
    button = page.get_by_role("button", name=name, exact=True)
    button.focus()
    expect(button).to_have_attribute("aria-expanded", "false")
    page.keyboard.press("Enter")
    expect(page.locator(focused)).to_be_focused()
    expect(button).to_have_attribute("aria-expanded", "true")
    page.keyboard.press("Escape")
    expect(page.locator(focused)).to_be_hidden()
    expect(button).to_be_focused()
    expect(button).to_have_attribute("aria-expanded", "false")


def test_tab_reaches_every_control(at: Visit) -> None:
    page = at()
    settled(page)
    names = page.evaluate(CONTROLS)
    page.evaluate("document.activeElement?.blur()")
    reached = set()
    for _ in range(len(names) + 10):  # the browser itself and the ends of the page use some
        page.keyboard.press("Tab")
        reached.add(page.evaluate("granchain.focused?.controlNumber ?? -1"))
    assert [name for number, name in enumerate(names) if number not in reached] == []
    assert len(names) > 30


@pytest.mark.parametrize("key", ["Enter", "Space"])
def test_an_entry_of_the_status_line_is_a_button(key: str, at: Visit) -> None:
    page = at()
    settled(page)
    before = play_button(page).get_attribute("aria-label")
    for entry in ("#regime", "#accuracy"):
        page.locator(f"#foot {entry}").press(key)
        expect(page.locator("#term")).to_be_visible()
        expect(page.locator("#term")).to_have_role("dialog" if entry == "#accuracy" else "tooltip")
        page.keyboard.press("Escape")
        expect(page.locator("#term")).to_be_hidden()
        expect(page.locator(f"#foot {entry}")).to_be_focused()
    assert play_button(page).get_attribute("aria-label") == before


def test_the_name_of_the_play_button_says_what_it_does(at: Visit) -> None:
    page = at()
    settled(page)
    first = play_button(page).get_attribute("aria-label")
    page.evaluate("granchain.focused?.blur()")
    page.keyboard.press("Space")
    other = {"Play (space)": "Pause (space)", "Pause (space)": "Play (space)"}[first or ""]
    expect(play_button(page)).to_have_attribute("aria-label", other)


@pytest.mark.parametrize("key", ["Delete", "Backspace"])
def test_a_key_restores_a_knob_and_is_announced(key: str, at: Visit) -> None:
    page = at()
    type_into(page, "f", "615")
    page.locator('[data-knob="f"] input[type="range"]').press(key)
    expect(field(page, "f")).to_have_value("340")
    expect(page.locator("#announced-knob")).to_contain_text("back at the scene's value, 340 Hz")


def test_the_key_of_the_help_can_be_switched_off(visit: Visit) -> None:
    page = visit()
    page.keyboard.press("?")
    switch = page.get_by_label("The key ? opens this help.")
    switch.uncheck()
    page.keyboard.press("Escape")
    page.keyboard.press("?")
    expect(page.locator(".popover.help")).to_be_hidden()
    page.get_by_role("button", name="Help and keys (?)", exact=True).click()
    switch.check()
    page.keyboard.press("Escape")
    page.keyboard.press("?")
    expect(page.locator(".popover.help")).to_be_visible()


def test_the_tour_takes_the_focus_and_gives_it_back(at: Visit) -> None:
    page = at(viewport={"width": 1920, "height": 1080})
    page.get_by_role("button", name="Help and keys (?)", exact=True).press("Enter")
    page.get_by_role("button", name="show the tour again").press("Enter")
    expect(page.get_by_role("dialog", name="tour of the page")).to_be_focused()
    page.keyboard.press("Escape")
    expect(page.get_by_role("button", name="Help and keys (?)", exact=True)).to_be_focused()


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
