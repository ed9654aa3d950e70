"""What somebody who sees the page for the first time reads off it: scales, the largest forces, which bead is which column."""

from __future__ import annotations

from knobs import Visit, settled, type_into
from playwright.sync_api import expect


def test_scales_and_the_largest_forces_are_said_where_they_are(visit: Visit) -> None:
    page = visit("?v=1&scene=sec2&f=850")
    settled(page)
    peaks = page.locator("#stage .peak")
    expect(peaks).to_have_text(["max 0.591 N", "max 0.237 N"])  # small on axes that end at the scene's largest
    scale = page.locator("#scale .segments button")
    expect(scale).to_have_text(["same scale for all f", "fit"])
    expect(page.locator("#scale .colours")).to_have_text("square-root scale 0 100 400 nJ", use_inner_text=True)
    time = "() => Bokeh.documents[0].get_model_by_name('input force').left[0].axis_label"
    assert page.evaluate(time) == "time (ms), 4 drive periods"  # an orbit of one period, repeated
    page.get_by_role("button", name="fit", exact=True).click()
    expect(scale).to_have_text(["same scale", "fitted to each picture"])
    expect(peaks).to_have_text(["max 591 mN", "max 237 mN"])
    type_into(page, "f", "1130")
    expect(peaks).to_have_text(["max 1.87 N", "max 1.12 N"])
    page.set_viewport_size({"width": 390, "height": 844})
    expect(page.get_by_text("√ scale")).to_be_visible()
