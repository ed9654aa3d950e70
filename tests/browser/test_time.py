"""Time on the page: the chain moves, stops and is dragged through its period; a live run continues and is stepped."""

from __future__ import annotations

from knobs import Visit, play_button, settled, type_into
from playwright.sync_api import expect
from server import at_rest

from app.parts.figures.figure_style import BOTTOM, GAP, TOP

#: A visitor who has not asked for reduced motion.
MOVING = {"reduced_motion": "no-preference"}


# A busy machine may paint once more after a stop; a playing chain changes within every 300 ms.
STANDS_STILL = """async () => {
  const before = pixels("chain");
  await new Promise((done) => setTimeout(done, 300));
  return pixels("chain") === before;
}"""


def test_the_chain_moves_is_paused_and_moved_by_a_dragged_cursor(visit: Visit) -> None:
    page = visit(**MOVING)
    first = page.evaluate("pixels('chain')")
    page.wait_for_function(f"pixels('chain') !== {first}")
    settled(page)
    expect(page.locator("#foot")).to_contain_text("period 1")
    play_button(page).click()
    page.wait_for_function(STANDS_STILL)
    still = page.evaluate("pixels('chain')")
    box = page.locator("#map").bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + 100, box["y"] + 120)
    page.mouse.down()
    page.mouse.move(box["x"] + 100, box["y"] + 260)
    page.mouse.up()
    page.wait_for_function(f"pixels('chain') !== {still}")


# Counts the animation frames that the page requests.
FRAMES_ASKED = """
const ask = window.requestAnimationFrame;
window.asked = 0;
window.requestAnimationFrame = (act) => { window.asked += 1; return ask.call(window, act); };
"""


def test_with_reduced_motion_the_chain_is_paused(visit: Visit) -> None:
    page = visit(reduced_motion="reduce", script=FRAMES_ASKED)
    settled(page)
    page.wait_for_function(STANDS_STILL)
    at_rest(page, "asked")  # an idle page requests no animation frames
    play = play_button(page)
    expect(play).to_contain_text("play")
    page.get_by_role("button", name="The run continues").click()
    expect(page.locator("#foot #regime")).to_contain_text("live")
    page.get_by_role("button", name="The steady state").click()
    expect(page.locator("#foot #regime")).to_contain_text("period 1")
    still = page.evaluate("pixels('chain')")
    play.click()
    page.wait_for_function(f"pixels('chain') !== {still}")


def test_a_bead_glows_as_its_column_and_one_at_rest_is_steel(visit: Visit) -> None:
    page = visit("?v=1&scene=fig3b", **MOVING)
    settled(page)
    play_button(page).click()
    box = page.locator("#map").bounding_box()
    assert box is not None
    # half a millisecond into the picture, the pulse is in the middle of the chain
    page.mouse.click(box["x"] + box["width"] / 2, box["y"] + TOP + (box["height"] - TOP - BOTTOM) * 0.095)
    page.evaluate("shown()")
    beads, columns = page.evaluate(COLOURS, GAP)
    hot = max(range(11), key=lambda i: sum(columns[i]))
    cold = min(range(11), key=lambda i: sum(columns[i]))
    assert sum(columns[hot]) > 200 > 60 > sum(columns[cold])
    assert hot == max(range(11), key=lambda i: beads[i][0] - beads[i][2])  # the palette's hot end is red and yellow
    assert max(beads[cold]) - min(beads[cold]) < 40


# The colour of every bead (0.3 of a pitch below its middle) and of its column in the energy map, at the time of the
# cursor.
COLOURS = """(gap) => {
  const pixel = (id, x, y) => {
    const canvas = canvasIn(id), box = canvas.getBoundingClientRect();
    const { data } = canvas.getContext("2d").getImageData(Math.round(x - box.x), Math.round(y - box.y), 1, 1);
    return [...data].slice(0, 3);
  };
  const map = document.getElementById("map").getBoundingClientRect();
  const chain = document.getElementById("chain").getBoundingClientRect();
  const line = document.getElementById("cursor").getBoundingClientRect();
  const pitch = (map.width - 2 * gap) / 11, beads = [], columns = [];
  for (let i = 0; i < 11; i++) {
    const x = map.x + gap + (i + 0.5) * pitch;
    const [at, middle] = granchain.chain.placeOf(i + 1), long = granchain.chain.placeOf(i + 2)[0] - at;
    beads.push(pixel("chain", chain.x + at, chain.y + middle + 0.3 * long));
    columns.push(pixel("map", x, line.y + line.height / 2));
  }
  return [beads, columns];
}"""


def test_live_frames_advance_stop_when_paused_and_step_by_one_period(visit: Visit) -> None:
    page = visit(**MOVING)
    page.get_by_role("button", name="The run continues").click()
    page.wait_for_function("painted.filter((event) => event.live).length > 10")
    count = page.evaluate("painted.length")
    page.wait_for_function(f"painted.length > {count} + 16")  # for the frame rate, see tests/benchmarks/browser_latency.py
    expect(page.locator("#foot #regime")).to_contain_text("live")
    play_button(page).click()
    count = at_rest(page, "painted.length")
    page.get_by_role("button", name="Forward one drive period").click()
    page.wait_for_function(f"painted.length > {count}")


def test_a_line_with_values_goes_through_all_pictures_and_a_tape_measures_speed(visit: Visit) -> None:
    page = visit("?v=1&scene=sec2&f=340")
    settled(page)
    area = page.evaluate("""() => { const box = document.getElementById("map").getBoundingClientRect();
      const style = getComputedStyle(document.getElementById("stage"));
      const [top, bottom, gap] = ["--frame-top", "--frame-bottom", "--gap"].map((name) => parseFloat(style.getPropertyValue(name)));
      return [box.left + gap, box.top + top, box.width - 2 * gap, box.height - top - bottom]; }""")

    def at(bead: float, share: float) -> tuple[float, float]:
        return area[0] + (bead - 0.5) / 11 * area[2], area[1] + share * area[3]

    page.mouse.move(*at(4, 0.25))  # after one of four periods, the driver is back at its start
    cross = page.locator("#cross")
    expect(cross).to_contain_text("bead 4: ")
    # 0.25 of 4 periods of 1/340 s, to within two rows of the picture
    words = cross.inner_text()
    shown = float(words.split(" ms")[0].split()[-1])
    assert abs(shown - 1e3 / 340) < 0.07
    page.keyboard.down("Shift")
    page.mouse.move(*at(1, 0.1))
    page.mouse.down()
    page.mouse.move(*at(11, 0.6))
    page.mouse.up()
    page.keyboard.up("Shift")
    tape = page.locator("#measured")
    expect(tape).to_contain_text("bead 1 to 11: 191 mm in ")  # ten diameters of 19.05 mm
    periods = float(tape.inner_text().split("= ")[1].split(" drive")[0])
    speed = float(tape.inner_text().split(": ")[-1].removesuffix(" m/s"))
    assert abs(periods - 2.0) < 0.05 and abs(speed - 0.1905 * 340 / periods) < 0.01 * speed
    page.keyboard.press("Escape")
    expect(tape).to_be_hidden()


def test_the_force_at_the_wall_can_be_heard(visit: Visit) -> None:
    """The audio signal has the drive period, and an anti-resonance is quieter."""
    page = visit("?v=1&scene=sec2&f=340", script="""
      const start = AudioBufferSourceNode.prototype.start;
      AudioBufferSourceNode.prototype.start = function (...given) { window.heard = this.buffer; return start.apply(this, given); };""")
    settled(page)
    assert page.evaluate("window.heard") is None
    page.set_viewport_size({"width": 1920, "height": 1080})
    page.get_by_role("button", name="Hear the force at the wall").click()
    loud = """() => { const data = heard.getChannelData(0); return Math.max(...data) - Math.min(...data); }"""
    cycles = """() => { const data = heard.getChannelData(0); let n = 0;
      const middle = (Math.max(...data) + Math.min(...data)) / 2;
      for (let i = 1; i < data.length; i++) n += data[i - 1] < middle && data[i] >= middle;
      return n / heard.duration; }"""
    page.wait_for_function("window.heard")
    assert abs(page.evaluate(cycles) - 340.0) < 5.0  # one crossing in half a second is 2 Hz
    strong = page.evaluate(loud)
    type_into(page, "f", "850")
    page.wait_for_function(f"() => ({loud})() < {0.6 * strong}")
    page.get_by_role("button", name="Hear the force at the wall").click()
    page.evaluate("delete window.heard")
    type_into(page, "f", "340")
    settled(page)
    assert page.evaluate("window.heard") is None
