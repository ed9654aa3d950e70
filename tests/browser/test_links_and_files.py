"""What enters and leaves the page: share links, other scenes, measured data, a saved picture."""

from __future__ import annotations

from pathlib import Path

import h5py
from knobs import Visit, field, knob, settled, type_into
from playwright.sync_api import expect


def test_a_shared_link_brings_the_picture_back(visit: Visit) -> None:
    page = visit()
    type_into(page, "f", "615.3")
    type_into(page, "D", "80")
    page.get_by_role("button", name="Link to this picture").click()
    page.wait_for_function("location.search.length > 1")
    query = page.evaluate("location.search")
    other = visit(query)
    assert (knob(other, "f"), knob(other, "D")) == ("615.3", "80")


def test_a_bad_field_of_a_link_is_told_and_the_others_count(visit: Visit) -> None:
    page = visit("?v=1&scene=sec2&f=615&D=lots")
    expect(page.get_by_role("alert")).to_contain_text("lots")
    assert knob(page, "f") == "615"


def test_another_scene_can_be_opened(visit: Visit) -> None:
    page = visit()
    page.locator("select.scene").select_option("fig3b")
    expect(field(page, "f")).to_have_value("1130")
    expect(page.locator("#foot b")).to_contain_text("period 3", timeout=20_000)


def test_measured_data_is_read_strictly(visit: Visit) -> None:
    page = visit("?v=1&scene=rig")
    page.get_by_role("tab", name="data").click()
    chosen = page.locator('input[type="file"]')
    good = b"frequency_Hz,force_N,error_N\n40,5.5,0.4\n60,12.1,0.6\n"
    chosen.set_input_files({"name": "mine.csv", "mimeType": "text/csv", "buffer": good})
    expect(page.locator("#tabs")).to_contain_text("2 points")
    bad = b"frequency_Hz,force_N\n40,5.5\n60,twelve\n"
    chosen.set_input_files({"name": "mine.csv", "mimeType": "text/csv", "buffer": bad})
    expect(page.get_by_role("alert")).to_contain_text("Line 3")
    # the largest file that is sent, in the characters that take most room in a message: refused, not disconnected
    chosen.set_input_files({"name": "no.csv", "mimeType": "text/csv", "buffer": b"\x01" * 2_000_000})
    expect(page.get_by_role("alert")).to_contain_text("Line 1", timeout=20_000)
    chosen.set_input_files({"name": "no.csv", "mimeType": "text/csv", "buffer": b"\x01" * 2_000_001})
    expect(page.get_by_role("alert")).to_contain_text("larger than 2 MB")


def test_a_tab_is_drawn_once_for_a_change_and_the_map_is_left_alone(visit: Visit) -> None:
    """The map keeps itself up to date by messages: drawn anew, it would lose what the pointer is on."""
    page = visit()
    page.get_by_role("tab", name="map").click()
    page.locator(".maphost").evaluate("host => { host.dataset.same = 1; }")
    page.locator("select.scene").select_option("rig")
    expect(field(page, "f")).to_have_value("60")
    page.evaluate("shown()")
    assert page.locator(".maphost").get_attribute("data-same") == "1"
    page.get_by_role("tab", name="data").click()
    page.locator("[role=tabpanel]").evaluate("""(body) => {
      window.drawn = 0;
      new MutationObserver((records) => { window.drawn += records.length; }).observe(body, { childList: true });
    }""")
    content = b"frequency_Hz,force_N\n40,5.5\n60,12.1\n"
    page.locator('input[type="file"]').set_input_files({"name": "mine.csv", "mimeType": "text/csv", "buffer": content})
    expect(page.locator("#tabs")).to_contain_text("2 points")
    assert page.evaluate("drawn") == 1


def test_the_picture_can_be_saved(visit: Visit, tmp_path: Path) -> None:
    page = visit()
    settled(page)
    with page.expect_download() as download:
        page.get_by_role("button", name="Save this picture").click()
    path = tmp_path / download.value.suggested_filename
    download.value.save_as(path)
    with h5py.File(path) as file:
        assert file["run/displacement"].shape[1] == 11
