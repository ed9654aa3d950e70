"""Nothing on the main page is cut: titles of axes, numbers of beads, the equation; on a laptop, a large screen, a phone."""

from __future__ import annotations

import pytest
from knobs import Visit
from playwright.sync_api import expect

WIDTHS = ((1280, 800), (1920, 1080), (390, 844))
LOOKS = pytest.mark.parametrize("look", ["light", "projector"])

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


@LOOKS
def test_the_titles_of_the_axes_are_whole(visit: Visit, look: str) -> None:
    page = visit(f"?look={look}")
    for width, height in WIDTHS:
        page.set_viewport_size({"width": width, "height": height})
        words = ("in (", "out (") if width == 390 else ("input force (", "output force (")
        if look == "light":
            page.wait_for_function(f"([input, output]) => (({TITLES})()[1][0].startsWith(input)"
                                   f" && ({TITLES})()[2][0].startsWith(output))", arg=list(words))
        page.wait_for_function(f"({TITLES})().every(([title, room]) => title && room >= 0)", timeout=10_000)
        assert page.evaluate(BEADS) > 0


def test_the_titles_follow_the_window(visit: Visit) -> None:
    page = visit()
    page.set_viewport_size({"width": 900, "height": 800})
    page.wait_for_function(f"({TITLES})()[1][0].startsWith('in (')")
    page.set_viewport_size({"width": 1280, "height": 800})
    page.wait_for_function(f"({TITLES})()[1][0].startsWith('input force (')")


@pytest.mark.parametrize("knobs", ["", "&dissipation=tsuji&tension=cut&F0=1"])
def test_the_equation_is_whole(visit: Visit, knobs: str) -> None:
    page = visit(f"?v=1&scene=rig{knobs}")
    formula = page.locator("#equation .formula")
    whole = "(box) => [box, ...box.children].every((one) => one.scrollWidth <= one.clientWidth)"
    for width, height in WIDTHS:
        page.set_viewport_size({"width": width, "height": height})
        if width == 390:
            page.get_by_role("button", name="Show the knobs").click()
        expect(formula.locator("math").first).to_be_visible()
        assert formula.evaluate(whole), width
        assert formula.locator("math").count() == 5
