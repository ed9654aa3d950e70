"""A first visit: a page that is late to report that it is ready, one that fits, kernels that are not compiled."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import pytest
from knobs import COMPILED, Visit, field, settled
from playwright.sync_api import Browser, Locator, Page, expect
from server import dashboard, until

from granchain_core.kernels.compiling.cache_folder import CACHE_FOLDER, MARK

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


def test_a_page_that_is_ready_late_gets_everything(visit: Visit) -> None:
    """Parts of the page send requests before the page is ready. Panel loses changes made then, so the answers wait."""
    page = visit(script=SAYS_LATE_THAT_IT_IS_READY)
    expect(field(page, "f")).to_have_value("340")
    settled(page)
    expect(page.locator("#bar select").first).to_have_value("sec2")


HOLDS_ITS_MESSAGES = """
const send = WebSocket.prototype.send, held = [];
WebSocket.prototype.send = function (frame) { held.push([this, frame]); };
window.release = () => {
  WebSocket.prototype.send = send;
  for (const [socket, frame] of held) socket.send(frame);
};
"""
# The placeholder of each part before it exists, and the number of visible texts over the pictures.
SKELETON = """() => ["chain", "left", "map", "right", "curve"]
  .map((id) => getComputedStyle(document.getElementById(id), "::before").content)"""
OVER = """() => [...document.querySelectorAll("#stage :is(.title, .peak, #key, #scale)")]
  .filter((one) => getComputedStyle(one).visibility === "visible").length"""


def test_before_the_first_picture_every_part_announces_its_content(chromium: Browser, prepared: str) -> None:
    """No texts overlap: the titles appear together with the pictures."""
    page = chromium.new_page(reduced_motion="reduce")
    page.add_init_script(HOLDS_ITS_MESSAGES)
    page.goto(prepared)
    page.wait_for_selector("#dashboard.starting")
    coming = page.evaluate(SKELETON)
    assert all(words in content for words, content in zip(
        ("the chain of beads", "at the driver", "kinetic energy", "at the wall", "resonance curve"), coming, strict=True))
    assert page.evaluate(OVER) == 0
    page.evaluate("release()")
    page.wait_for_selector("#dashboard:not(.starting)")
    assert page.evaluate(SKELETON) == ["none"] * 5 and page.evaluate(OVER) == 7
    page.close()


@pytest.mark.long
def test_cold_kernels_are_announced_and_the_picture_follows(visit: Visit, chromium: Browser,
                                                            tmp_path: Path) -> None:
    """Only the kernels of one file are missing: compiling the others as well would test nothing more."""
    assert CACHE_FOLDER is not None
    shutil.copytree(CACHE_FOLDER, tmp_path / "cache" / CACHE_FOLDER.name, copy_function=os.link,
                    ignore=shutil.ignore_patterns(f"{MARK}*", "*.rk4.run", "*.lock", "*.tmp"))
    with dashboard(tmp_path / "log", GRANCHAIN_CACHE=str(tmp_path / "cache")) as url:
        page = chromium.new_page(reduced_motion="reduce")
        page.goto(url)
        expect(page.get_by_role("alert")).to_contain_text("Compiling the kernels")
        expect(page.locator("#foot #regime")).to_contain_text("period 1", timeout=COMPILED)
        expect(page.get_by_role("alert")).to_be_hidden()
        page.close()


def test_pictures_of_another_scene_are_grey_until_its_own_come(visit: Visit) -> None:
    page = visit()
    page.evaluate("""() => {
      window.greyed = [];
      const one = document.getElementById("dashboard");
      new MutationObserver(() => greyed.push(one.classList.contains("another"))).observe(one, { attributeFilter: ["class"] });
    }""")
    page.locator("select.scene").select_option("fig3b")
    page.wait_for_function("granchain.shown.scene === 'fig3b'")
    assert page.evaluate("greyed.includes(true)")
    expect(page.locator("#dashboard.another")).to_have_count(0)


def pointed_at(page: Page, term: Locator) -> bool:
    """Move the pointer from elsewhere to a term; return whether its definition is shown."""
    page.mouse.move(0, 0)
    term.hover()
    return page.get_by_role("tooltip").is_visible()


def test_a_first_visit_is_shown_round_once(visit: Visit) -> None:
    first = "addEventListener('DOMContentLoaded', () => { localStorage.removeItem('granchain-toured'); }, { once: true });"
    page = visit(script=f"if (!sessionStorage.getItem('again')) {{ sessionStorage.setItem('again', 1); {first} }}")
    tour = page.get_by_role("dialog", name="tour of the page")
    for number, part in enumerate(("knobs", "chain", "map", "right", "curve"), 1):
        expect(tour).to_contain_text(f"{number} of 5")
        expect(page.locator(".toured")).to_have_id(part)
        here, there = tour.bounding_box(), page.locator(f"#{part}").bounding_box()
        assert here and there  # next to the element that it describes, not over it
        assert (here["x"] >= there["x"] + there["width"] or here["x"] + here["width"] <= there["x"]
                or here["y"] >= there["y"] + there["height"] or here["y"] + here["height"] <= there["y"])
        tour.get_by_role("button", name="next" if number < 5 else "to the stories").click()
    expect(tour).to_be_hidden()
    expect(page.locator(".toured")).to_have_count(0)
    settled(page)
    until(page, lambda: pointed_at(page, page.locator("#tabs dfn").first))  # until late content has moved the tab
    expect(page.get_by_role("tooltip")).to_contain_text("a peak of the largest output force")
    page.reload()
    page.wait_for_function("window.painted.length > 0")
    expect(tour).to_be_hidden()
    page.get_by_role("button", name="Help and keys (?)").click()
    page.get_by_role("button", name="show the tour again").click()
    expect(tour).to_be_visible()
    page.keyboard.press("Escape")
    expect(tour).to_be_hidden()


def test_a_meaning_stays_when_the_tab_is_made_anew_under_the_pointer(visit: Visit) -> None:
    """A tab is rebuilt with every scene, also within a second of a first visit."""
    page = visit()
    settled(page)
    term = page.locator("#tabs dfn").first
    until(page, lambda: pointed_at(page, term))
    term.evaluate("(one) => { one.dataset.before = ''; }")
    page.locator("select.scene").select_option("fig3b")
    expect(page.locator("#tabs dfn[data-before]")).to_have_count(0)
    expect(page.get_by_role("tooltip")).to_contain_text("a peak of the largest output force")
    page.mouse.move(0, 0)
    expect(page.get_by_role("tooltip")).to_be_hidden()
