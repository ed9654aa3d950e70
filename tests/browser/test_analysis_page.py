"""The page "Analysis" as a visitor sees it: a question is asked, computed, drawn, refused, and abandoned when a knob
moves.
"""

from __future__ import annotations

from collections.abc import Callable

from knobs import type_into
from playwright.sync_api import Page, expect
from server import resize, until

from granchain_core import lyapunov_spectrum, scene, settle, spectrum

Visit = Callable[..., Page]
#: Long enough for a first visit that has to compile kernels on a machine busy with tests.
COMPILED = 150_000


def test_the_first_question_is_answered_unasked_and_follows_the_knobs(visit: Visit) -> None:
    page = visit("?v=1&scene=sec2&f=1130&page=analysis")
    overlay = page.locator('[data-overlay="analysis"]')

    def drawn(f: int) -> None:
        picture = overlay.get_by_role("img", name=f"Spectrum of the output force, sec2 at {f} Hz")
        expect(picture).to_be_visible(timeout=COMPILED)

    drawn(1130)
    type_into(page, "f", "1140")
    drawn(1140)
    page.keyboard.press("Escape")
    type_into(page, "f", "1150")  # the page is hidden
    page.locator("#tabs").get_by_role("tab", name="analysis").click()
    page.locator("#tabs").get_by_role("button", name="open the page").click()
    drawn(1150)
    assert "question" not in page.url  # nobody has asked
    overlay.get_by_role("button", name="Which frequencies?").click()
    expect(overlay.locator(".figure")).to_be_hidden()
    overlay.get_by_role("button", name="compute").click()
    drawn(1150)
    until(page, lambda: "question" in page.url)


def test_questions_are_answered_refused_and_given_up(visit: Visit) -> None:
    page = visit("?v=1&scene=sec2&f=1130&look=light")
    page.get_by_role("tab", name="analysis").click()
    page.locator("#tabs").get_by_role("button", name="open the page").click()
    overlay = page.locator('[data-overlay="analysis"]')
    words, compute = overlay.locator(".words"), overlay.get_by_role("button", name="compute")

    expect(overlay.get_by_role("button", name="Which frequencies?")).to_have_attribute("aria-pressed", "true")  # it begins
    found = spectrum(settle(scene("sec2").evolve(f=1130.0), samples=256).run)
    for sentence in found.summary():
        expect(words).to_contain_text(sentence, timeout=COMPILED)
    expect(overlay.get_by_role("img", name="Spectrum of the output force, sec2 at 1130 Hz")).to_be_visible()
    expect(overlay.locator("code")).to_have_text("granchain spectrum sec2 --set f=1130.0 --force output")
    page.evaluate("window.kept = granchain.pages.get('analysis').figure.document; granchain.theme.next()")
    until(page, lambda: bool(page.evaluate(
        "granchain.pages.get('analysis').figure.document && kept !== granchain.pages.get('analysis').figure.document")))

    overlay.get_by_role("button", name="Is it chaos?").click()
    expect(overlay.locator(".figure")).to_be_hidden()
    overlay.get_by_label("drive periods").fill("3")
    compute.click()
    expect(overlay.get_by_role("button", name="stop")).to_be_hidden()
    expect(page.locator("#foot")).to_contain_text("drive periods = 3")
    overlay.get_by_label("drive periods").fill("60")
    compute.click()
    for sentence in lyapunov_spectrum(scene("sec2").evolve(f=1130.0), 60).summary():
        expect(words).to_contain_text(sentence, timeout=COMPILED)

    overlay.get_by_role("button", name="Which start leads where?").click()
    overlay.get_by_label("starts along each").fill("40")
    compute.click()
    expect(overlay.get_by_role("button", name="stop")).to_be_visible()
    type_into(page, "f", "1140")
    expect(overlay.locator(".status")).to_have_text("stopped")
    expect(overlay.get_by_label("starts along each")).to_have_value("40")  # the typed value remains
    expect(overlay.locator(".figure")).to_be_hidden()

    until(page, lambda: "starts%3D40" in page.url)  # the address has the question and the chosen values
    page.reload()
    expect(overlay.get_by_role("button", name="Which start leads where?")).to_have_attribute("aria-pressed", "true")
    expect(overlay.get_by_label("starts along each")).to_have_value("40")
    for width, height in ((390, 844), (1280, 800)):
        resize(page, width, height)
