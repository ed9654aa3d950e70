"""Functions of the page's modules without the page: sliders, numbers, ticks, the map's cells, the chain's series."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from empty_page import ORIGIN, Answers
from playwright.sync_api import BrowserContext, Page

from app.format import prefixed
from app.frames import chain_series, drawn_values


@pytest.fixture(scope="module")
def blank(profile: BrowserContext) -> Iterator[Page]:
    """Yield a page for the modules."""
    page = profile.new_page()
    page.route(f"{ORIGIN}**", Answers())
    page.goto(ORIGIN)
    yield page
    page.close()


def called(page: Page, script: str, name: str, cases: list[Any]) -> list[Any]:
    """Call a function of a module with each list of arguments, and return the results."""
    return list(page.evaluate("""async ([script, name, cases]) => {
      const module = await import(`/${script}`);
      return cases.map((one) => module[name](...one));
    }""", [script, name, cases]))


@pytest.mark.parametrize(("scale", "low", "high", "middle"), [
    ("linear", 10.0, 30.0, 20.0), ("log", 1.0, 100.0, 10.0), ("cubic", 0.0, 8.0, 1.0)])
def test_a_slider_goes_from_place_to_value_and_back(blank: Page, scale: str, low: float, high: float, middle: float) -> None:
    values, places = blank.evaluate("""async ([scale, low, high]) => {
      const { RANGE } = await import("/parts/knobs/knob.js");
      const values = [0, 0.25, 0.5, 0.75, 1].map((place) => RANGE[scale].value(place, { low, high }));
      return [values, values.map((value) => RANGE[scale].place(value, { low, high }))];
    }""", [scale, low, high])
    assert places == pytest.approx([0.0, 0.25, 0.5, 0.75, 1.0])
    assert (values[0], values[2], values[-1]) == pytest.approx((low, middle, high))


#: A value in SI units, the factor of its unit, and the text of the field.
WRITTEN = [(340.0, 1.0, "340"), (0.0, 1.0, "0"), (5e-7, 1e-6, "0.5"), (1.23456789, 1.0, "1.23457"), (1e-4, 1.0, "1e-4"),
           (-2.5e-4, 1.0, "-2.5e-4"), (1234567.0, 1.0, "1.23457e6"), (193e9, 1e9, "193"), (0.1 + 0.2, 1.0, "0.3"),
           (999999.0, 1.0, "999999")]


def test_a_number_in_a_knobs_field_has_six_figures(blank: Page) -> None:
    assert called(blank, "parts/knobs/knob.js", "written", [case[:2] for case in WRITTEN]) == [case[2] for case in WRITTEN]
    assert called(blank, "parts/knobs/knob.js", "rounded", [[340.123], [0.00123456], [99999]]) == [340.1, 0.001235, 100000]


def test_ticks_are_round_and_inside(blank: Page) -> None:
    script = "parts/toolkit/round_numbers.js"
    assert called(blank, script, "ticks", [[0, 10, 5], [-1, 1, 4], [0.13, 0.47, 3], [0, 1e-9, 2], [20, 160, 5]]) == [
        [0, 2, 4, 6, 8, 10], [-1, -0.5, 0, 0.5, 1], [0.2, 0.4], [0, 5e-10, 1e-9], [50, 100, 150]]
    below = called(blank, script, "stepBelow", [[1], [7], [0.03], [9.99], [10], [450]])
    assert below == pytest.approx([1, 5, 0.02, 5, 10, 200])


def test_the_browser_takes_the_prefixes_that_the_server_takes(blank: Page) -> None:
    values = [0.0, 1e-19, 999.4e-18, 999.6e-9, 1e-6, 0.001, 0.9994, 0.9996, 1.0, 999.4, 999.6, 1e3, 4.2e6, 1e9, 1e12]
    found = called(blank, "parts/toolkit/round_numbers.js", "prefixed", [[value] for value in values])
    assert [letter for _, letter in found] == [prefixed(value)[1] for value in values]
    assert [factor for factor, _ in found] == pytest.approx([prefixed(value)[0] for value in values], rel=1e-12, abs=0.0)


def test_a_place_of_the_map_is_the_finest_cell_that_covers_it(blank: Page) -> None:
    """A map of 4 × 3 has the first cell of spacing 4, one of spacing 2 and one of spacing 1."""
    found = blank.evaluate("""async () => {
      const { MAP, cellAt, finest, valuesOf } = await import("/pages/map/map_state.js");
      const none = cellAt(0, 0, (MAP.head = { x: [10, 20, 30, 40], y: [1, 2, 3] }));
      MAP.cells.rows = { cells: { number: [0, 2, 5], spacing: [4, 2, 1] } };
      return [none, [[0, 0], [1, 1], [1, 3], [2, 3], [0, 3]].map(([i, j]) => cellAt(i, j)), finest([0, 1, 2]), valuesOf(2)];
    }""")
    assert found == [-1, [0, 2, 1, 0, 1], 2, {"x": 20, "y": 2}]


def test_errors_of_scripts_are_reported_and_no_more_than_a_few(blank: Page) -> None:
    reported = blank.evaluate("""async () => {
      const { watchScriptErrors } = await import("/parts/header/script_errors.js");
      const reported = [];
      watchScriptErrors((words) => reported.push(words));
      dispatchEvent(new ErrorEvent("error", { message: "ResizeObserver loop completed with undelivered notifications." }));
      dispatchEvent(new ErrorEvent("error", { message: "x is null", filename: "http://a.test/b/chain.js?v=1", lineno: 7 }));
      const rejected = new Promise((done) => addEventListener("unhandledrejection", done, { once: true }));
      Promise.reject(new Error("y".repeat(1000)));
      await rejected;
      for (let i = 0; i < 10; i++) dispatchEvent(new ErrorEvent("error", { message: "again" }));
      return reported;
    }""")
    assert reported[0] == "x is null (chain.js:7)"
    assert reported[1].startswith("unhandled rejection: Error: yyy") and len(reported[1]) == 400
    assert len(reported) == 5


def test_the_chain_is_unpacked_in_the_order_in_which_it_was_packed(blank: Page) -> None:
    """`chain_series` in app/frames.py and `unpack` in chain_series.js use the same order."""
    rows, beads = 3, 2
    widths = {"displacement": beads, "force": beads + 1, "energy": beads, "drive": 1}
    arrays = {name: 100.0 * number + np.arange(rows * width).reshape(rows, width)
              for number, (name, width) in enumerate(widths.items())}
    values = drawn_values(chain_series(*arrays.values()))
    found = blank.evaluate("""async ([rows, beads, list]) => {
      const { unpack } = await import("/parts/chain/chain_series.js");
      const { series, end } = unpack({ rows, beads, values: new Float32Array([-1, ...list]) }, 1);
      return [Object.entries(series).map(([name, values]) => [name, [...values]]), end];
    }""", [rows, beads, values.tolist()])
    assert found == [[[name, array.ravel().tolist()] for name, array in arrays.items()], 1 + len(values)]
