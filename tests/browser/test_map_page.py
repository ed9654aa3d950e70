"""The Map tab as a visitor sees it: it fills from coarse to fine and shows values, a click sets f and A0, and
attractors are listed.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
from bokeh_figures import hover, place, source
from evidence import watch
from knobs import COMPILED, Visit, field, type_into
from playwright.sync_api import Locator, Page, expect
from server import until

#: A short chain at high frequency: its map takes a second or two.
SMALL = "?v=1&scene=sec2&N=2"


def opened(page: Page) -> Locator:
    """Open the tab, and wait for its picture."""
    page.get_by_role("tab", name="map", exact=True).click()
    picture = page.locator("#tabs .maphost")
    expect(picture).to_be_visible()
    until(page, lambda: len(source(page, "map", "cells").get("number", [])) > 0, seconds=COMPILED / 1000)
    return picture


def visible(page: Page, name: str) -> bool:
    """Return whether a model of the figure is visible."""
    return bool(page.evaluate("(name) => figures.documentOf('map').get_model_by_name(name).visible", name))


def left_edge(page: Page) -> float:
    """Return the start of the figure's x axis."""
    return float(page.evaluate("figures.view('map', true).model.x_range.start"))


def overflow(page: Page) -> int:
    """Return the number of pixels by which the tab is too wide."""
    return int(page.locator("#tabs .body").evaluate("body => body.scrollWidth - body.clientWidth"))


@pytest.fixture(scope="module")
def filled(shared: Visit) -> Page:
    """A page with the complete map of a short chain."""
    page = shared(SMALL)
    opened(page)
    expect(page.locator('#tabs .maphost[data-done="1"]')).to_be_visible(timeout=COMPILED)  # complete
    return page


@pytest.fixture
def page(filled: Page, request: pytest.FixtureRequest, log: Path) -> Page:
    """The same page, for one more test."""
    watch(request.node, filled, log)
    return filled


def cell(page: Page) -> dict[str, Any]:
    """Return a cell of the finest size in the middle of the map."""
    cells = source(page, "map", "cells")
    x, y, spacing = (cells[name] for name in ("x", "y", "spacing"))
    row = max(range(len(x)), key=lambda i: (1900 < x[i] < 2300) * (spacing[i] == 1) * y[i] * (y[i] < 5))
    return {name: cells[name][row] for name in ("x", "y", "tooltip")}


def test_the_map_has_the_place_of_the_curve_and_every_cell_once(page: Page) -> None:
    expect(page.locator("#curve")).to_be_hidden()
    cells = source(page, "map", "cells")
    assert len(set(cells["number"])) == len(cells["number"]) == 60 * 40


def test_the_map_shows_force_or_regime(page: Page) -> None:
    cells = source(page, "map", "cells")
    assert "period 1" in cells["regime"] and len(set(cells["regime"])) > 2
    assert visible(page, "force") and not visible(page, "regime")
    page.get_by_role("button", name="regime", exact=True).click()
    assert visible(page, "regimes") and not visible(page, "bar")
    page.get_by_role("button", name="largest force").click()
    assert visible(page, "force") and not visible(page, "regimes")


def test_panning_the_map_needs_no_server(page: Page) -> None:
    """The server would refuse a message about it (`address` in conftest.py)."""
    edge, middle = left_edge(page), place(page, "map", 1800.0, 3.0)
    page.mouse.move(*middle)
    page.mouse.down()
    page.mouse.move(middle[0] - 60, middle[1], steps=3)
    page.mouse.up()
    until(page, lambda: left_edge(page) > edge)
    page.mouse.down()
    page.mouse.move(*middle, steps=3)
    page.mouse.up()
    until(page, lambda: abs(left_edge(page) - edge) < 1e-6 * edge)


def test_hovering_shows_the_values_of_a_cell(page: Page) -> None:
    one = cell(page)
    hover(page, lambda: place(page, "map", one["x"], one["y"]), one["tooltip"])
    for words in ("Hz", "m: ", "N"):
        assert words in one["tooltip"]


def test_a_click_sets_f_and_A0(page: Page) -> None:
    one = cell(page)
    before = field(page, "f").input_value(), field(page, "A0").input_value()
    page.mouse.click(*place(page, "map", one["x"], one["y"]))
    expect(field(page, "f")).not_to_have_value(before[0])
    expect(field(page, "A0")).not_to_have_value(before[1])
    assert abs(float(field(page, "f").input_value()) - one["x"]) < 1.0
    until(page, lambda: abs(source(page, "map", "mark")["x"][0] - one["x"]) < 1e-3)
    for name, value in zip(("f", "A0"), before, strict=True):
        type_into(page, name, value)


def test_keys_go_from_cell_to_cell_and_set_one(page: Page) -> None:
    picture, tip = page.locator("#tabs .maphost"), page.locator("#tabs .readout")
    picture.focus()
    picture.press("ArrowRight")
    first = tip.inner_text()
    picture.press("ArrowUp")
    assert tip.inner_text() != first
    assert len(source(page, "map", "cursor")["left"]) == 1
    chosen = float(tip.inner_text().split(" Hz")[0])
    was = field(page, "f").input_value()
    picture.press("Enter")
    expect(field(page, "f")).not_to_have_value(was)
    assert abs(float(field(page, "f").input_value()) - chosen) < 1.0
    type_into(page, "f", was)


def test_the_map_of_another_chain_is_grey_until_its_own_is_there(page: Page) -> None:
    page.locator("#tabs .maphost").evaluate("""(host) => {
      window.wasStale = false;
      const look = () => { window.wasStale ||= host.classList.contains("stale"); };
      new MutationObserver(look).observe(host, { attributes: true, attributeFilter: ["class"] });
    }""")
    type_into(page, "D", "60")
    page.wait_for_function("window.wasStale")  # the new map may be there before the next check
    expect(page.locator("#tabs .maphost.stale")).to_have_count(0)


def test_the_tab_fits_a_phone_attractors_are_listed_and_one_is_loaded(visit: Visit) -> None:
    page = visit("?v=1&scene=sec2&f=893", viewport={"width": 390, "height": 844})
    box = opened(page).bounding_box()
    page.wait_for_function("document.documentElement.scrollWidth === 390")
    assert overflow(page) <= 0
    assert box is not None and box["x"] >= 0 and box["x"] + box["width"] <= 390 and box["height"] >= 150
    page.set_viewport_size({"width": 1280, "height": 800})
    page.evaluate("shown()")
    assert overflow(page) <= 0
    page.get_by_role("button", name="all attractors at this setting").click()
    rows = page.locator("#tabs .attractors tbody tr")
    expect(rows.first).to_be_visible(timeout=COMPILED)
    until(page, lambda: page.locator("#tabs .attractors").evaluate("""(one) => {
      const { top, bottom } = one.getBoundingClientRect(), room = document.getElementById("tabs").getBoundingClientRect();
      return top < room.bottom - 60 && bottom > room.top + 60;
    }"""))  # the list is below the map, and is brought onto the screen
    assert rows.count() == 3  # tests/attractor_search/test_attractors.py: rest, up and down end differently there
    irregular = rows.filter(has_text="quasi-periodic")
    expect(irregular).to_contain_text("Lyapunov exponent")
    expect(rows.first).to_contain_text(re.compile(r"\d % \(\d+ to \d+ %\)"))
    irregular.get_by_role("button", name="show").click()
    expect(page.locator("#foot")).to_contain_text("quasi-periodic")
    # a hidden map is not computed, and finished cells stay
    page.get_by_role("tab", name="regimes").click()
    expect(page.locator("#curve")).to_be_visible()
    page.get_by_role("tab", name="map", exact=True).click()
    until(page, lambda: len(source(page, "map", "cells").get("number", [])) > 0)
    expect(rows).to_have_count(3)
