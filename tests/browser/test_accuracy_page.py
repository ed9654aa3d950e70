"""The Accuracy page as a visitor sees it: points appear, a measurement is stopped, and a moved knob greys the page."""

from __future__ import annotations

import re
from typing import Any

import pytest
from bokeh_figures import source
from knobs import COMPILED, Visit, settled, type_into
from playwright.sync_api import Locator, Page, expect
from server import at_rest, resize, until
from test_axe import violations

#: The figure of the page, and the number of points of each method.
FIGURE = 'figures.view("accuracy", true)?.model'
POINTS = f"""() => Object.fromEntries(({FIGURE}?.renderers ?? [])
  .filter((one) => one.glyph.type === "Scatter" && one.data_source.data.setting?.length)
  .map((one) => [one.data_source.name, one.data_source.data.ms.length]))"""


def marked(page: Page, name: str) -> int:
    """Return the number of points in the source of this name."""
    return len(source(page, "accuracy", name).get("ms", []))


def naive_line(page: Page) -> dict[str, Any]:
    """Return length and dash of the naive force's line."""
    return dict(page.evaluate("""() => {
      const [accurate, naive] = figures.model("naive forces").renderers;
      return { accurate: accurate.data_source.data.force.length, naive: naive.data_source.data.force.length,
               dash: String(naive.glyph.line_dash.value ?? naive.glyph.line_dash) };
    }"""))


def opened(page: Page) -> Locator:
    """Open the Accuracy page from the status line once its text is stable, and wait for the first points."""
    settled(page)
    page.get_by_role("button", name="asked").click()
    page.get_by_role("button", name="What accuracy costs in time").click()
    sheet = page.locator('[data-overlay="accuracy"]')
    page.wait_for_function(f"Object.keys(({POINTS})()).length > 0", timeout=COMPILED)
    expect(sheet.locator(".work canvas").first).to_be_visible()
    return sheet


def test_the_status_line_has_requested_and_reached_accuracy_and_the_time(visit: Visit) -> None:
    """This is true of the current accuracy and of another one."""
    page = visit()
    line = page.get_by_role("button", name="asked")
    expect(line).to_contain_text("asked 1e-6 · reached")
    type_into(page, "accuracy", "1e-9")
    # the time fits once the words for the place on the recomputed curve are short again
    expect(line).to_have_text(re.compile(r"asked 1e-9 · reached [^·]+ · in \S+ m?s$"), timeout=COMPILED)
    reached = line.inner_text().split(" · ")[1].removeprefix("reached ").split(" (")[0]
    assert float(reached) <= 1e-9


@pytest.fixture(scope="module")
def measured(shared: Visit) -> Page:
    """A page whose Accuracy tab has measured a chain of three beads; eleven take longer and show nothing more."""
    page = shared("?v=1&scene=sec2&N=3")
    page.get_by_role("tab", name="accuracy").click()
    expect(page.locator("#tabs .small canvas").first).to_be_visible(timeout=COMPILED)
    expect(page.locator("#tabs")).to_contain_text("The cheapest way to", timeout=COMPILED)
    return page


def test_the_tab_opens_the_page(measured: Page) -> None:
    measured.get_by_role("button", name="open the page").click()
    expect(measured.locator("#overlay .work canvas").first).to_be_visible()
    assert measured.evaluate(POINTS)
    measured.keyboard.press("Escape")
    expect(measured.locator("#overlay")).to_be_hidden()


@pytest.mark.long
def test_points_appear_and_the_cheapest_setting_is_named(measured: Page) -> None:
    page = measured
    sheet = opened(page)
    expect(sheet.get_by_role("button", name="measure again")).to_be_visible(timeout=COMPILED)
    methods = page.evaluate(POINTS)
    assert sum(methods.values()) > 30
    assert {"rk4", "rk4-split", "rk4-naive", "verlet-naive", "dop853", "scipy LSODA"} <= set(methods)
    expect(sheet).to_contain_text("The cheapest way to 1e-6 is")
    expect(sheet).to_contain_text("Two independent references agree to")
    expect(sheet).to_contain_text("against the reference; the status line has no reference and states an estimate on the safe side")
    assert marked(page, "cheapest") == 1
    assert marked(page, "now") == 1
    # another accuracy: other words, no new measurement, and nothing is greyed
    type_into(page, "accuracy", "1e-3")
    expect(sheet).to_contain_text("The cheapest way to 1e-3 is")
    expect(sheet.get_by_role("button", name="stop")).to_be_hidden()
    expect(sheet.locator(".stale")).to_have_count(0)
    rows = sheet.locator("tbody tr")
    expect(rows.filter(has_text="rk4-split")).to_contain_text("two events of one inner contact")
    expect(rows.filter(has_text="dop853").first).to_contain_text("Hairer")
    # hovering describes the point, wherever the figure has moved meanwhile
    tip = page.locator(".bk-tooltip-content")  # it is above the whole page

    def told() -> bool:
        x, y = page.evaluate("""() => {
          const { frame, model } = figures.view("accuracy", true), { data } = model.document.get_model_by_name("rk4-split");
          return [frame.x_scale.compute(data.ms[0]), frame.y_scale.compute(data.error[0])];
        }""")
        box = sheet.locator(".work canvas").first.bounding_box()
        assert box is not None
        page.mouse.move(box["x"] + x - 30, box["y"] + y)
        page.mouse.move(box["x"] + x, box["y"] + y)
        return tip.count() > 0

    until(page, told)
    for words in ("default steps", "error", "s, ", "evaluations", "order 3.9"):
        expect(tip).to_contain_text(words)
    page.mouse.move(0, 0)
    naive_force_lies_over_the_accurate_one(page, sheet)
    assert violations(page, "#overlay") == {}  # with all points and rows; test_axe.py has only the first ones
    fits(page, sheet)


def test_a_moved_knob_greys_the_page_until_it_is_measured_again(measured: Page) -> None:
    page = measured
    if page.locator("#overlay").is_hidden():
        opened(page)
    sheet = page.locator('[data-overlay="accuracy"]')
    expect(sheet.get_by_role("button", name="measure again")).to_be_visible(timeout=COMPILED)
    type_into(page, "D", "90")
    expect(sheet.locator(".stale")).to_be_visible()
    expect(sheet).to_contain_text("measured for another chain")
    type_into(page, "D", "100")
    expect(sheet.locator(".stale")).to_have_count(0)
    type_into(page, "D", "80")
    sheet.get_by_role("button", name="measure again").click()
    expect(sheet.locator(".stale")).to_have_count(0)
    page.wait_for_function(f"Object.keys(({POINTS})()).length > 0", timeout=COMPILED)
    sheet.locator("button:text-is('stop')").first.evaluate("one => one.click()")  # hidden if all is measured already


def naive_force_lies_over_the_accurate_one(page: Page, sheet: Locator) -> None:
    """Check that it is dashed, has as many points, and has its error stated for the chosen steps."""
    expect(sheet.locator(".naive canvas").first).to_be_visible()
    drawn = naive_line(page)
    assert drawn["accurate"] == drawn["naive"] > 50 and drawn["dash"] not in ("", "solid")
    said = sheet.locator(".naive p")
    expect(said).to_contain_text("With 200 steps per period, the force is off by")
    first = said.inner_text()
    sheet.get_by_label("its steps per drive period").select_option("2000")
    expect(said).to_contain_text("With 2000 steps")
    assert said.inner_text() != first


def fits(page: Page, sheet: Locator) -> None:
    """Check that the figure is inside the window at every size."""
    for width, height in ((1280, 800), (1920, 1080), (390, 844)):
        resize(page, width, height)
        box = sheet.locator(".work .figure").bounding_box()
        assert box is not None and box["x"] >= 0 and box["x"] + box["width"] <= width and box["height"] > 200, width


def test_diverging_steps_are_named_and_a_stopped_measurement_keeps_its_points(visit: Visit) -> None:
    page = visit("?v=1&scene=rig")
    sheet = opened(page)
    # at once: the button is there during the measurement, however long anything else takes
    sheet.get_by_role("button", name="stop").click()
    expect(sheet).to_contain_text("stopped", timeout=COMPILED)
    expect(sheet.get_by_role("button", name="measure again")).to_be_visible()
    assert sum(at_rest(page, f"({POINTS})()", still=1500).values()) > 0
    # the next one starts: the stopped one, which would take minutes, has really ended
    sheet.get_by_role("button", name="measure again").click()
    expect(sheet).to_contain_text("measuring")
    sheet.get_by_label("its steps per drive period").select_option("100")  # steps that blow up are reported
    expect(sheet.locator(".naive p")).to_contain_text("nothing would have been drawn", timeout=COMPILED)
    assert naive_line(page)["naive"] == 0
