"""Nothing on the main page is cut: titles of axes, numbers of beads, the equation; on a laptop, a large screen, a phone."""

from __future__ import annotations

import pytest
from knobs import COMPILED, Visit
from layout_faults import faults
from playwright.sync_api import Page, expect
from server import until

#: Laptops, screens, a beamer, a phone.
SIZES = ((1024, 768), (1180, 820), (1280, 800), (1280, 720), (1366, 768), (1440, 900), (1536, 864), (1920, 1080),
         (2560, 1440), (390, 844))
WIDTHS = ((1280, 800), (1920, 1080), (390, 844))

# The title of every horizontal axis beside the map: its words, and how far its box is inside its picture on both sides.
TITLES = """() => [["left", "input force"], ["right", "output force"]].flatMap(([id, name]) => {
  const host = document.getElementById(id).getBoundingClientRect();
  const view = Bokeh.index.find_one(Bokeh.documents[0].get_model_by_name(name));
  const pen = document.createElement("canvas").getContext("2d");
  const size = getComputedStyle(document.documentElement).getPropertyValue("--small");
  pen.font = `bold ${size} helvetica`;
  if (!view?.frame) return [["", -1]];
  const { left, right } = view.frame.bbox;
  return [...view.model.above, ...view.model.below].map(({ axis_label }) => {
    const half = 0.5 * pen.measureText(axis_label).width, middle = 0.5 * (left + right);
    return [axis_label, Math.min(middle - half, host.width - middle - half)];
  });
})"""

# Pixels between the numbers of two neighbouring beads above the map, less the width of the wider one.
BEADS = """() => {
  const map = Bokeh.index.find_one(Bokeh.documents[0].get_model_by_name("kinetic energy"));
  const pen = document.createElement("canvas").getContext("2d");
  pen.font = `${getComputedStyle(document.documentElement).getPropertyValue("--small")} helvetica`;
  const { x_scale } = map.frame, { interval } = map.model.above[0].ticker;
  return x_scale.compute(interval) - x_scale.compute(0) - pen.measureText("10").width;
}"""


def titles_are_whole(page: Page) -> None:
    """Wait until the titles of the axes and the numbers of the beads are not cut; their step follows the width."""
    page.wait_for_function(f"({TITLES})().every(([title, room]) => title && room >= 0)")
    page.wait_for_function(f"({BEADS})() > 0")


def fits(page: Page) -> None:
    """Wait until nothing is cut: titles and names follow a new size."""
    found: list[str] = []

    def whole() -> bool:
        found[:] = faults(page)
        return not found

    try:
        until(page, whole)
    except AssertionError:
        raise AssertionError(f"{page.viewport_size}: {found}") from None


@pytest.mark.parametrize("scene", ["sec2", "fig11-founded"])
def test_no_control_and_no_word_is_cut_hidden_or_covered(visit: Visit, scene: str) -> None:
    page = visit(f"?v=1&scene={scene}&look=light")
    page.wait_for_selector(".chapters button", timeout=COMPILED)
    for look in ("light", "dark", "projector"):
        expect(page.locator("html")).to_have_attribute("data-theme", look)
        for width, height in SIZES:
            page.set_viewport_size({"width": width, "height": height})
            fits(page)
        page.set_viewport_size({"width": 1920, "height": 1080})  # where the bar has room for its button
        page.get_by_role("button", name="Theme: light, dark, projector").click()


def test_the_projector_has_whole_titles_and_on_a_phone_a_menu(visit: Visit) -> None:
    """The menu has what the bar has no room for."""
    page = visit("?look=projector", viewport={"width": 390, "height": 844})
    for width, height in (WIDTHS[-1], *WIDTHS):  # the phone is the last of them, and the first here
        page.set_viewport_size({"width": width, "height": height})
        titles_are_whole(page)
    theme = page.get_by_role("button", name="Theme: light, dark, projector")
    expect(theme).to_be_hidden()
    page.get_by_role("button", name="More controls").click()
    expect(theme).to_be_visible()
    fits(page)
    theme.click()
    page.wait_for_function("document.documentElement.dataset.theme === 'light'")
    page.set_viewport_size({"width": 2560, "height": 1440})
    expect(page.get_by_role("button", name="More controls")).to_be_hidden()
    expect(page.locator("select.scene option:checked")).to_have_text("sec2 — Section 2: eleven steel beads, driven")


def test_titles_and_words_follow_the_window(visit: Visit) -> None:
    page = visit("?look=light")
    assert page.evaluate("[document.documentElement.scrollWidth, document.documentElement.scrollHeight]") == [1280, 800]
    foot = page.locator("#foot").bounding_box()
    assert foot is not None and foot["y"] + foot["height"] <= 800  # all is in view without scrolling
    for width, height in WIDTHS:
        page.set_viewport_size({"width": width, "height": height})
        words = ("in (", "out (") if width == 390 else ("input force (", "output force (")
        page.wait_for_function(f"([input, output]) => (({TITLES})()[1][0].startsWith(input)"
                               f" && ({TITLES})()[2][0].startsWith(output))", arg=list(words))
        titles_are_whole(page)
    page.set_viewport_size({"width": 900, "height": 800})
    page.wait_for_function(f"({TITLES})()[1][0].startsWith('in (')")
    page.set_viewport_size({"width": 1280, "height": 800})
    page.wait_for_function(f"({TITLES})()[1][0].startsWith('input force (')")
    for width, height, least in ((1280, 800, 15.0), (1920, 1080, 18.0), (2560, 1440, 21.0)):
        page.set_viewport_size({"width": width, "height": height})
        page.wait_for_function("least => parseFloat(getComputedStyle(document.querySelector('#foot')).fontSize) >= least", arg=least)


@pytest.mark.parametrize("knobs", ["", "&dissipation=tsuji&tension=cut&F0=1"])
def test_the_equation_is_whole(visit: Visit, knobs: str) -> None:
    page = visit(f"?v=1&scene=rig{knobs}")
    formula = page.locator("#equation .formula")
    whole = "(box) => [box, ...box.children].every((one) => one.scrollWidth <= one.clientWidth)"
    for width, height in WIDTHS:
        page.set_viewport_size({"width": width, "height": height})
        if width == 390:
            page.get_by_role("button", name="Show or hide the other knobs").click()
        expect(formula.locator("math").first).to_be_visible()
        until(page, lambda: formula.locator("math").count() == 5 and formula.evaluate(whole))
