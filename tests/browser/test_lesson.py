"""What a first-time visitor can read from the page: scales, the largest forces, and the column of each bead."""

from __future__ import annotations

import pytest
from knobs import COMPILED, Visit, settled, type_into
from layout_faults import faults
from playwright.sync_api import expect
from server import at_rest, until
from test_axe import violations

from granchain_core import scene_names


def test_scales_and_largest_forces_are_labelled_in_their_figures(at: Visit) -> None:
    page = at("?v=1&scene=sec2&f=850")
    settled(page)
    peaks = page.locator("#stage .peak")
    expect(peaks).to_contain_text(["max 0.591 N", "max 0.237 N"])  # small on axes that end at the scene's largest value
    scale = page.locator("#scale .segments button")
    expect(scale).to_have_text(["same scale for all f", "fit"])
    expect(page.locator("#scale .colours")).to_have_text("square-root scale 0 100 400 nJ", use_inner_text=True)
    time = "() => figures.model('input force').left[0].axis_label"
    assert page.evaluate(time) == "time (ms), 4 drive periods"  # an orbit of one period, repeated
    page.get_by_role("button", name="fit", exact=True).click()
    expect(scale).to_have_text(["same scale", "fitted to each picture"])
    expect(peaks).to_contain_text(["max 591 mN", "max 237 mN"])
    type_into(page, "f", "1130")
    expect(peaks).to_contain_text(["max 1.87 N", "max 1.12 N"])
    page.set_viewport_size({"width": 390, "height": 844})
    expect(page.get_by_text("√ scale")).to_be_visible()


# Start and end of the link on the screen, and the frame around the column; null while there is none.
LINK = """() => {
  const link = document.getElementById("link"), stage = document.getElementById("stage").getBoundingClientRect();
  if (link.hasAttribute("hidden")) return null;
  const [x, , to] = link.querySelector("polyline").getAttribute("points").split(/[ ,]/).map(Number);
  const column = link.querySelector("rect").getBoundingClientRect();
  return [x + stage.x, to + stage.x, column.x, column.width];
}"""


def test_a_bead_that_is_pointed_at_is_joined_to_its_column_and_a_column_to_its_bead(at: Visit) -> None:
    """The chain is wider than the map, so no bead is above its column."""
    page = at("?v=1&scene=sec2&f=340")
    settled(page)
    assert page.evaluate(LINK) is None
    home, top, left, width, high = page.evaluate("""() => {
      const chain = document.getElementById("chain").getBoundingClientRect(), map = document.getElementById("map").getBoundingClientRect();
      const pitch = (chain.width - 62 - 26) / 11; // the space at the sides is for driver and wall
      return [chain.x + 62 + 3.5 * pitch, chain.y + 0.58 * chain.height, map.x + 6, map.width - 12, map.y + 0.5 * map.height]; }""")
    column = left + 3 / 11 * width
    page.mouse.move(home, top)  # bead 4 at its rest position
    page.wait_for_function(f"({LINK})()")
    assert page.evaluate(LINK) == pytest.approx([home, column + width / 22, column, width / 11], abs=1.5)
    ringed = at_rest(page, "pixels('chain')")
    page.mouse.move(5, 5)
    page.wait_for_function(f"!({LINK})()")
    assert at_rest(page, "pixels('chain')") != ringed
    page.mouse.move(column + width / 22, high)
    page.wait_for_function(f"({LINK})()")
    assert page.evaluate(LINK)[0] == pytest.approx(home, abs=1.5)
    assert at_rest(page, "pixels('chain')") == ringed


# The word on every visible button of the bar, and the name of the button.
BUTTONS = """() => {
  const found = [], look = (node) => {
    for (const one of node.querySelectorAll("*")) {
      if (one.shadowRoot) look(one.shadowRoot);
      if (one.tagName === "BUTTON" && one.checkVisibility()) found.push([one.innerText.trim().toLowerCase(), one.ariaLabel.toLowerCase()]);
    }
  };
  look(document.getElementById("bar"));
  return found;
}"""


def test_every_button_of_the_bar_has_a_word_that_is_in_its_name(at: Visit) -> None:
    page = at()
    for width in (1280, 390):
        page.set_viewport_size({"width": width, "height": 844})
        page.evaluate("shown()")
        page.get_by_role("button", name="More controls").click()
        buttons = page.evaluate(BUTTONS)
        assert len(buttons) >= 14
        assert [one for one in buttons if not one[0] or one[0] not in one[1]] == []
        page.get_by_role("button", name="More controls").click()


def test_on_a_phone_one_tap_puts_the_curve_under_the_picture(visit: Visit) -> None:
    page = visit("?v=1&scene=sec2&f=340", viewport={"width": 390, "height": 844}, has_touch=True)
    settled(page)
    curve, button = page.locator("#curve"), page.get_by_role("button", name="Resonance curve under the pictures")
    foot, below = page.locator("#foot").bounding_box(), curve.bounding_box()
    assert foot and below and below["y"] >= foot["y"]  # below the status line and the knob f
    button.tap()
    page.wait_for_selector(".peak-names button", timeout=COMPILED)
    for part in ("chain", "map", "curve"):
        expect(page.locator(f"#{part}")).to_be_in_viewport(ratio=1)
    sheet, box = page.locator("#side").bounding_box(), curve.bounding_box()
    assert sheet and box and box["y"] + box["height"] <= sheet["y"]  # the knob f does not cover it
    until(page, lambda: faults(page) == [])
    page.locator(".peak-names .peak").nth(1).tap()
    expect(page.locator("#foot #regime")).to_contain_text("1:2 resonance")
    page.get_by_role("button", name="Show or hide the other knobs").tap()
    expect(button).to_have_attribute("aria-pressed", "false")  # the sheet has its place


def test_a_scene_is_chosen_by_its_picture_with_the_keyboard(visit: Visit) -> None:
    page = visit(viewport={"width": 1920, "height": 1080})
    settled(page)
    assert "gallery" not in page.evaluate("sent")
    assert page.locator(".gallery img").count() == 0  # none of it is loaded with the page
    scenes = page.get_by_role("button", name="Scenes with pictures")
    scenes.press("Enter")
    cards = page.locator(".gallery .card")
    expect(cards).to_have_count(len(scene_names()))
    expect(page.locator('.gallery .card[value="sec2"]')).to_be_focused()  # the current scene
    whole = "(one) => one.loading === 'lazy' && one.complete && one.naturalWidth > 0"
    until(page, lambda: all(one.evaluate(whole) for one in cards.locator("img").all()[:4]))
    assert violations(page, "#bar") == {}
    page.set_viewport_size({"width": 390, "height": 844})
    expect(cards.first).to_be_in_viewport()  # it stays open when the window is resized
    assert page.evaluate("(card) => card.getBoundingClientRect().right", cards.first.element_handle()) < 390
    page.keyboard.press("Tab")
    page.keyboard.press("Enter")
    expect(cards.first).to_be_hidden()
    expect(page.locator("select.scene")).to_have_value(scene_names()[1])
    page.set_viewport_size({"width": 1280, "height": 800})
    scenes.click()
    expect(cards).to_have_count(len(scene_names()))
    page.keyboard.press("Escape")
    expect(cards.first).to_be_hidden()
    assert page.evaluate("sent").count("gallery") == 1
