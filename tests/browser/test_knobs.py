"""The knobs: dragged, typed into, reset, set by a click on the curve; wrong values get a sentence."""

from __future__ import annotations

import pytest
from knobs import Visit, field, knob, settled, type_into
from playwright.sync_api import expect


def test_a_slider_step_repaints_the_map(at: Visit) -> None:
    page = at()
    for key in ("ArrowRight", "Shift+ArrowRight"):
        settled(page)
        before, count = page.evaluate("[pixels('map'), painted.length]")
        page.locator('[data-knob="f"] input[type="range"]').press(key)
        page.wait_for_function(f"painted.length > {count} && pixels('map') !== {before}")


def test_arrow_keys_turn_a_knob_finely_and_with_shift_coarsely(at: Visit) -> None:
    page = at()
    slider = page.locator('[data-knob="f"] input[type="range"]')
    slider.press("ArrowRight")
    assert float(knob(page, "f")) == pytest.approx(340.1)
    slider.press("Shift+ArrowRight")
    assert float(knob(page, "f")) > 345


def test_a_typed_value_is_exact_and_a_double_click_resets_the_knob(at: Visit) -> None:
    page = at()
    type_into(page, "f", "615")
    assert knob(page, "f") == "615"
    page.locator('[data-knob="f"] label').dblclick()
    expect(field(page, "f")).to_have_value("340")


def test_a_click_on_the_curve_turns_f(at: Visit) -> None:
    page = at()
    box = page.locator("#curve").bounding_box()
    assert box is not None
    page.mouse.click(box["x"] + 0.6 * box["width"], box["y"] + 0.5 * box["height"])
    page.wait_for_function("""() => {
      const inner = document.querySelector("#knobs > div > *");
      const host = document.querySelector("#knobs > div").shadowRoot ?? inner.shadowRoot;
      return host.querySelector('[data-knob="f"] input[type="text"]').value !== "340";
    }""")
    assert 1000 < float(knob(page, "f")) < 2500


def test_kappa_is_shown_for_every_k_and_amplitude(at: Visit) -> None:
    """A change of only the amplitude is stated next to kappa; without a foundation, its frequency is not shown."""
    page = at("?v=1&scene=rig")
    assert float(knob(page, "kappa")) == pytest.approx(1e-3)
    expect(page.locator("#knobs .kept")).to_be_empty()
    type_into(page, "A0", "6")
    expect(page.locator("#knobs .kept")).to_have_text("κ was 0.001 before A₀ changed at constant k")
    assert knob(page, "kappa") == "0.00108012"
    type_into(page, "A0", "8")
    expect(field(page, "kappa")).to_have_value("9.35414e-4")
    type_into(page, "kappa", "0.001")
    expect(page.locator("#knobs .kept")).to_be_empty()
    said = page.locator('[data-knob="k"].zero')
    expect(said).to_have_count(0)
    type_into(page, "k", "0")
    expect(field(page, "kappa")).to_have_value("0")
    expect(said.get_by_text("0: no springs to the ground")).to_be_in_viewport()
    expect(page.locator("#knobs .aside")).to_contain_text("none")


def test_a_knob_without_effect_says_so(at: Visit) -> None:
    """Without dissipation, there is no D in the equation."""
    page = at("?v=1&scene=impact")
    damping = page.locator('[data-knob="D"]')
    expect(damping).to_contain_text("no effect: the law, under “more knobs”, is “none”")
    more = page.locator("summary").get_by_text("more knobs", exact=True).first
    more.click()
    page.get_by_label("damping law").select_option("linear")
    expect(damping).to_contain_text("0: contacts lose no energy")
    more.click()


def test_invalid_values_are_refused_with_a_sentence(at: Visit) -> None:
    page = at()
    settled(page)
    expect(page.locator("#foot #regime")).to_contain_text("1:1 resonance")  # "1:1 motion" until the curve names its peaks
    regime = page.locator("#foot #regime").inner_text().split(",")[0]  # the exact picture states again how fast it settled
    frequency = page.locator('[data-knob="f"] input[type="range"]')
    for value in ("1e15", '{"type":"number","value":"nan"}', '"three"', "null", "[1]", "-5"):
        page.evaluate("value => { window.forged = value; }", value)
        frequency.press("ArrowRight")
        expect(page.get_by_role("alert"), value).to_contain_text("drive frequency")
        assert page.locator("#foot #regime").inner_text().split(",")[0] == regime, value
        expect(field(page, "f"), value).to_have_value("340")
        page.evaluate("window.forged = undefined")
        frequency.press("ArrowRight")
        expect(page.get_by_role("alert"), value).to_be_hidden()
        frequency.press("ArrowLeft")
        expect(field(page, "f")).to_have_value("340")
        settled(page)
        regime = page.locator("#foot #regime").inner_text().split(",")[0]


def test_a_phone_has_f_at_hand_and_the_pictures_in_view_while_a_knob_moves(visit: Visit) -> None:
    page = visit(viewport={"width": 390, "height": 844}, has_touch=True)
    settled(page)
    page.wait_for_function("document.documentElement.scrollWidth === 390")
    height = "(id) => document.getElementById(id).getBoundingClientRect().height / innerHeight"
    assert page.evaluate(height, "bar") + page.evaluate(height, "foot") < 0.15
    first, second = (page.locator(f'[data-knob="{name}"] input[type="range"]') for name in ("f", "A0"))
    expect(first).to_be_in_viewport(ratio=0.9)
    expect(second).not_to_be_in_viewport(ratio=0.5)
    page.get_by_role("button", name="Show or hide the other knobs").click()
    expect(second).to_be_in_viewport(ratio=0.9)
    assert page.evaluate(height, "side") < 0.5
    for part in ("chain", "left", "map", "right"):
        expect(page.locator(f"#{part}")).to_be_in_viewport(ratio=0.95)
    before = page.evaluate("window.painted.length")
    box = first.bounding_box()
    assert box is not None and box["height"] >= 44  # px, a finger
    page.touchscreen.tap(box["x"] + 0.8 * box["width"], box["y"] + 0.5 * box["height"])
    page.wait_for_function("(before) => window.painted.length > before", arg=before)
    expect(second).to_be_in_viewport(ratio=0.9)  # the drawer stays
    page.get_by_role("button", name="Show or hide the other knobs").click()
    expect(second).not_to_be_in_viewport(ratio=0.5)
