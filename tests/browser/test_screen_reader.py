"""The page's content for screen readers."""

from __future__ import annotations

from knobs import COMPILED, Visit, settled, type_into
from playwright.sync_api import expect


def test_the_pictures_are_described_in_words_and_tables(visit: Visit) -> None:
    page = visit("?v=1&scene=sec2&f=850")
    settled(page)
    summary = page.locator("#summary")
    expect(summary).to_contain_text("At 850 Hz: period 1")
    expect(summary).to_contain_text("591 mN, and at most 237 mN arrive at the wall, 0.401 times as much. Bead 1 has the most")
    expect(page.locator("main")).to_have_attribute("aria-describedby", "summary")
    expect(page.locator("#announced")).to_contain_text("period 1")
    page.get_by_role("tab", name="numbers").click()
    rows = page.locator("#tabs .numbers tbody tr")
    expect(rows).to_have_count(25)
    page.get_by_label("which table").select_option("beads")
    expect(rows).to_have_count(11)
    type_into(page, "f", "340")
    expect(summary).to_contain_text("arrive at the wall, 0.901 times as much")
    page.wait_for_selector(".peak-names button", timeout=COMPILED)
    page.get_by_label("which table").select_option("curve")
    assert rows.count() > 75
    expect(rows.first).to_contain_text("mN")
