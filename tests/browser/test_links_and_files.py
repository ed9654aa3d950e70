"""Input to the page: share links, other scenes, measured data."""

from __future__ import annotations

from pathlib import Path

from knobs import COMPILED, Visit, addressed, field, knob, settled, type_into
from playwright.sync_api import Page, expect


def test_a_shared_link_brings_the_picture_back(visit: Visit) -> None:
    page = visit()
    type_into(page, "f", "615.3")
    type_into(page, "D", "80")
    page.get_by_role("button", name="Link to this picture").click()
    addressed(page, "f=615.3&D=80")
    query = page.evaluate("location.search")
    other = visit(query)
    assert (knob(other, "f"), knob(other, "D")) == ("615.3", "80")


def test_unknown_names_of_a_link_leave_the_address(visit: Visit) -> None:
    """Otherwise, a reload would report it again, and the theme would stay as it happened to be."""
    page = visit("?v=1&scene=sec2&tab=foo&page=bar&look=pink")
    expect(page.locator("#foot .sentence")).to_contain_text("bar")
    page.wait_for_function("!/foo|bar|look/.test(location.search)")


def test_the_address_follows_the_page_and_a_reload_keeps_everything(visit: Visit) -> None:
    page = visit()
    page.locator("select.scene").select_option("fig3b")
    expect(field(page, "f")).to_have_value("1130")
    expect(page.locator("#foot #regime")).to_contain_text("period 3")
    type_into(page, "f", "850")
    page.get_by_label("sweep down").click()
    expect(page.get_by_label("sweep down")).to_be_checked()
    page.get_by_role("button", name="fit", exact=True).click()
    page.locator("select.start").select_option("previous")
    page.get_by_role("button", name="Theme: ").click()
    page.get_by_role("tab", name="effects").click()
    addressed(page, "tab=effects&look=dark&curves=rest.down")
    page.evaluate("granchain.openOverlay('accuracy')")
    addressed(page, "page=accuracy")
    page.reload()
    page.wait_for_function("window.painted.length > 0")
    assert page.evaluate("granchain.overlay") == "accuracy"
    page.keyboard.press("Escape")
    expect(field(page, "f")).to_have_value("850")
    expect(page.locator("select.scene")).to_have_value("fig3b")
    expect(page.get_by_role("tab", name="effects")).to_have_attribute("aria-selected", "true")
    expect(page.get_by_label("sweep down")).to_be_checked()
    expect(page.get_by_label("sweep up")).not_to_be_checked()
    expect(page.get_by_role("button", name="fitted to each picture")).to_have_attribute("aria-pressed", "true")
    expect(page.locator("select.start")).to_have_value("previous")
    assert page.evaluate("document.documentElement.dataset.theme") == "dark"
    # away and back
    addressed(page, "page=")
    page.goto("about:blank")
    page.go_back()
    page.wait_for_function("window.painted?.length > 0")
    expect(field(page, "f")).to_have_value("850")


def test_a_link_omits_the_default_curves_of_its_scene(visit: Visit) -> None:
    page = visit("?v=1&scene=fig12-60")
    expect(page.get_by_label("paper’s features")).to_be_checked()
    page.wait_for_function("location.search === '?v=1&scene=fig12-60'")


def test_a_bad_field_of_a_link_is_reported_and_the_others_count(visit: Visit) -> None:
    page = visit("?v=1&scene=sec2&f=615&D=lots")
    expect(page.get_by_role("alert").filter(has_text="lots")).to_be_visible()
    assert knob(page, "f") == "615"


def test_missing_units_of_a_file_are_chosen_and_the_misfit_is_shown(visit: Visit, tmp_path: Path) -> None:
    page = visit()
    page.get_by_role("tab", name="data").click()
    chosen = page.locator('input[type="file"]')
    unclear = "A;B;remark\r\n0,340;600;a\r\n0,620;1150;b\r\n1,130;1000;c\r\n".encode("utf-16")
    chosen.set_input_files({"name": "odd.csv", "mimeType": "text/csv", "buffer": unclear})
    expect(page.locator("#tabs")).to_contain_text("What 'A' and 'B' and 'remark' hold is not clear")
    expect(page.locator("#tabs table")).to_contain_text("0,620")
    for number, quantity, unit in ((1, "frequency", "kHz"), (2, "force", "mN")):
        page.get_by_label(f"what column {number} contains").select_option(quantity)
        page.get_by_label(f"unit of column {number}").select_option(unit)
    page.get_by_role("button", name="Read with these settings").click()
    expect(page.locator("#tabs")).to_contain_text("3 points, 340 to 1130 Hz, force 0.6 to 1.15 N")
    expect(page.locator("#tabs")).to_contain_text("Model − measured at 3 of 3 frequencies: rms")
    with page.expect_download() as download:
        page.get_by_role("button", name="sample file").click()
    download.value.save_as(tmp_path / "sample.csv")
    chosen.set_input_files(tmp_path / "sample.csv")
    expect(page.locator("#tabs")).to_contain_text("means of up to 3 repeats with their extremes")
    is_read_strictly(page)


def is_read_strictly(page: Page) -> None:
    """Check that a bad line is named, and that a file too large to be sent is refused beforehand."""
    chosen = page.locator('input[type="file"]')
    good = b"frequency_Hz,force_N,error_N\n40,5.5,0.4\n60,12.1,0.6\n"
    chosen.set_input_files({"name": "mine.csv", "mimeType": "text/csv", "buffer": good})
    expect(page.locator("#tabs")).to_contain_text("2 points")
    bad = b"frequency_Hz,force_N\n40,5.5\n60,twelve\n"
    chosen.set_input_files({"name": "mine.csv", "mimeType": "text/csv", "buffer": bad})
    expect(page.get_by_role("alert").filter(has_text="Line 3")).to_be_visible()
    # the largest file that is sent, with the characters that take most space in a message: refused, not disconnected
    chosen.set_input_files({"name": "no.csv", "mimeType": "text/csv", "buffer": b"\x01" * 2_000_000})
    expect(page.get_by_role("alert").filter(has_text="Line 1")).to_be_visible()
    chosen.set_input_files({"name": "no.csv", "mimeType": "text/csv", "buffer": b"\x01" * 2_000_001})
    expect(page.get_by_role("alert").filter(has_text="larger than 2 MB")).to_be_visible()


def test_a_virtual_experiment_lies_over_the_trains_until_it_is_removed(visit: Visit) -> None:
    page = visit("?v=1&scene=sec2&f=1130")
    settled(page)
    page.get_by_role("tab", name="data").click()
    page.get_by_role("button", name="virtual experiment").click()
    expect(page.locator("#tabs")).to_contain_text("virtual experiment, nothing measured", timeout=COMPILED)
    expect(page.locator("#tabs")).to_contain_text("rms difference from the model", timeout=COMPILED)
    page.get_by_role("button", name="remove").click()
    expect(page.locator("#tabs")).not_to_contain_text("virtual experiment, nothing measured")


def test_a_tab_is_drawn_once_for_a_change_and_the_map_is_left_alone(visit: Visit) -> None:
    """The map updates itself by messages; if it were redrawn, it would lose the element under the pointer."""
    page = visit()
    page.wait_for_selector(".peak-names button", timeout=COMPILED)  # the curve is complete: nothing else changes the tab
    page.get_by_role("tab", name="data").click()
    page.locator("[role=tabpanel]").evaluate("""(body) => {
      window.drawn = 0;
      new MutationObserver((records) => { window.drawn += records.length; }).observe(body, { childList: true });
    }""")
    content = b"frequency_Hz,force_N\n340,0.6\n1130,1.1\n"
    page.locator('input[type="file"]').set_input_files({"name": "mine.csv", "mimeType": "text/csv", "buffer": content})
    expect(page.locator("#tabs")).to_contain_text("Model − measured")
    type_into(page, "f", "341")  # all effects of the file arrive before the answer to this
    settled(page)
    assert page.evaluate("drawn") == 1
    page.get_by_role("tab", name="map").click()
    page.locator(".maphost").evaluate("host => { host.dataset.same = 1; }")
    page.locator("select.scene").select_option("rig")
    expect(field(page, "f")).to_have_value("60")
    settled(page)
    assert page.locator(".maphost").get_attribute("data-same") == "1"
