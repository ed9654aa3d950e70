"""Nothing on the main page is cut (axis titles, bead numbers, the equation) on a laptop, a large screen or a phone."""

from __future__ import annotations

import re

import pytest
from knobs import COMPILED, Visit, settled, type_into
from layout_faults import faults
from playwright.sync_api import Page, expect
from server import ROOT, at_rest, until

from app.plots.theme import THEMES, style_sheet

#: Laptops, screens, a projector, a phone.
SIZES = ((1024, 768), (1180, 820), (1280, 800), (1280, 720), (1366, 768), (1440, 900), (1536, 864), (1920, 1080),
         (2560, 1440), (390, 844))
#: One size on each side of every limit in the style sheets at which the layout changes.
LAYOUTS = ((1024, 768), (1280, 800), (1920, 1080), (390, 844))
WIDTHS = ((1280, 800), (1920, 1080), (390, 844))

# The title of every horizontal axis next to the map: its words, and its box's distance from both edges of its picture.
TITLES = """() => [["left", "input force"], ["right", "output force"]].flatMap(([id, name]) => {
  const host = document.getElementById(id).getBoundingClientRect();
  const view = figures.viewOf(figures.model(name));
  const pen = document.createElement("canvas").getContext("2d");
  const size = getComputedStyle(document.documentElement).getPropertyValue("--small-text-size");
  pen.font = `bold ${size} helvetica`;
  if (!view?.frame) return [["", -1]];
  const { left, right } = view.frame.bbox;
  return [...view.model.above, ...view.model.below].map(({ axis_label }) => {
    const half = 0.5 * pen.measureText(axis_label).width, middle = 0.5 * (left + right);
    return [axis_label, Math.min(middle - half, host.width - middle - half)];
  });
})"""

# Pixels between the numbers of two neighbouring beads above the map, minus the width of the wider one.
BEADS = """() => {
  const map = figures.viewOf(figures.model("kinetic energy"));
  const pen = document.createElement("canvas").getContext("2d");
  pen.font = `${getComputedStyle(document.documentElement).getPropertyValue("--small-text-size")} helvetica`;
  const { x_scale } = map.frame, { interval } = map.model.above[0].ticker;
  return x_scale.compute(interval) - x_scale.compute(0) - pen.measureText("10").width;
}"""


# Whether all titles over the pictures have one line, and either all have their full text or all their short form.
OVER = """() => {
  const titles = [...document.querySelectorAll("#stage .title")];
  const line = parseFloat(getComputedStyle(titles[0]).lineHeight);
  return titles.every((one) => one.offsetHeight < 1.5 * line) && new Set(titles.map((one) => one.className)).size === 1;
}"""


def titles_are_whole(page: Page) -> None:
    """Wait until titles over the pictures have one line (the axis below needs the second), and axis titles and bead
    numbers are not cut; the step between bead numbers follows the width.
    """
    page.wait_for_function(OVER)
    page.wait_for_function(f"({TITLES})().every(([title, room]) => title && room >= 0)")
    page.wait_for_function(f"({BEADS})() > 0")


def fits(page: Page) -> None:
    """Wait until nothing is cut; titles and names adapt to a new size."""
    found: list[str] = []

    def whole() -> bool:
        found[:] = faults(page)
        return not found

    try:
        until(page, whole)
    except AssertionError:
        raise AssertionError(f"{page.viewport_size}: {found}") from None


def test_dark_differs_from_light_in_colours_only() -> None:
    """The tests below only check the light theme: with equal sizes, everything that fits there fits in the dark one."""
    for role in ("line_scale", "text_size", "largest_text_size", "small_text_size", "largest_small_text_size"):
        assert getattr(THEMES["dark"], role) == getattr(THEMES["light"], role)
    dark = next(rule for rule in style_sheet().splitlines() if "data-theme=dark" in rule)
    values = re.findall(r"--[\w-]+: ([^;}]+)", dark)
    assert len(values) > 5 and all(re.fullmatch(r"#[0-9a-f]{6}", value.strip()) for value in values), dark
    sheets = [path for path in (ROOT / "app").rglob("*.css")
              if re.search(r"data-theme\W+dark|prefers-color-scheme", path.read_text(encoding="utf-8"))]
    assert sheets == []


@pytest.mark.long
@pytest.mark.parametrize(("scene", "sizes"), [("sec2", SIZES), ("fig11-founded", LAYOUTS)])
def test_no_control_and_no_word_is_cut_hidden_or_covered(at: Visit, scene: str, sizes: tuple[tuple[int, int], ...]) -> None:
    """One scene is checked at all sizes, and another one, with a longer equation, in each layout."""
    page = at(f"?v=1&scene={scene}&look=light")
    page.wait_for_selector(".peak-names button", timeout=COMPILED)
    for theme in THEMES:
        expect(page.locator("html")).to_have_attribute("data-theme", theme)
        for width, height in sizes if theme != "dark" else ():
            page.set_viewport_size({"width": width, "height": height})
            fits(page)
        page.set_viewport_size({"width": 1920, "height": 1080})  # where the bar has room for its button
        page.get_by_role("button", name="Theme: ").click()


def test_a_low_window_keeps_the_height_of_its_pictures(at: Visit) -> None:
    """Such windows are a phone in landscape orientation, and a page zoomed to 200 % and 150 %."""
    page = at("?v=1&scene=sec2&k=1234567&look=light")  # with the largest number of digits that a knob can have
    side = page.locator("#side").evaluate("(one) => one.getBoundingClientRect().right")
    knobs = page.locator("#knobs .knob *")
    assert knobs.evaluate_all("(all) => Math.max(...all.map((one) => one.getBoundingClientRect().right))") <= side - 9
    for width, height in ((844, 390), (640, 400), (853, 533)):
        page.set_viewport_size({"width": width, "height": height})
        fits(page)
        heights = {name: page.locator(f"#{name}").evaluate("(one) => one.offsetHeight") for name in ("map", "curve")}
        assert heights["map"] > 300 and heights["curve"] > 250, (width, heights)


def test_the_projector_has_whole_titles_and_on_a_phone_a_menu(visit: Visit) -> None:
    """The menu has the controls for which the bar has no room."""
    page = visit("?look=projector", viewport={"width": 390, "height": 844})
    for width, height in (WIDTHS[-1], *WIDTHS):  # the phone is the last of them, and the first here
        page.set_viewport_size({"width": width, "height": height})
        titles_are_whole(page)
    theme = page.get_by_role("button", name="Theme: ")
    expect(theme).to_be_hidden()
    page.get_by_role("button", name="More controls").click()
    expect(theme).to_be_visible()
    fits(page)
    theme.click()
    page.wait_for_function("document.documentElement.dataset.theme === 'light'")
    page.set_viewport_size({"width": 2560, "height": 1440})
    expect(page.get_by_role("button", name="More controls")).to_be_hidden()
    expect(page.locator("select.scene option:checked")).to_have_text("sec2 — Section 2: eleven steel beads, driven")


# Positions of the pictures, the curve and the status line, and the words of that line that are cut.
BOXES = """() => ["#left", "#map", "#right", "#curve", "#foot"].map((one) => {
  const { x, y, width, height } = document.querySelector(one).getBoundingClientRect();
  return [x, y, width, height].map(Math.round);
})"""
CUT = "(line) => [line, ...line.children].filter((one) => one.scrollWidth > one.clientWidth + 1).map((one) => one.textContent)"


@pytest.mark.parametrize("theme", ["light", "projector"])
def test_a_moved_knob_moves_no_picture(at: Visit, theme: str) -> None:
    """This is true for motions with words of any length, and for any marks on the curve. A figure whose size changes is
    laid out again, which used to take most of the time of every picture.
    """
    page = at(f"?v=1&scene=sec2&look={theme}")
    settled(page)
    expect(page.locator("#foot #regime")).not_to_contain_text("being computed")
    boxes, said = at_rest(page, f"({BOXES})()"), set()
    for name, value in (("f", "1130"), ("f", "951.5"), ("f", "1300"), ("f", "2500"), ("D", "60"), ("f", "380"), ("A0", "0.1")):
        type_into(page, name, value)
        settled(page)
        assert page.evaluate(BOXES) == boxes and page.locator("#foot .line").evaluate(CUT) == [], (name, value)
        said.add(page.locator("#foot #regime").inner_text())
    assert max(map(len, said)) > min(map(len, said)) + 20
    line = page.locator("#foot .line")
    gone = page.locator("#foot #method")
    expect(gone).to_be_hidden()  # it made room
    assert gone.text_content() in page.locator("#foot #rest").get_attribute("title")
    few = len(line.inner_text())
    page.set_viewport_size({"width": 2560, "height": 1440})  # text grows too, but less than the screen
    until(page, lambda: len(line.inner_text()) > few)


@pytest.mark.long
@pytest.mark.parametrize("theme", ["light", "projector"])
def test_frequencies_that_the_paper_states_are_labelled(at: Visit, theme: str) -> None:
    # with more damping than the rig's 35.4, the curve has as many names and takes a sixth of the time
    page = at(f"?v=1&scene=rig&D=65&look={theme}")
    stated = page.locator(".peak-names .stated")
    expect(stated).to_have_text(["1:1", "1:1 anti", "1:2"])
    page.wait_for_selector(".peak-names .peak", timeout=COMPILED)
    for width, height in ((1024, 768), *WIDTHS):
        page.set_viewport_size({"width": width, "height": height})
        fits(page)
        for name in stated.all():
            expect(name).to_be_visible()
    page.set_viewport_size({"width": 1280, "height": 800})
    page.get_by_role("button", name="stated in the paper: 1:1 anti-resonance at 90 Hz").click()
    expect(page.locator('[data-knob="f"] input[type="text"]')).to_have_value("90")
    choice = page.get_by_label("paper’s features")
    choice.uncheck()
    expect(stated).to_have_count(0)
    page.locator("select.scene").select_option("sec2")
    expect(choice).to_be_hidden()  # the paper's frequencies are for other beads


def test_titles_and_words_follow_the_window(at: Visit) -> None:
    page = at("?v=1&scene=sec2&look=light")
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
def test_the_equation_is_whole(at: Visit, knobs: str) -> None:
    page = at(f"?v=1&scene=rig{knobs}")
    formula = page.locator("#equation .formula")
    whole = "(box) => [box, ...box.children].every((one) => one.scrollWidth <= one.clientWidth)"
    knobs_of_a_phone = page.get_by_role("button", name="Show or hide the other knobs")
    for width, height in WIDTHS:
        page.set_viewport_size({"width": width, "height": height})
        if width == 390:
            knobs_of_a_phone.click()
        expect(formula.locator("math").first).to_be_visible()
        until(page, lambda: formula.locator("math").count() == 5 and formula.evaluate(whole))
    knobs_of_a_phone.click()
