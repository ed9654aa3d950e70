"""The Map tab as a visitor meets it: it fills coarse first, tells values, a click sets f and A0, attractors are shown."""

from __future__ import annotations

from collections.abc import Callable

from playwright.sync_api import Locator, Page, expect

Visit = Callable[..., Page]
#: Long enough for a first visit that has to compile kernels, on a machine that runs tests.
COMPILED = 150_000
#: A short chain far up: its diagram is there in a second or two.
SMALL = "?v=1&scene=sec2&N=2"


def opened(page: Page, large: bool = True) -> Locator:
    """The tab with its picture."""
    page.get_by_role("tab", name="map", exact=True).click()
    if large:
        page.get_by_title("Larger, over the curve").click()
    picture = page.locator("#corner canvas[role=img]")
    expect(picture).to_be_visible()
    expect(page.locator("#corner .maplegend")).to_contain_text("largest output force", timeout=COMPILED)
    return picture


def colours(picture: Locator) -> int:
    """How many different colours are in the picture."""
    return int(picture.evaluate("""canvas => {
        const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height), found = new Set();
        for (let i = 0; i < data.length; i += 4) found.add(data[i] << 16 | data[i + 1] << 8 | data[i + 2]);
        return found.size;
    }"""))


def knob(page: Page, name: str) -> Locator:
    """The field of a knob."""
    return page.locator(f'[data-knob="{name}"] input[type="text"]')


def overflow(page: Page) -> int:
    """Pixels by which the tab is wider than its place."""
    return int(page.locator("#corner .body").evaluate("body => body.scrollWidth - body.clientWidth"))


def test_the_diagram_fills_tells_and_is_clicked(visit: Visit) -> None:
    page = visit(SMALL)
    picture = opened(page)
    expect(page.locator('#corner .maphost[data-done="1"]')).to_be_visible(timeout=COMPILED)  # complete
    assert colours(picture) > 20
    page.get_by_role("button", name="regime", exact=True).click()
    expect(page.locator("#corner .maplegend")).to_contain_text("period 1")
    hatches = page.locator("#corner .maplegend .swatch").evaluate_all("""all => all.map((canvas) => {
        const { data } = canvas.getContext("2d").getImageData(0, 0, 16, 16);
        const light = Array.from({ length: 256 }, (_, i) => data[4 * i] + data[4 * i + 1] + data[4 * i + 2]);
        return light.map((one) => (one < 0.8 * Math.max(...light) ? 1 : 0)).join("");
    })""")
    assert len(set(hatches)) == len(hatches) > 3  # the hatch alone tells regimes apart

    box = picture.bounding_box()
    assert box is not None
    x, y = box["x"] + 0.7 * box["width"], box["y"] + 0.4 * box["height"]
    page.mouse.move(x, y)
    tip = page.locator("#corner .maptip")
    for words in ("Hz", "m: ", "N"):
        expect(tip).to_contain_text(words)
    said = float(tip.inner_text().split(" Hz")[0])
    before = knob(page, "f").input_value(), knob(page, "A0").input_value()
    page.mouse.click(x, y)
    expect(knob(page, "f")).not_to_have_value(before[0], timeout=5000)
    expect(knob(page, "A0")).not_to_have_value(before[1], timeout=5000)
    assert abs(float(knob(page, "f").input_value()) - said) < 1.0  # four figures are told
    assert 1500.0 < said < 2600.0

    picture.focus()
    picture.press("ArrowRight")
    first = tip.inner_text()
    picture.press("ArrowUp")
    assert tip.inner_text() != first
    chosen = float(tip.inner_text().split(" Hz")[0])
    was = knob(page, "f").input_value()
    picture.press("Enter")
    expect(knob(page, "f")).not_to_have_value(was, timeout=5000)
    assert abs(float(knob(page, "f").input_value()) - chosen) < 1.0

    knob(page, "D").fill("60")  # another chain has another diagram
    knob(page, "D").press("Enter")
    expect(page.locator("#corner .maphost.stale")).to_be_visible(timeout=5000)
    expect(page.locator("#corner .maphost.stale")).to_have_count(0, timeout=20_000)


def test_attractors_are_listed_and_one_is_loaded(visit: Visit) -> None:
    page = visit("?v=1&scene=sec2&f=893")
    opened(page, large=False)
    assert overflow(page) <= 0
    page.get_by_role("button", name="all attractors at this setting").click()
    rows = page.locator("#corner .attractors tbody tr")
    expect(rows.first).to_be_visible(timeout=COMPILED)
    assert rows.count() == 3  # tests/diagram/test_attractors.py: rest, up and down end differently there
    irregular = rows.filter(has_text="quasi-periodic")
    expect(irregular).to_contain_text("Lyapunov exponent")
    expect(rows.first).to_contain_text("±")
    irregular.get_by_role("button", name="show").click()
    expect(page.locator("#foot")).to_contain_text("quasi-periodic", timeout=20_000)
    # what is not looked at is not computed, and what there is stays
    page.get_by_role("tab", name="regimes").click()
    page.get_by_role("tab", name="map", exact=True).click()
    expect(page.locator("#corner .maplegend")).to_contain_text("largest output force")
    expect(rows).to_have_count(3)


def test_the_tab_fits_a_phone(visit: Visit) -> None:
    page = visit(SMALL, viewport={"width": 390, "height": 844})
    box = opened(page, large=False).bounding_box()
    assert page.evaluate("document.documentElement.scrollWidth") == 390 and overflow(page) <= 0
    assert box is not None and box["x"] >= 0 and box["x"] + box["width"] <= 390 and box["height"] >= 150
