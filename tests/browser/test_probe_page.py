"""A clicked bead, in the chain or in the energy map: its phase portrait in the tab, six pictures on the page."""

from __future__ import annotations

from bokeh_figures import source
from knobs import Visit, settled, type_into
from playwright.sync_api import expect
from server import until

from app.parts.figures.figure_style import BOTTOM, GAP, TOP

# Rest position of a bead of the chain on the screen.
BEAD = """(bead) => {
  const { left, top, width, height } = canvasIn("chain").getBoundingClientRect();
  const long = width - 62 - 26, pitch = Math.min(long / 11, 0.66 * height);
  return [left + 62 + (long - 11 * pitch) / 2 + (bead - 0.5) * pitch, top + 0.58 * height];
}"""


def test_a_bead_of_the_chain_is_probed(visit: Visit) -> None:
    page = visit("?v=1&scene=sec2&f=1130")
    settled(page)
    page.mouse.click(*page.evaluate(BEAD, 5))
    expect(page.get_by_role("tab", name="probe")).to_have_attribute("aria-selected", "true")
    expect(page.locator("#tabs")).to_contain_text("Bead 5 of 11")
    page.wait_for_function("granchain.pages.get('probe').drawn.phase.strobe.data.x.length === 3")  # one per drive period: 1:3
    page.locator("#tabs").get_by_role("button", name="open the page").click()
    expect(page.get_by_role("heading", name="One bead")).to_be_visible()
    for figure, name in (("probe displacement", "line"), ("probe forces", "before"), ("probe velocity", "line"),
                         ("probe spectrum", "lines"), ("probe contacts", "own"), ("probe phase", "strobe")):
        until(page, lambda one=figure, of=name: any(source(page, one, of).values()))
    page.get_by_role("button", name="the next bead").click()
    expect(page.locator("#overlay")).to_contain_text("Bead 6 of 11")
    # it follows the knobs: at the 1:1 resonance, every drive period equals the previous one
    type_into(page, "f", "340")
    page.wait_for_function("granchain.pages.get('probe').drawn.phase.strobe.data.x.length === 1")


def test_a_click_in_the_map_probes_the_bead_and_a_drag_moves_time(visit: Visit) -> None:
    page = visit()
    settled(page)
    box = page.locator("#map").bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + 90, box["y"] + TOP + 20)
    page.mouse.down()
    page.mouse.move(box["x"] + 90, box["y"] + TOP + 120, steps=4)
    page.mouse.up()
    expect(page.locator("#column")).to_be_hidden()
    expect(page.get_by_role("tab", name="stories")).to_have_attribute("aria-selected", "true")
    for bead, time in ((1, 0.5), (11, 0.3)):  # a click on the cursor would grab that instead
        x = box["x"] + GAP + (box["width"] - 2 * GAP) * (bead - 0.5) / 11
        page.mouse.click(x, box["y"] + TOP + time * (box["height"] - TOP - BOTTOM))
        expect(page.locator("#tabs")).to_contain_text(f"Bead {bead} of 11")
        expect(page.locator("#column")).to_be_visible()
