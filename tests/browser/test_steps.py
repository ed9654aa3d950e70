"""Undo and redo, pins, exports, and the page in a frame."""

from __future__ import annotations

import re
from pathlib import Path

import h5py
from knobs import COMPILED, Visit, addressed, field, settled, type_into
from layout_faults import faults
from PIL import Image
from playwright.sync_api import Page, expect
from server import until

# Numbers of points in the lines of pins in a figure, which are behind all others.
PINNED = """(name) => figures.model(name).renderers
  .filter((one) => one.level === "underlay")
  .map((one) => (one.data_source.data.force ?? []).length)"""

#: The evidence behind it is hidden if there is no room, for example on a busy machine with longer times.
PERIOD_1 = re.compile(r"period 1(,|$)")


def step(page: Page, fields: str) -> None:
    """Wait until the address has followed with a step of the history."""
    addressed(page, fields)
    page.wait_for_function("!granchain.steps.returning")


def test_undo_and_redo_go_through_everything_a_visitor_does(visit: Visit) -> None:
    page = visit()
    undo, redo = (page.get_by_role("button", name=name) for name in ("Undo (Ctrl-Z)", "Redo (Ctrl-Shift-Z)"))
    expect(undo).to_be_disabled()
    type_into(page, "f", "615.3")
    step(page, "f=615.3")
    page.get_by_role("button", name="fit", exact=True).click()
    step(page, "scale=fit")
    page.get_by_role("tab", name="effects").click()
    step(page, "tab=effects")
    page.get_by_role("button", name="Theme: ").click()
    step(page, "look=dark")
    page.locator("select.scene").select_option("rig")
    step(page, "scene=rig")
    expect(redo).to_be_disabled()
    for fields in ("scene=sec2&look=dark", "look=&tab=effects", "tab=&scale=fit"):
        page.keyboard.press("Control+z")
        step(page, fields)
    expect(field(page, "f")).to_have_value("615.3")
    assert page.evaluate("document.documentElement.dataset.theme") == "light"
    expect(page.get_by_role("tab", name="stories")).to_have_attribute("aria-selected", "true")
    undo.click()
    addressed(page, "scale=&f=615.3")
    expect(page.locator("#stage")).to_have_attribute("data-scale", "same")
    page.go_back()
    expect(field(page, "f")).to_have_value("340")
    expect(undo).to_be_disabled()
    page.wait_for_function("!granchain.steps.returning")
    for holds in ("f=615.3", "scale=fit", "tab=effects"):
        page.keyboard.press("Control+Shift+z")
        step(page, holds)
    expect(redo).to_be_enabled()
    type_into(page, "f", "700")  # a new change: the steps ahead are gone
    step(page, "f=700")
    expect(redo).to_be_disabled()
    field(page, "f").fill("12")  # during typing, undo applies to the field
    field(page, "f").press("Control+z")
    step(page, "f=700")


def test_a_step_back_brings_the_motion_and_not_only_the_knobs(visit: Visit) -> None:
    """At 880 Hz, the chain keeps the motion with which it arrives; the address has that motion's initial state."""
    page = visit("?v=1&scene=sec2&f=860&start=previous")
    settled(page)
    type_into(page, "f", "880")
    expect(page.locator("#foot #regime")).to_contain_text(PERIOD_1)
    step(page, "from=*")
    type_into(page, "f", "400")
    step(page, "f=400")
    page.keyboard.press("Control+z")
    expect(field(page, "f")).to_have_value("880")
    expect(page.locator("#foot #regime")).to_contain_text(PERIOD_1)
    expect(page.locator("#foot #start")).to_have_text("from previous state")
    page.reload()
    page.wait_for_function("window.painted.length > 0")
    expect(page.locator("#foot #regime")).to_contain_text(PERIOD_1)


def test_a_pin_stays_while_knobs_move_and_comes_back_with_the_link(visit: Visit) -> None:
    page = visit()
    page.wait_for_selector(".peak-names button", timeout=COMPILED)
    page.get_by_role("button", name="Pin this picture and compare").click()
    expect(page.get_by_role("tab", name="numbers")).to_have_attribute("aria-selected", "true")
    type_into(page, "D", "60")
    type_into(page, "f", "850")
    settled(page)
    table = page.locator("#tabs .compared")
    expect(table).to_contain_text("f = 340 Hz, D = 100 N s/m")
    expect(table).to_contain_text("628.504 mN")
    for figure in ("input force", "output force", "resonance curve"):
        until(page, lambda figure=figure: max(page.evaluate(PINNED, figure)) > 50)  # type: ignore[misc]
    expect(page.locator("#pinned")).to_be_visible()
    until(page, lambda: faults(page) == [])
    step(page, "pin=*")
    other = visit(page.evaluate("location.search"))
    expect(other.locator("#tabs .compared")).to_contain_text("628.504 mN")
    until(other, lambda: max(other.evaluate(PINNED, "resonance curve")) > 50, 60.0)
    other.get_by_role("button", name="Turn the knobs to pin A").click()
    expect(field(other, "D")).to_have_value("100")
    other.get_by_role("button", name="Remove pin A").click()
    expect(other.locator("#pinned")).to_be_hidden()
    assert max(other.evaluate(PINNED, "output force")) == 0


def test_pictures_are_taken_along_as_they_are_on_the_screen(visit: Visit, tmp_path: Path) -> None:
    page = visit(accept_downloads=True)
    settled(page)
    page.get_by_role("button", name="Export").click()
    for what in ("stage", "chain", "driver", "energy", "wall", "curve"):
        page.get_by_label("which picture").select_option(what)
        kind = "SVG" if what in ("stage", "curve") else "PNG"
        with page.expect_download() as download:
            page.get_by_role("button", name=kind, exact=True).click()
        path = tmp_path / download.value.suggested_filename
        download.value.save_as(path)
        assert path.name.startswith(f"sec2-340Hz-{what}.")
        if kind == "SVG":
            text = path.read_text(encoding="utf-8")
            assert "1:1" in text and "340 Hz" in text and text.count("<path") > 10
        else:
            with Image.open(path) as drawn:
                assert min(drawn.size) > 150 and len(set(drawn.convert("L").resize((90, 90)).tobytes())) > 20
    with page.expect_download() as download:
        page.get_by_role("button", name="Python script that computes it again").click()
    download.value.save_as(tmp_path / "again.py")
    assert 'scene("sec2")' in (tmp_path / "again.py").read_text(encoding="utf-8")
    with page.expect_download() as download:
        page.get_by_role("button", name="everything, HDF5").click()
    path = tmp_path / download.value.suggested_filename
    download.value.save_as(path)
    with h5py.File(path) as file:
        assert file["run/displacement"].shape[1] == 11
    page.keyboard.press("Escape")
    figures_of_the_open_page_are_exported(page, tmp_path)


def figures_of_the_open_page_are_exported(page: Page, tmp_path: Path) -> None:
    """Check that the figures of an open page are offered first."""
    page.get_by_role("tab", name="stability").click()
    page.get_by_role("button", name="open the page").click()
    expect(page.locator('[data-overlay="stability"] .plane canvas').first).to_be_visible(timeout=COMPILED)
    page.get_by_role("button", name="Export").click()
    expect(page.get_by_label("which picture")).to_have_value("page")
    with page.expect_download() as download:
        page.get_by_role("button", name="SVG", exact=True).click()
    download.value.save_as(tmp_path / "page.svg")
    text = (tmp_path / "page.svg").read_text(encoding="utf-8")
    assert download.value.suggested_filename == "sec2-340Hz-page.svg" and "real part of" in text and text.count("<path") > 10


def test_an_embedded_page_has_pictures_and_no_knobs(visit: Visit) -> None:
    page = visit("?v=1&scene=sec2&f=850&embed=1", viewport={"width": 900, "height": 520})
    for gone in ("#side", "#tabs", "#curvebar"):
        expect(page.locator(gone)).to_be_hidden()
    whole = page.get_by_role("link", name="open in granchain")
    href = whole.get_attribute("href") or ""
    assert "scene=sec2&f=850" in href and "embed" not in href
    expect(page.get_by_role("heading", name="sec2, 850 Hz")).to_be_visible()
    until(page, lambda: faults(page) == [])
