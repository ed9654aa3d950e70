"""The page as a visitor meets it, in a real browser on a really started server."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import h5py
import pytest
from playwright.sync_api import Browser, Page, expect
from started import dashboard

Visit = Callable[..., Page]


def knob(page: Page, name: str) -> str:
    """What stands in the number field of a knob."""
    return page.locator(f'[data-knob="{name}"] input[type="text"]').input_value()


def type_into(page: Page, name: str, text: str) -> None:
    """Type a value and press Enter."""
    field = page.locator(f'[data-knob="{name}"] input[type="text"]')
    field.fill(text)
    field.press("Enter")


def settled(page: Page) -> None:
    """Wait until the certified picture is on the screen."""
    page.wait_for_timeout(200)
    expect(page.locator("#foot b")).not_to_contain_text("preview", timeout=20_000)


def test_the_chain_moves(visit: Visit) -> None:
    page = visit()
    first = page.evaluate("pixels('chain')")
    page.wait_for_function(f"pixels('chain') !== {first}")
    settled(page)
    expect(page.locator("#foot")).to_contain_text("period 1")


SAYS_LATE_THAT_IT_IS_READY = """
const before = WebSocket.prototype.send;
let message = [];
WebSocket.prototype.send = function (frame) {
  message.push(frame);
  if (message.length < 3) return;
  const frames = message;
  message = [];
  const late = String(frames[2]).includes("document_ready") ? 1500 : 0;
  const send = () => frames.forEach((one) => before.call(this, one));
  late ? setTimeout(send, late) : send();
};
"""


def test_a_page_that_says_late_that_it_is_ready_gets_everything(visit: Visit) -> None:
    """Its parts ask before; what Panel is told to change before is lost. So the answers wait for it."""
    page = visit(script=SAYS_LATE_THAT_IT_IS_READY)
    expect(page.locator('[data-knob="f"] input[type="text"]')).to_have_value("340", timeout=5_000)
    settled(page)
    expect(page.locator("#bar select").first).to_have_value("sec2")


# A busy machine may paint once more what it had begun; a chain that plays changes in every 300 ms.
STANDS_STILL = """async () => {
  const before = pixels("chain");
  await new Promise((done) => setTimeout(done, 300));
  return pixels("chain") === before;
}"""


def test_pause_stops_the_chain_and_a_dragged_cursor_moves_it(visit: Visit) -> None:
    page = visit()
    settled(page)
    page.get_by_role("button", name="Play or pause").click()
    page.wait_for_function(STANDS_STILL)
    still = page.evaluate("pixels('chain')")
    box = page.locator("#map").bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + 100, box["y"] + 120)
    page.mouse.down()
    page.mouse.move(box["x"] + 100, box["y"] + 260)
    page.mouse.up()
    page.wait_for_function(f"pixels('chain') !== {still}")


def test_a_bead_has_the_colour_of_its_column(visit: Visit) -> None:
    page = visit()
    settled(page)
    page.get_by_role("button", name="Play or pause").click()
    box = page.locator("#map").bounding_box()
    assert box is not None
    # 1.1 ms into the picture the pulse is in the last beads and the first are at rest
    page.mouse.click(box["x"] + box["width"] / 2, box["y"] + 50 + (box["height"] - 102) * 0.095)
    page.evaluate("shown()")
    beads, columns = page.evaluate(COLOURS)
    for bead, column in zip(beads, columns, strict=True):
        assert max(abs(a - b) for a, b in zip(bead, column, strict=True)) < 60
    assert max(sum(column) for column in columns) > 150 > min(sum(column) for column in columns)


# The colour in the lower half of every bead and of its column of the map, at the time of the cursor.
COLOURS = """() => {
  const pixel = (id, x, y) => {
    const canvas = canvasIn(id), box = canvas.getBoundingClientRect();
    const { data } = canvas.getContext("2d").getImageData(Math.round(x - box.x), Math.round(y - box.y), 1, 1);
    return [...data].slice(0, 3);
  };
  const map = document.getElementById("map").getBoundingClientRect();
  const chain = document.getElementById("chain").getBoundingClientRect();
  const line = document.getElementById("cursor").getBoundingClientRect();
  const pitch = (map.width - 12) / 11, beads = [], columns = [];
  for (let i = 0; i < 11; i++) {
    const x = map.x + 6 + (i + 0.5) * pitch;
    beads.push(pixel("chain", x, chain.y + 0.53 * chain.height + 0.12 * pitch));
    columns.push(pixel("map", x, line.y + line.height / 2));
  }
  return [beads, columns];
}"""


def test_everything_is_in_view_without_scrolling(visit: Visit) -> None:
    page = visit()
    size = page.evaluate("[document.documentElement.scrollWidth, document.documentElement.scrollHeight]")
    assert size == [1280, 800]
    foot = page.locator("#foot").bounding_box()
    assert foot is not None and foot["y"] + foot["height"] <= 800


@pytest.mark.parametrize("key", ["ArrowRight", "Shift+ArrowRight"])
def test_a_slider_step_repaints_the_map(visit: Visit, key: str) -> None:
    page = visit()
    settled(page)
    before, count = page.evaluate("[pixels('map'), painted.length]")
    page.locator('[data-knob="f"] input[type="range"]').press(key)
    page.wait_for_function(f"painted.length > {count} && pixels('map') !== {before}")


def test_fine_coarse_typed_and_back(visit: Visit) -> None:
    page = visit()
    slider = page.locator('[data-knob="f"] input[type="range"]')
    slider.press("ArrowRight")
    assert float(knob(page, "f")) == pytest.approx(340.1)
    slider.press("Shift+ArrowRight")
    assert float(knob(page, "f")) > 345
    type_into(page, "f", "615")
    assert knob(page, "f") == "615"
    page.locator('[data-knob="f"] label').dblclick()
    expect(page.locator('[data-knob="f"] input[type="text"]')).to_have_value("340")


def test_k_shows_kappa_and_the_foundation_frequency(visit: Visit) -> None:
    page = visit("?v=1&scene=rig")
    assert float(knob(page, "kappa")) == pytest.approx(1e-3)
    type_into(page, "k", "0")
    expect(page.locator('[data-knob="kappa"] input[type="text"]')).to_have_value("0")
    expect(page.locator("#knobs .aside")).to_contain_text("none")


def test_an_amplitude_moved_alone_is_said_beside_kappa(visit: Visit) -> None:
    page = visit("?v=1&scene=rig")
    expect(page.locator("#knobs .kept")).to_be_empty()
    type_into(page, "A0", "6")
    expect(page.locator("#knobs .kept")).to_have_text("κ was 0.001; A₀ moved, not k")
    assert knob(page, "kappa") == "0.00108012"
    type_into(page, "A0", "8")
    expect(page.locator('[data-knob="kappa"] input[type="text"]')).to_have_value("9.35414e-4")
    type_into(page, "kappa", "0.001")
    expect(page.locator("#knobs .kept")).to_be_empty()


def test_live_frames_advance(visit: Visit) -> None:
    page = visit()
    page.get_by_role("button", name="The run goes on").click()
    page.wait_for_function("painted.filter((event) => event.live).length > 10")
    count = page.evaluate("painted.length")
    page.wait_for_function(f"painted.length > {count} + 16")  # how many a second: tests/benchmarks/browser_latency.py
    expect(page.locator("#foot b")).to_contain_text("live")


def test_live_stops_when_paused_and_steps_by_one_period(visit: Visit) -> None:
    page = visit()
    page.get_by_role("button", name="The run goes on").click()
    page.wait_for_function("painted.filter((event) => event.live).length > 10")
    page.get_by_role("button", name="Play or pause").click()
    page.wait_for_timeout(500)
    count = page.evaluate("painted.length")
    page.wait_for_timeout(400)  # nothing to wait for: that nothing comes is the point
    assert page.evaluate("painted.length") == count
    page.get_by_role("button", name="One drive period on").click()
    page.wait_for_function(f"painted.length > {count}")


def test_a_click_on_the_curve_sets_the_frequency(visit: Visit) -> None:
    page = visit()
    box = page.locator("#curve").bounding_box()
    assert box is not None
    page.mouse.click(box["x"] + 0.6 * box["width"], box["y"] + 0.5 * box["height"])
    page.wait_for_function("""() => {
      const inner = document.querySelector("#knobs > div > *");
      const host = document.querySelector("#knobs > div").shadowRoot ?? inner.shadowRoot;
      return host.querySelector('[data-knob="f"] input[type="text"]').value !== "340";
    }""")
    assert 1000 < float(knob(page, "f")) < 2500


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


@pytest.mark.parametrize("value", ["1e15", '{"type":"number","value":"nan"}', '"three"', "null", "[1]", "-5"])
def test_wrong_values_get_their_sentence(visit: Visit, value: str) -> None:
    page = visit()
    settled(page)
    regime = page.locator("#foot b").inner_text()
    page.evaluate("value => { window.forged = value; }", value)
    page.locator('[data-knob="f"] input[type="range"]').press("ArrowRight")
    expect(page.get_by_role("alert")).to_contain_text("drive frequency")
    assert page.locator("#foot b").inner_text() == regime
    expect(page.locator('[data-knob="f"] input[type="text"]')).to_have_value("340")
    page.evaluate("window.forged = undefined")
    page.locator('[data-knob="f"] input[type="range"]').press("ArrowRight")
    expect(page.get_by_role("alert")).to_be_hidden()


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
    expect(page.locator('[data-knob="f"] input[type="text"]')).to_have_value("60")
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


def test_another_scene_can_be_opened(visit: Visit) -> None:
    page = visit()
    page.locator("select.scene").select_option("fig3b")
    expect(page.locator('[data-knob="f"] input[type="text"]')).to_have_value("1130")
    expect(page.locator("#foot b")).to_contain_text("period 3", timeout=20_000)


# Whether a mark of a picture that the server draws has this colour.
INK = """(ink) => Bokeh.documents.some((one) => [...(one.all_models ?? one._all_models.values())].some(
  ({ line_color }) => (line_color?.value ?? line_color) === ink))"""


@pytest.mark.parametrize(("look", "ink"), [("dark", "#eef1f6"), ("projector", "#000000")])
def test_a_link_says_how_the_page_looks(visit: Visit, look: str, ink: str) -> None:
    page = visit(f"?look={look}")
    page.wait_for_function(f"document.documentElement.dataset.look === '{look}'")
    assert page.evaluate("localStorage.getItem('granchain-look')") is None  # another page looks as it did
    # the pictures too, which the server draws
    page.wait_for_function(INK, arg=ink)
    page.get_by_role("button", name="Light, dark, projector").click()
    page.locator("select.speed").select_option("5")
    page.wait_for_function("granchain.kept.speed === 5")
    assert page.evaluate("document.documentElement.dataset.look") != look


def test_dark_on_a_dark_system(visit: Visit) -> None:
    page = visit(color_scheme="dark")
    assert page.evaluate("document.documentElement.dataset.look") == "dark"


def test_a_phone_has_the_knobs_in_a_drawer(visit: Visit) -> None:
    page = visit(viewport={"width": 390, "height": 844}, has_touch=True)
    assert page.evaluate("document.documentElement.scrollWidth") == 390
    expect(page.locator("#side")).to_be_hidden()
    page.get_by_role("button", name="Show the knobs").click()
    expect(page.locator('[data-knob="f"] input[type="range"]')).to_be_visible()


def test_cold_kernels_are_announced_and_the_picture_follows(visit: Visit, chromium: Browser,
                                                            tmp_path: Path) -> None:
    with dashboard(tmp_path / "log", GRANCHAIN_CACHE=str(tmp_path / "cache"), NUMBA_OPT="1") as url:
        page = chromium.new_page()
        page.goto(url)
        expect(page.get_by_role("alert")).to_contain_text("Compiling the kernels", timeout=10_000)
        expect(page.locator("#foot b")).to_contain_text("period 1", timeout=90_000)
        expect(page.get_by_role("alert")).to_be_hidden()
        page.close()
