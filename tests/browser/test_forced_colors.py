"""With the system's colours (forced colours), the focus, the selection and the pictures remain visible."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from knobs import Visit, settled
from playwright.sync_api import Locator, Page


@pytest.fixture
def page(visit: Visit) -> Iterator[Page]:
    """A page whose visitor has chosen dark system colours."""
    one = visit("?v=1&scene=sec2&look=light")
    settled(one)
    one.emulate_media(forced_colors="active", color_scheme="dark")
    yield one
    one.emulate_media(forced_colors="none", color_scheme="light")


def style(element: Locator, name: str) -> str:
    """Return the computed value of a style property."""
    return str(element.evaluate("(one, name) => getComputedStyle(one)[name]", name))


def test_controls_and_pictures_can_be_seen(page: Page) -> None:
    slider = page.locator("#knobs input[type=range]").first
    page.keyboard.press("Tab")
    slider.focus()
    assert style(slider, "outlineStyle") == "solid" and style(slider, "outlineWidth") == "3px"
    assert style(slider, "outlineColor") == "rgb(255, 255, 255)", "the text of the system, on its dark ground"
    assert style(slider, "appearance") == "auto", "the browser draws the thumb in colours of the system"

    chosen, other = (page.locator(f"#tabs [role=tab][aria-selected={state}]").first for state in ("true", "false"))
    assert style(chosen, "backgroundColor") != style(other, "backgroundColor")

    paper = page.evaluate("getComputedStyle(document.documentElement).getPropertyValue('--paper')")
    for name in ("#stage", "#curve"):
        assert style(page.locator(name), "forcedColorAdjust") == "none"
        assert style(page.locator(name), "backgroundColor") == page.evaluate(
            "(one) => { const made = document.body.appendChild(document.createElement('i'));"
            " made.style.cssText = `forced-color-adjust: none; color: ${one}`;"
            " const found = getComputedStyle(made).color; made.remove(); return found }", paper), "dark marks on the ground of their theme"
