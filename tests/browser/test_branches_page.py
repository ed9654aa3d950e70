"""The Branches page as a visitor sees it: a branch grows, describes its orbits, stops, continues, and loads one."""

from __future__ import annotations

import re

import pytest
from bokeh_figures import hover, place, source
from knobs import COMPILED, Visit, field
from playwright.sync_api import Locator, Page, expect
from server import at_rest, resize, until

#: A short chain whose branch takes seconds.
SHORT = "?v=1&scene=sec2&f=2000&N=3"
#: The kinds of special points found; the number of orbits in the large figure; the orbits of an arm.
SPECIAL = ("['fold', 'period_doubling', 'neimark_sacker', 'grazing']"
           ".filter((kind) => granchain.pages.get('branches').data.rows[kind]?.x.length)")
COUNT = '(figures.view("branches", true)?.model.document?.get_model_by_name("orbits")?.data.x ?? []).length'
ORBITS = "granchain.pages.get('branches').data.rows.orbits"


def opened(page: Page) -> Locator:
    """Open the Branches page from its tab."""
    page.get_by_role("tab", name="branches").click()
    page.locator("#tabs").get_by_role("button", name="open the page").click()
    return page.locator('[data-overlay="branches"]')


def stop(sheet: Locator) -> None:
    """Stop the computation of the branch; if it is already complete, the button is hidden and a click has no effect."""
    expect(sheet.get_by_role("button", name=re.compile("^(stop|follow from here)$")).first).to_be_visible()
    sheet.locator("button:text-is('stop')").first.evaluate("one => one.click()")
    expect(sheet.get_by_role("button", name="follow from here")).to_be_visible()


def followed(page: Page) -> Locator:
    """Return the page with a branch that has a special point; the branch starts automatically."""
    sheet = opened(page)
    page.wait_for_function(f"{SPECIAL}.length > 0", timeout=COMPILED)
    until(page, lambda: len(source(page, "branches", "orbits").get("x", [])) > 1)
    return sheet


def grows_without_being_made_anew(page: Page) -> None:
    """Check that the figure takes new orbits as they arrive; another theme is a new figure with the same points."""
    grown = f"() => {COUNT} > %d"
    # in braces, so that it has no value: Playwright would take half a minute to serialize the document
    page.evaluate("{ window.kept = granchain.pages.get('branches').figures[0].document }")
    before = page.evaluate(COUNT)
    page.wait_for_function(grown % (before + 5), polling=100)
    assert page.evaluate("kept === granchain.pages.get('branches').figures[0].document")
    page.evaluate("granchain.theme.next()")
    page.wait_for_function("granchain.pages.get('branches').figures[0].document"
                           " && kept !== granchain.pages.get('branches').figures[0].document")
    page.wait_for_function(grown % (before + 5), polling=100)


@pytest.mark.long
def test_a_branch_grows_is_stopped_and_goes_on(visit: Visit) -> None:
    page = visit()
    expect(page.get_by_role("button", name="asked")).to_contain_text("reached")
    sheet = followed(page)
    expect(sheet).to_contain_text("now at")
    grows_without_being_made_anew(page)
    page.wait_for_function(f"{SPECIAL}.length > 1 && {ORBITS}.stable.some((one) => !one)")
    sheet.get_by_role("button", name="stop").click()
    expect(sheet).to_contain_text("stopped; the orbits found so far are kept")
    arms = at_rest(page, f"{ORBITS}.arm")
    assert min(arms.count(arm) for arm in (0, 1)) > 1 and set(arms) == {0, 1}
    sheet.get_by_role("button", name="continue").click()
    page.wait_for_function(f"{ORBITS}?.arm.filter((arm) => arm === 0).length > {arms.count(0) + 5}")
    sheet.get_by_role("button", name="stop").click()
    # the figure has everything that the page was sent piece by piece, and so does the small one in its tab
    for kind in ("stable", "unstable"):
        assert len(source(page, "branches", kind)["x"]) == page.evaluate(f"granchain.pages.get('branches').data.lines.{kind}.x.length") > 0
    page.keyboard.press("Escape")
    until(page, lambda: source(page, "branches", "orbits", large=False).get("x") == source(page, "branches", "orbits")["x"])


def test_a_link_to_the_page_starts_a_branch_over_the_resonance_curve(visit: Visit) -> None:
    page = visit(f"{SHORT}&page=branches")
    sheet = page.locator('[data-overlay="branches"]')
    page.wait_for_function(f"{ORBITS}?.x.length > 3", timeout=COMPILED)
    until(page, lambda: len(source(page, "branches", "curve").get("x", [])) > 50)
    curve = source(page, "branches", "curve")
    assert curve["x"] == sorted(curve["x"])
    # the settled motion is on the curve and on the branch: the same force, in the same unit
    row = min(range(len(curve["x"])), key=lambda i: abs(curve["x"][i] - 2000))
    orbits = at_rest(page, ORBITS)
    near = min(range(len(orbits["x"])), key=lambda i: abs(orbits["x"][i] - curve["x"][row]))
    assert orbits["y"][near] == pytest.approx(curve["y"][row], rel=0.05)  # neighbours on a grid of about 40 Hz
    stop(sheet)
    # another chain has another curve, and greys the branch; nothing starts again automatically
    damping = field(page, "D")
    damping.fill("90")
    damping.press("Enter")
    expect(sheet.locator(".stale")).to_be_visible()
    assert source(page, "branches", "curve") == curve


def test_an_irregular_motion_is_reported_to_lie_on_no_branch(at: Visit) -> None:
    page = at("?v=1&scene=sec2&f=1750&page=branches")
    sheet = page.locator('[data-overlay="branches"]')
    expect(sheet).to_contain_text("is on no branch", timeout=COMPILED)
    expect(sheet.get_by_role("button", name="follow from here")).to_be_visible()
    until(page, lambda: len(source(page, "branches", "curve").get("x", [])) > 50)


def test_hovering_shows_an_orbit_and_a_click_loads_it(visit: Visit) -> None:
    page = visit("?v=1&scene=sec2&f=250")
    expect(page.get_by_role("button", name="asked")).to_contain_text("reached")
    sheet = opened(page)
    stop(sheet)
    sheet.get_by_label("period of the orbits").select_option("1")
    sheet.get_by_role("button", name="follow from here").click()
    page.wait_for_function(f"{ORBITS} && {SPECIAL}.includes('period_doubling')"
                           f" && {ORBITS}.stable.filter((one, i) => !one && !{ORBITS}.arm[i]).length > 5", timeout=COMPILED)
    sheet.get_by_role("button", name="stop").click()
    expect(sheet).to_contain_text("stopped; the orbits found so far are kept")

    sheet.get_by_role("button", name="zoom in").click()  # next to the whole curve, the orbits are close together

    def at(name: str, row: int) -> tuple[float, float]:
        columns = source(page, "branches", name)
        return place(page, "branches", columns["x"][row], columns["y"][row])

    hover(page, lambda: at("period_doubling", 0), "period doubling at 255.79", "±")
    page.mouse.click(*at("period_doubling", 0))
    expect(sheet.locator(".chosen")).to_contain_text(re.compile(r"period doubling at 255\.(79|80)"))
    expect(sheet.get_by_role("button", name="follow the doubled branch")).to_be_visible()
    # an unstable orbit runs live, a stable one is settled, each at its own frequency
    for stable, words, regime in ((0, "live on the main page", "live, drive period"), (1, "settled on the main page", "period 1")):
        row = page.evaluate(LONELY, stable)
        frequency = source(page, "branches", "orbits")["x"][row]
        hover(page, lambda row=row: at("orbits", row), "elastic output force")
        page.wait_for_timeout(600)  # Bokeh takes two clicks within 300 ms for a double click, wherever they are
        page.mouse.click(*at("orbits", row))
        expect(sheet.locator(".chosen")).to_contain_text(words)
        expect(page.locator("#foot")).to_contain_text(regime)
        shown = field(page, "f").input_value()
        assert float(shown) == pytest.approx(frequency, rel=1e-5)  # six digits are written


#: The orbit that is farthest from all special points, so that a click on it is unambiguous.
LONELY = """(stable) => {
  const { orbits, curve, ...rows } = granchain.pages.get('branches').data.rows;
  const special = Object.values(rows).flatMap(({ x }) => x);
  const far = (f) => Math.min(...special.map((one) => Math.abs(one - f)));
  return orbits.x.map((f, row) => [orbits.stable[row] === stable ? far(f) : -1, row]).sort((a, b) => b[0] - a[0])[0][1];
}"""


def test_the_page_fits_and_moved_knobs_grey_the_branch(visit: Visit) -> None:
    page = visit(SHORT, viewport={"width": 390, "height": 844})
    expect(page.get_by_role("button", name="asked")).to_contain_text("reached")
    sheet = followed(page)
    assert source(page, "branches", "stable")["x"]
    for width, height in ((390, 844), (1280, 800)):
        resize(page, width, height)
        box = sheet.locator(".work .figure").bounding_box()
        assert box is not None and box["x"] >= 0 and box["x"] + box["width"] <= width and box["height"] > 200
    stop(sheet)
    damping = field(page, "D")
    damping.fill("90")
    damping.press("Enter")
    expect(sheet.locator(".stale")).to_be_visible()
    expect(sheet).to_contain_text("these orbits belong to another chain")
    damping.fill("100")
    damping.press("Enter")
    expect(sheet.locator(".stale")).to_have_count(0)


def test_a_chain_without_an_orbit_of_the_period_is_reported_in_a_sentence(at: Visit) -> None:
    page = at("?v=1&scene=rig&f=140&k=0")
    sheet = opened(page)
    stop(sheet)
    sheet.get_by_label("period of the orbits").select_option("1")
    sheet.get_by_role("button", name="follow from here").click()
    expect(sheet.locator(".warn")).to_contain_text("found no orbit of 1 drive periods", timeout=COMPILED)
    expect(sheet.get_by_role("button", name="follow from here")).to_be_visible()
