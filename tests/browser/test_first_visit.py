"""A first visit: a page that is slow to say that it is ready, one that fits, kernels that are still to be compiled."""

from __future__ import annotations

from pathlib import Path

from knobs import COMPILED, Visit, field, settled
from playwright.sync_api import Browser, expect
from server import dashboard

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
    expect(field(page, "f")).to_have_value("340")
    settled(page)
    expect(page.locator("#bar select").first).to_have_value("sec2")


def test_cold_kernels_are_announced_and_the_picture_follows(visit: Visit, chromium: Browser,
                                                            tmp_path: Path) -> None:
    with dashboard(tmp_path / "log", GRANCHAIN_CACHE=str(tmp_path / "cache"), NUMBA_OPT="1") as url:
        page = chromium.new_page(reduced_motion="reduce")
        page.goto(url)
        expect(page.get_by_role("alert")).to_contain_text("Compiling the kernels")
        expect(page.locator("#foot b")).to_contain_text("period 1", timeout=COMPILED)
        expect(page.get_by_role("alert")).to_be_hidden()
        page.close()


def test_a_first_visit_is_shown_round_once(visit: Visit) -> None:
    first = "addEventListener('DOMContentLoaded', () => { localStorage.removeItem('granchain-toured'); }, { once: true });"
    page = visit(script=f"if (!sessionStorage.getItem('again')) {{ sessionStorage.setItem('again', 1); {first} }}")
    tour = page.get_by_role("dialog", name="tour of the page")
    for number, part in enumerate(("knobs", "chain", "map", "right", "curve"), 1):
        expect(tour).to_contain_text(f"{number} of 5")
        expect(page.locator(".toured")).to_have_id(part)
        here, there = tour.bounding_box(), page.locator(f"#{part}").bounding_box()
        assert here and there  # beside what it tells about, not over it
        assert (here["x"] >= there["x"] + there["width"] or here["x"] + here["width"] <= there["x"]
                or here["y"] >= there["y"] + there["height"] or here["y"] + here["height"] <= there["y"])
        tour.get_by_role("button", name="next" if number < 5 else "to the stories").click()
    expect(tour).to_be_hidden()
    expect(page.locator(".toured")).to_have_count(0)
    term = page.locator("#tabs dfn").first
    term.hover()
    expect(page.get_by_role("tooltip")).to_contain_text("a peak of the largest output force")
    page.reload()
    page.wait_for_function("window.painted.length > 0")
    expect(tour).to_be_hidden()
    page.get_by_role("button", name="Help and keys (?)").click()
    page.get_by_role("button", name="show the tour again").click()
    expect(tour).to_be_visible()
    page.keyboard.press("Escape")
    expect(tour).to_be_hidden()
