"""axe-core finds nothing on any tab, page and popover; what the page says to those who do not see it."""

from __future__ import annotations

from axe_playwright_python.sync_playwright import Axe
from knobs import COMPILED, Visit, settled, type_into
from playwright.sync_api import Page, expect

POPOVERS = ("Help and keys (?)", "Export: pictures, tables, a program", "Link to this picture")
#: What depends on the look; everything else is the same in all of them.
OF_THE_LOOK = {"runOnly": {"type": "rule", "values": ["color-contrast"]}}


# What axe-core finds within an element in each theme; a theme's colours are all in the style sheet (app/pictures/theme.py).
RUN = """async ([within, options]) => {
  const found = {}, root = document.documentElement.dataset, chosen = root.theme;
  for (const [theme, asked] of Object.entries(options)) {
    root.theme = theme;
    const { violations } = await axe.run(within ?? document, { resultTypes: ["violations"], ...asked });
    found[theme] = violations.flatMap(({ id, nodes }) => nodes.map(({ html }) => `${id}: ${html.slice(0, 120)}`));
  }
  root.theme = chosen;
  return found;
}"""


def violations(page: Page, within: str | None = None) -> dict[str, list[str]]:
    """Rule and element of everything that axe-core finds in each look, on the whole page or within one element."""
    if not page.evaluate("'axe' in window"):
        page.evaluate(Axe().axe_script)  # once: it is half a megabyte, and many places are looked at
    found = page.evaluate(RUN, [within, {"light": {}, "dark": OF_THE_LOOK, "projector": OF_THE_LOOK}])
    return {look: what for look, what in found.items() if what}


def test_axe_finds_nothing(visit: Visit) -> None:
    page = visit("?v=1&look=light")
    page.wait_for_selector(".chapters button", timeout=COMPILED)
    found = everywhere(page)
    assert len(found) > 20 and {where: what for where, what in found.items() if what} == {}
    page.evaluate("document.documentElement.style.setProperty('--ink', '#999')")  # so it would be found
    assert "color-contrast" in str(violations(page, "#bar"))


def everywhere(page: Page) -> dict[str, dict[str, list[str]]]:
    """What axe-core finds on the page as it is, on every page and tab, and in every popover on a large screen."""
    page.evaluate("shown()")
    found = {"whole page": violations(page)}
    for name in page.evaluate("[...document.querySelectorAll('[data-overlay]')].map((one) => one.dataset.overlay)"):
        page.evaluate("(name) => granchain.openPage(name)", name)
        page.evaluate("shown()")
        found[f"page {name}"] = violations(page, "#overlay")
        if name == "branches":  # it goes on although nobody looks, which takes a processor
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


def test_the_pictures_are_told_in_words_and_tables(visit: Visit) -> None:
    page = visit("?v=1&scene=sec2&f=850")
    settled(page)
    summary = page.locator("#summary")
    expect(summary).to_contain_text("At 850 Hz: period 1")
    expect(summary).to_contain_text("591 mN, and at most 237 mN arrive at the wall, 0.401 times as much. Bead 1 has the most")
    expect(page.locator("main")).to_have_attribute("aria-describedby", "summary")
    expect(page.locator("#announced")).to_contain_text("period 1")
    page.get_by_role("tab", name="numbers").click()
    rows = page.locator("#tabs .numbers tbody tr")
    expect(rows).to_have_count(25)
    page.get_by_label("which table").select_option("beads")
    expect(rows).to_have_count(11)
    type_into(page, "f", "340")
    expect(summary).to_contain_text("arrive at the wall, 0.901 times as much")
    page.wait_for_selector(".chapters button", timeout=COMPILED)
    page.get_by_label("which table").select_option("curve")
    assert rows.count() > 75
    expect(rows.first).to_contain_text("mN")


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
