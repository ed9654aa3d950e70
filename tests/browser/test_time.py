"""Time on the page: the chain moves, stops, is dragged through its period; a live run goes on and is stepped."""

from __future__ import annotations

from knobs import Visit, settled
from playwright.sync_api import expect

from app.parts.figure_style import BOTTOM, GAP, TOP

#: A visitor who has not asked for less motion.
MOVING = {"reduced_motion": "no-preference"}


def test_the_chain_moves(visit: Visit) -> None:
    page = visit(**MOVING)
    first = page.evaluate("pixels('chain')")
    page.wait_for_function(f"pixels('chain') !== {first}")
    settled(page)
    expect(page.locator("#foot")).to_contain_text("period 1")


# A busy machine may paint once more what it had begun; a chain that plays changes in every 300 ms.
STANDS_STILL = """async () => {
  const before = pixels("chain");
  await new Promise((done) => setTimeout(done, 300));
  return pixels("chain") === before;
}"""


def test_pause_stops_the_chain_and_a_dragged_cursor_moves_it(visit: Visit) -> None:
    page = visit(**MOVING)
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


def test_for_visitors_who_want_less_motion_the_chain_waits(visit: Visit) -> None:
    page = visit(reduced_motion="reduce")
    settled(page)
    page.wait_for_function(STANDS_STILL)
    play = page.get_by_role("button", name="Play or pause")
    expect(play).to_contain_text("play")
    page.get_by_role("button", name="The run goes on").click()
    expect(page.locator("#foot b")).to_contain_text("live")
    page.get_by_role("button", name="The steady state").click()
    expect(page.locator("#foot b")).to_contain_text("period 1")
    still = page.evaluate("pixels('chain')")
    play.click()
    page.wait_for_function(f"pixels('chain') !== {still}")


def test_a_bead_glows_as_its_column_and_one_at_rest_is_steel(visit: Visit) -> None:
    page = visit("?v=1&scene=fig3b", **MOVING)
    settled(page)
    page.get_by_role("button", name="Play or pause").click()
    box = page.locator("#map").bounding_box()
    assert box is not None
    # half a millisecond into the picture the pulse is in the middle of the chain
    page.mouse.click(box["x"] + box["width"] / 2, box["y"] + TOP + (box["height"] - TOP - BOTTOM) * 0.095)
    page.evaluate("shown()")
    beads, columns = page.evaluate(COLOURS, GAP)
    hot = max(range(11), key=lambda i: sum(columns[i]))
    cold = min(range(11), key=lambda i: sum(columns[i]))
    assert sum(columns[hot]) > 200 > 60 > sum(columns[cold])
    assert hot == max(range(11), key=lambda i: beads[i][0] - beads[i][2])  # the palette's hot end is red and yellow
    assert max(beads[cold]) - min(beads[cold]) < 40


# The colour in the lower half of every bead and of its column of the map, at the time of the cursor.
COLOURS = """(gap) => {
  const pixel = (id, x, y) => {
    const canvas = canvasIn(id), box = canvas.getBoundingClientRect();
    const { data } = canvas.getContext("2d").getImageData(Math.round(x - box.x), Math.round(y - box.y), 1, 1);
    return [...data].slice(0, 3);
  };
  const map = document.getElementById("map").getBoundingClientRect();
  const chain = document.getElementById("chain").getBoundingClientRect();
  const line = document.getElementById("cursor").getBoundingClientRect();
  const pitch = (map.width - 2 * gap) / 11, long = (chain.width - 62 - 26) / 11, beads = [], columns = [];
  for (let i = 0; i < 11; i++) {
    const x = map.x + gap + (i + 0.5) * pitch;
    beads.push(pixel("chain", chain.x + 62 + (i + 0.5) * long, chain.y + 0.58 * chain.height + 0.3 * long));
    columns.push(pixel("map", x, line.y + line.height / 2));
  }
  return [beads, columns];
}"""


def test_live_frames_advance(visit: Visit) -> None:
    page = visit(**MOVING)
    page.get_by_role("button", name="The run goes on").click()
    page.wait_for_function("painted.filter((event) => event.live).length > 10")
    count = page.evaluate("painted.length")
    page.wait_for_function(f"painted.length > {count} + 16")  # how many a second: tests/benchmarks/browser_latency.py
    expect(page.locator("#foot b")).to_contain_text("live")


def test_live_stops_when_paused_and_steps_by_one_period(visit: Visit) -> None:
    page = visit(**MOVING)
    page.get_by_role("button", name="The run goes on").click()
    page.wait_for_function("painted.filter((event) => event.live).length > 10")
    page.get_by_role("button", name="Play or pause").click()
    page.wait_for_timeout(500)
    count = page.evaluate("painted.length")
    page.wait_for_timeout(400)  # nothing to wait for: that nothing comes is the point
    assert page.evaluate("painted.length") == count
    page.get_by_role("button", name="Forward one drive period").click()
    page.wait_for_function(f"painted.length > {count}")
