"""The Stability tab and page as a visitor sees them: multipliers, a moving mode, the section, a search."""

from __future__ import annotations

from bokeh_figures import hover, place, source, tooltips
from knobs import COMPILED, Visit, looks, settled, type_into
from playwright.sync_api import Locator, Page, expect
from server import resize, until


def opened(page: Page, words: str = "Stable") -> Locator:
    """Open the Stability page from its tab, and wait for its verdict."""
    page.get_by_role("tab", name="stability").click()
    page.get_by_role("button", name="open the page").click()
    sheet = page.locator('[data-overlay="stability"]')
    expect(sheet.locator(".say")).to_contain_text(words, timeout=COMPILED)
    return sheet


def marks(page: Page, name: str, large: bool = True) -> int:
    """Return the number of marks in a set of the plane."""
    return len(source(page, "multipliers", name, large).get("x", []))


def axis_title(page: Page, axis: str) -> str:
    """Return the title of an axis of the section."""
    return str(page.evaluate(f'figures.documentOf("section").get_model_by_name("{axis}").axis_label'))


def test_the_tab_shows_stability_and_a_closed_page_computes_nothing(visit: Visit) -> None:
    page = visit()
    tab = page.locator("#tabs")
    settled(page)
    # the server computes only for visible pages (tests/pages/test_stability.py), and none has been reported
    assert looks(page, "stability") == []
    assert page.evaluate("granchain.pages.get('stability').state.sentence") is None
    page.get_by_role("tab", name="stability").click()
    assert looks(page, "stability") == ["true"]
    expect(tab).to_contain_text("Stable: a disturbance shrinks to 0.36", timeout=COMPILED)
    until(page, lambda: marks(page, "within", large=False) == 22)
    type_into(page, "f", "1130")
    expect(tab).to_contain_text("3 drive periods, 2.65 ms")
    page.get_by_role("tab", name="regimes").click()
    assert looks(page, "stability") == ["true", "false"]
    type_into(page, "f", "615")
    settled(page)
    assert looks(page, "stability") == ["true", "false"]
    assert "3 drive periods" in page.evaluate("granchain.pages.get('stability').state.sentence")
    page.get_by_role("tab", name="stability").click()
    expect(tab).to_contain_text("2 drive periods")


def test_hovering_shows_a_multiplier_and_choosing_it_animates_its_mode(visit: Visit) -> None:
    page = visit(reduced_motion="no-preference")
    sheet = opened(page)
    until(page, lambda: marks(page, "within") == 22)
    within = source(page, "multipliers", "within")
    hover(page, lambda: place(page, "multipliers", within["x"][0], within["y"][0]), "−0.2882")
    for words in ("0.36", "of the drive frequency", "decays by a factor e in 0.981 drive periods (2.89 ms)"):
        assert words in tooltips(page)
    expect(sheet.locator(".readout")).to_contain_text("μ = −0.2882")
    expect(sheet.locator("path.swing")).to_have_count(11)
    expect(sheet).to_contain_text("the slowest-decaying disturbance")
    before = sheet.locator("path.swing").first.get_attribute("d")
    page.mouse.click(*place(page, "multipliers", within["x"][3], within["y"][3]))
    expect(sheet).to_contain_text("the chosen disturbance")
    chosen = source(page, "multipliers", "chosen")
    assert (chosen["x"], chosen["y"]) == ([within["x"][3]], [within["y"][3]])
    sheet.locator(".plane .figure").focus()
    page.keyboard.press("ArrowLeft")
    until(page, lambda: source(page, "multipliers", "chosen")["x"] == [within["x"][2]])
    assert sheet.locator("path.swing").first.get_attribute("d") != before
    moment = sheet.locator("line.moment")
    there = moment.get_attribute("transform")
    until(page, lambda: moment.get_attribute("transform") != there)


def test_the_observer_is_a_second_set_and_off_at_first(at: Visit) -> None:
    page = at("?v=1&scene=fig11-free")
    sheet = opened(page)
    until(page, lambda: marks(page, "within") == 22)
    assert marks(page, "observer within") == 0
    sheet.get_by_label("observer", exact=True).check()
    until(page, lambda: marks(page, "observer outside") == 1)  # Fig. 11: exactly one, real
    assert marks(page, "observer within") == 21
    expect(sheet.locator(".say")).to_contain_text("Its observer is unstable, |μ| 4.42")


def test_the_page_follows_the_knobs_and_the_window(visit: Visit) -> None:
    page = visit()
    sheet = opened(page)
    until(page, lambda: marks(page, "within") == 22)
    assert marks(page, "past") == 0
    type_into(page, "f", "344")
    until(page, lambda: marks(page, "past") > 0 and marks(page, "ways") > 0)
    table = sheet.locator(".evidence")
    for words in ("distance to the orbit", "Newton's residual", "product of all μ", "disturbance followed", "settled by"):
        expect(table).to_contain_text(words)
    fits(page, sheet)
    page.set_viewport_size({"width": 1280, "height": 800})
    type_into(page, "f", "1130")
    section_follows_bead_and_phase(page, sheet)
    # a live run has no multipliers
    page.get_by_role("button", name="The run continues").click()
    expect(sheet.locator(".say")).to_contain_text("a live run is under way")
    assert marks(page, "within") == marks(page, "outside") == 0


def section_follows_bead_and_phase(page: Page, sheet: Locator) -> None:
    """Check that the orbit has three points at the 1:3 resonance, and other approaches for another bead or phase."""
    until(page, lambda: len(source(page, "section", "orbit").get("u", ())) == 3)
    first = source(page, "section", "way")
    assert len(first["u"]) > 20
    sheet.get_by_label("bead of the section").select_option("7")
    until(page, lambda: axis_title(page, "displacement") == "displacement of bead 7 (nm)")
    second = source(page, "section", "way")
    assert second["u"] != first["u"]
    sheet.get_by_label("drive phase of the section").fill("12")
    expect(sheet.locator("output")).to_have_text("0.25 T")
    until(page, lambda: source(page, "section", "way")["u"] != second["u"])
    assert len(source(page, "section", "orbit")["u"]) == 3


def fits(page: Page, sheet: Locator) -> None:
    """Check that the pictures are inside the window at every size, and on a large one the search too."""
    for width, height in ((1280, 800), (1920, 1080), (390, 844)):
        resize(page, width, height)
        for name, least in ((".plane .figure", 200), (".motion .figure", 130), (".poincare .figure", 130)):
            box = sheet.locator(name).bounding_box()
            assert box is not None and box["x"] >= 0 and box["x"] + box["width"] <= width and box["height"] > least
        search = sheet.get_by_role("button", name="search").bounding_box()
        assert search is not None and (width < 500 or search["y"] + search["height"] <= height)


def test_chaos_has_a_cloud_and_an_unstable_orbit_that_it_does_not_follow(at: Visit) -> None:
    page = at("?v=1&scene=rig&f=140")
    sheet = opened(page, "No multipliers: the motion is chaotic")
    until(page, lambda: source(page, "multipliers", "reach") != {})
    assert marks(page, "within") == marks(page, "outside") == 0
    expect(sheet).to_contain_text("1200 drive periods, one point each")
    until(page, lambda: len(source(page, "section", "way").get("u", ())) + len(source(page, "section", "dots").get("u", ())) > 1000)
    expect(sheet.locator(".evidence")).to_contain_text("Lyapunov exponent")
    sheet.get_by_role("button", name="search").click()
    expect(sheet.locator(".searched")).to_contain_text("the chain does not follow this orbit", timeout=COMPILED)
    expect(sheet.locator(".say")).to_contain_text("Unstable: a disturbance grows 1.57-fold")
    until(page, lambda: marks(page, "outside") == 3)
    until(page, lambda: len(source(page, "section", "unstable orbit")["u"]) == 1)
    sheet.get_by_role("button", name="back to the settled motion").click()
    expect(sheet.locator(".say")).to_contain_text("No multipliers")
    expect(sheet.locator(".searched")).to_be_hidden()
