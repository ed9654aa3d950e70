"""The Observer page as a visitor sees it: the observer breaks down without a foundation, finds its chain with one, and
shows new starts.
"""

from __future__ import annotations

from knobs import COMPILED, Visit, field
from playwright.sync_api import Locator, Page, expect
from server import at_rest, until

#: The last point drawn: period and distance.
LAST = "granchain.pages.get('observer')?.history.at(-1)"

#: Counts the pixels of a canvas that have the colour of the input force.
PUSH = """(canvas) => {
  const of = (drawn, width, height) => drawn.getContext("2d").getImageData(0, 0, width, height).data;
  const sample = Object.assign(document.createElement("canvas"), { width: 1, height: 1 });
  sample.getContext("2d").fillStyle = getComputedStyle(canvas).getPropertyValue("--input").trim();
  sample.getContext("2d").fillRect(0, 0, 1, 1);
  const [red, green, blue] = of(sample, 1, 1);
  const data = of(canvas, canvas.width, canvas.height);
  let count = 0;
  for (let i = 0; i < data.length; i += 4) count += data[i] === red && data[i + 1] === green && data[i + 2] === blue;
  return count;
}"""


def drawn(source: str, points: int) -> str:
    """Return an expression that is true if a line of the page's figure has at least this many points."""
    return f"""figures.view("observer", true)?.model.document
        ?.get_model_by_name("{source}")?.data.period.length >= {points}"""


def opened(page: Page) -> Locator:
    """Open the page from its tab for the scene of figure 11, and wait for the first periods."""
    page.get_by_label("scene").first.select_option("fig11-free")
    page.get_by_role("tab", name="observer").click()
    page.get_by_role("button", name="open the page").click()
    sheet = page.locator('[data-overlay="observer"]')
    page.wait_for_function(drawn("distance", 8), timeout=COMPILED)
    expect(sheet.locator(".trace canvas").first).to_be_visible()
    return sheet


def test_the_observer_synchronises_with_a_foundation_only_and_rests_when_hidden(visit: Visit) -> None:
    page = visit(reduced_motion="no-preference")
    sheet = opened(page)
    expect(sheet).to_contain_text("it drifts: a common shift of all its beads grows exponentially, an instability, because "
                                  "nothing pulls them back", timeout=COMPILED)
    expect(sheet).to_contain_text("predicted × 4.418")  # docs/observers.md: one multiplier outside
    page.wait_for_function(f"{LAST}?.[1] > 0.5")
    # as in the main picture, which shows the same chain
    expect(sheet.locator(".chains")).to_contain_text("as in the main picture; displacements drawn × 10\u202f000")
    chains = sheet.locator(".chains canvas")
    assert chains.count() == 3
    # the force pushes the observer: an arrow in its colour, visible during most of a drive period
    until(page, lambda: int(chains.nth(2).evaluate(PUSH)) > 30)
    sheet.get_by_role("button", name="0.001").click()
    expect(sheet).to_contain_text("it synchronises with its chain", timeout=COMPILED)
    page.wait_for_function(drawn("prediction", 2))
    page.wait_for_function(f"{LAST}[1] < 0.1")
    expect(field(page, "kappa")).to_have_value("0.001")
    # a new start is visible
    page.wait_for_function(f"{LAST}[1] < 3e-3")
    sheet.get_by_role("button", name="from rest").click()
    page.wait_for_function(f"{LAST}[1] > 0.05")
    page.keyboard.press("Escape")
    expect(sheet).to_be_hidden()
    # it continues in its tab, at a smaller size
    before = page.evaluate(f"{LAST}[0]")
    page.wait_for_function(f"{LAST}[0] > {before} + 2")
    # nothing is computed while another tab is open
    page.get_by_role("tab", name="regimes").click()
    at_rest(page, f"{LAST}[0]", still=1000)
