"""The Accuracy page as a visitor meets it: points appear, a measurement is cancelled, a moved knob greys it."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from playwright.sync_api import Locator, Page, expect

Visit = Callable[..., Page]
#: Long enough for a first visit that has to compile every method, on a machine that runs tests.
COMPILED = 120_000


def type_into(page: Page, name: str, text: str) -> None:
    """Type a value and press Enter."""
    field = page.locator(f'[data-knob="{name}"] input[type="text"]')
    field.fill(text)
    field.press("Enter")


def opened(page: Page) -> Locator:
    """The Accuracy page, opened from the badge, with its first points."""
    page.get_by_role("button", name="asked").click()
    sheet = page.locator('[data-cover="accuracy"]')
    expect(sheet.locator(".point").first).to_be_visible(timeout=COMPILED)
    return sheet


def test_the_badge_says_asked_reached_and_how_long(visit: Visit) -> None:
    page = visit()
    badge = page.get_by_role("button", name="asked")
    expect(badge).to_contain_text("asked 1e-6 · reached", timeout=20_000)
    type_into(page, "accuracy", "1e-9")
    expect(badge).to_contain_text("asked 1e-9 · reached", timeout=20_000)
    words = badge.inner_text().split(" · ")
    assert float(words[1].removeprefix("reached ")) <= 1e-9
    assert words[2].endswith((" ms", " s"))


def test_points_appear_and_the_cheapest_way_is_told(visit: Visit) -> None:
    page = visit()
    sheet = opened(page)
    expect(sheet.get_by_role("button", name="measure again")).to_be_visible(timeout=COMPILED)
    assert sheet.locator(".work .point").count() > 30
    methods = {point.get_attribute("data-way") for point in sheet.locator(".work .point").all()}
    assert {"rk4", "rk4-split", "rk4-naive", "verlet-naive", "dop853", "scipy LSODA"} <= methods
    expect(sheet).to_contain_text("The cheapest way to 1e-6 is")
    expect(sheet).to_contain_text("Two independent references agree to")
    expect(sheet.locator("circle.cheapest")).to_be_visible()
    expect(sheet.locator("rect.now")).to_be_visible()
    # another accuracy: other words, no new measurement, and nothing is greyed
    type_into(page, "accuracy", "1e-3")
    expect(sheet).to_contain_text("The cheapest way to 1e-3 is")
    expect(sheet.get_by_role("button", name="cancel")).to_be_hidden()
    expect(sheet.locator(".stale")).to_have_count(0)
    rows = sheet.locator("tbody tr")
    expect(rows.filter(has_text="rk4-split")).to_contain_text("two changes of one contact")
    expect(rows.filter(has_text="dop853").first).to_contain_text("Hairer")
    # hovering tells the point
    sheet.locator('.work .point[data-way="rk4-split"]').first.hover(force=True)
    tip = sheet.locator(".tip")
    for words in ("live steps", "error", "s, ", "evaluations", "order 3.9"):
        expect(tip).to_contain_text(words)


def test_a_measurement_is_cancelled_and_its_points_stay(visit: Visit) -> None:
    page = visit("?v=1&scene=rig")
    sheet = opened(page)
    sheet.get_by_role("button", name="cancel").click()
    expect(sheet).to_contain_text("cancelled", timeout=10_000)
    expect(sheet.get_by_role("button", name="measure again")).to_be_visible()
    count = sheet.locator(".work .point").count()
    page.wait_for_timeout(1500)
    assert sheet.locator(".work .point").count() == count > 0
    # the next one begins: the cancelled one, which would take minutes, has really ended
    sheet.get_by_role("button", name="measure again").click()
    expect(sheet).to_contain_text("measuring", timeout=10_000)


def test_a_moved_knob_greys_the_picture_until_it_is_measured_again(visit: Visit) -> None:
    page = visit("?v=1&scene=sec2&f=2000")
    sheet = opened(page)
    expect(sheet.get_by_role("button", name="measure again")).to_be_visible(timeout=COMPILED)
    type_into(page, "D", "90")
    expect(sheet.locator(".stale")).to_be_visible()
    expect(sheet).to_contain_text("measured for another chain")
    type_into(page, "D", "100")
    expect(sheet.locator(".stale")).to_have_count(0)
    type_into(page, "D", "80")
    sheet.get_by_role("button", name="measure again").click()
    expect(sheet.locator(".stale")).to_have_count(0)
    expect(sheet.locator(".point").first).to_be_visible(timeout=COMPILED)
    sheet.get_by_role("button", name="cancel").click()


def test_the_naive_force_is_drawn_over_the_certified_one(visit: Visit) -> None:
    page = visit()
    sheet = opened(page)
    expect(sheet.locator("path.certified")).to_be_visible()
    expect(sheet.locator("path.naive")).to_be_visible()
    dashes = sheet.locator("path.naive").evaluate("path => getComputedStyle(path).strokeDasharray")
    assert dashes not in ("none", "")
    said = sheet.locator(".lesson p")
    expect(said).to_contain_text("With 200 steps a period the force is off by")
    first = said.inner_text()
    sheet.get_by_label("its steps in a drive period").select_option("2000")
    expect(said).to_contain_text("With 2000 steps")
    assert said.inner_text() != first


def test_steps_that_blow_up_are_told(visit: Visit) -> None:
    page = visit("?v=1&scene=rig")
    sheet = opened(page)
    sheet.get_by_label("its steps in a drive period").select_option("100")
    expect(sheet.locator(".lesson p")).to_contain_text("nothing would have been drawn")
    expect(sheet.locator("path.naive")).to_have_count(0)
    sheet.get_by_role("button", name="cancel").click()


def test_the_corner_has_a_small_one_that_opens_the_page(visit: Visit) -> None:
    page = visit("?v=1&scene=sec2&f=2000")
    page.get_by_role("tab", name="accuracy").click()
    expect(page.locator("#corner .point").first).to_be_visible(timeout=COMPILED)
    expect(page.locator("#corner")).to_contain_text("The cheapest way to", timeout=COMPILED)
    page.get_by_role("button", name="open the page").click()
    expect(page.locator("#cover .work .point").first).to_be_visible()
    page.keyboard.press("Escape")
    expect(page.locator("#cover")).to_be_hidden()


@pytest.mark.parametrize("size", [(1280, 800), (1920, 1080), (390, 844)])
def test_the_page_fits(visit: Visit, size: tuple[int, int]) -> None:
    page = visit(viewport={"width": size[0], "height": size[1]})
    sheet = opened(page)
    assert page.evaluate("document.documentElement.scrollWidth") == size[0]
    box = sheet.locator(".work .picture").bounding_box()  # the drawing in it is replaced with every point
    assert box is not None and box["x"] >= 0 and box["x"] + box["width"] <= size[0] and box["height"] > 200
    sheet.get_by_role("button", name="cancel").click()
