"""The Branches page as a visitor meets it: a branch grows, tells its orbits, is stopped, gone on with, and loads one."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest
from playwright.sync_api import Locator, Page, expect
from started import until

Visit = Callable[..., Page]
#: Long enough for a first visit that has to compile the kernels of branches, on a machine that runs tests.
COMPILED = 150_000
#: A short chain whose branch is followed in seconds.
SHORT = "?v=1&scene=sec2&f=2000&N=3"


def opened(page: Page) -> Locator:
    """The Branches page, opened from its tab in the corner."""
    page.get_by_role("tab", name="branches").click()
    page.locator("#corner").get_by_role("button", name="open the page").click()
    sheet = page.locator('[data-cover="branches"]')
    expect(sheet.get_by_role("button", name="follow from here")).to_be_visible()
    return sheet


def followed(page: Page) -> Locator:
    """The page with a branch that has a special point."""
    sheet = opened(page)
    sheet.get_by_role("button", name="follow from here").click()
    expect(sheet.locator(".special").first).to_be_visible(timeout=COMPILED)
    return sheet


def test_a_branch_grows_is_stopped_and_goes_on(visit: Visit) -> None:
    page = visit()
    expect(page.get_by_role("button", name="asked")).to_contain_text("reached", timeout=20_000)
    sheet = followed(page)
    expect(sheet).to_contain_text("now at")
    page.wait_for_function("new Set(granchain.branches.special.map((one) => one.kind)).size > 1"
                           " && granchain.branches.arms.some((arm) => arm.orbits.some((orbit) => !orbit[2]))", timeout=60_000)
    sheet.get_by_role("button", name="stop").click()
    expect(sheet).to_contain_text("stopped; what was found stays", timeout=1500)
    orbits = page.evaluate("granchain.branches.arms.map((arm) => arm.orbits.length)")
    page.wait_for_timeout(700)
    assert page.evaluate("granchain.branches.arms.map((arm) => arm.orbits.length)") == orbits
    assert len(orbits) == 2 and min(orbits) > 1
    sheet.get_by_role("button", name="continue").click()
    page.wait_for_function(f"granchain.branches.arms[0]?.orbits.length > {orbits[0] + 5}", timeout=20_000)
    sheet.get_by_role("button", name="stop").click()
    expect(sheet.locator("path.stable").first).to_be_attached()
    expect(sheet.locator("path.unstable").first).to_be_attached()
    expect(sheet.locator("path.unstable").first).to_have_css("stroke-dasharray", re.compile(r"\d"))
    assert len(set(sheet.locator(".special").evaluate_all("all => all.map((one) => one.dataset.kind)"))) >= 2
    # the small version in the corner shows the same
    page.keyboard.press("Escape")
    expect(page.locator("#corner path.stable").first).to_be_attached()


def test_hover_tells_and_a_click_loads_orbits_stable_and_unstable(visit: Visit) -> None:
    page = visit("?v=1&scene=sec2&f=250")
    expect(page.get_by_role("button", name="asked")).to_contain_text("reached", timeout=20_000)
    sheet = opened(page)
    sheet.get_by_label("period of the orbits").select_option("1")
    sheet.get_by_role("button", name="follow from here").click()
    page.wait_for_function("[0, 1].every((stable) => granchain.branches?.arms[0]?.orbits.some((o) => o[2] === stable))", timeout=COMPILED)
    page.wait_for_function("granchain.branches.special.some((one) => one.kind === 'period_doubling')"
                           " && granchain.branches.arms[0].orbits.filter((orbit) => !orbit[2]).length > 5", timeout=60_000)
    sheet.get_by_role("button", name="stop").click()
    expect(sheet).to_contain_text("stopped; what was found stays")

    def tip_comes() -> bool:
        """The last of the branch is still drawn, every mark anew, so one hover may be lost."""
        page.mouse.move(0, 0)
        sheet.locator('.special[data-kind="period_doubling"]').first.hover(force=True)
        return sheet.locator(".tip").is_visible()

    until(page, tip_comes)
    expect(sheet.locator(".tip")).to_contain_text(re.compile(r"period doubling at 255\.(79|80)"))
    expect(sheet.locator(".tip")).to_contain_text("±")
    sheet.locator('.special[data-kind="period_doubling"]').first.click(force=True)
    expect(sheet.get_by_role("button", name="follow the doubled branch")).to_be_visible()
    # an unstable orbit runs live, a stable one is settled, each at its own frequency
    sheet.get_by_label("grazings").uncheck()
    for stable, words, regime in ((0, "live on the main page", "live, drive period"), (1, "settled on the main page", "period 1")):
        place = page.evaluate(LONELY, stable)
        frequency = page.evaluate(f"granchain.branches.arms[0].orbits[{place}][0]")
        sheet.locator(f'.orbit[data-arm="0"][data-place="{place}"]').click(force=True)
        expect(sheet.locator(".chosen")).to_contain_text(words)
        expect(page.locator("#foot")).to_contain_text(regime, timeout=15_000)
        shown = page.locator('[data-knob="f"] input[type="text"]').input_value()
        assert float(shown) == pytest.approx(frequency, rel=1e-5)  # six figures are written


#: The orbit of the first arm that is farthest from all special points, so that a click means it and no other.
LONELY = """(stable) => {
  const { arms, special } = granchain.branches;
  const far = (orbit) => Math.min(...special.map((one) => Math.abs(one.f - orbit[0])));
  return arms[0].orbits.map((orbit, place) => [orbit[2] === stable ? far(orbit) : -1, place]).sort((a, b) => b[0] - a[0])[0][1];
}"""


def test_moved_knobs_grey_the_branch_and_say_so(visit: Visit) -> None:
    page = visit(SHORT)
    expect(page.get_by_role("button", name="asked")).to_contain_text("reached", timeout=20_000)
    sheet = followed(page)
    sheet.get_by_role("button", name="stop").click()
    field = page.locator('[data-knob="D"] input[type="text"]')
    field.fill("90")
    field.press("Enter")
    expect(sheet.locator(".stale")).to_be_visible()
    expect(sheet).to_contain_text("these orbits are another chain's")
    field.fill("100")
    field.press("Enter")
    expect(sheet.locator(".stale")).to_have_count(0)


def test_a_chain_without_such_an_orbit_is_told_in_a_sentence(visit: Visit) -> None:
    page = visit("?v=1&scene=rig&f=140&k=0")
    sheet = opened(page)
    sheet.get_by_label("period of the orbits").select_option("1")
    sheet.get_by_role("button", name="follow from here").click()
    expect(sheet.locator(".warn")).to_contain_text("found no orbit of 1 drive periods", timeout=COMPILED)
    expect(sheet.get_by_role("button", name="follow from here")).to_be_visible()


@pytest.mark.parametrize("size", [(1280, 800), (390, 844)])
def test_the_page_fits(visit: Visit, size: tuple[int, int]) -> None:
    page = visit(SHORT, viewport={"width": size[0], "height": size[1]})
    sheet = followed(page)
    assert page.evaluate("document.documentElement.scrollWidth") == size[0]
    box = sheet.locator(".work .picture").bounding_box()
    assert box is not None and box["x"] >= 0 and box["x"] + box["width"] <= size[0] and box["height"] > 200
