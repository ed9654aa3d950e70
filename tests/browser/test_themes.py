"""The themes: chosen by a link, the system or the button."""

from __future__ import annotations

import pytest
from knobs import Visit
from playwright.sync_api import expect

# Whether a mark of a server-drawn picture has this colour.
INK = """(ink) => figures.models().some(({ line_color }) => (line_color?.value ?? line_color) === ink)"""


@pytest.mark.parametrize(("theme", "ink"), [("dark", "#eef1f6"), ("projector", "#000000")])
def test_a_link_says_how_the_page_looks(visit: Visit, theme: str, ink: str) -> None:
    page = visit(f"?look={theme}")
    page.wait_for_function(f"document.documentElement.dataset.theme === '{theme}'")
    assert page.evaluate("localStorage.getItem('granchain-look')") is None  # other pages keep their theme
    # the server-drawn pictures, too
    page.wait_for_function(INK, arg=ink)
    page.get_by_role("button", name="Theme: ").click()
    page.get_by_role("button", name="The run continues").click()
    expect(page.get_by_role("button", name="The run continues")).to_have_attribute("aria-pressed", "true")
    assert page.evaluate("document.documentElement.dataset.theme") != theme


def test_dark_on_a_dark_system(visit: Visit) -> None:
    page = visit(color_scheme="dark")
    assert page.evaluate("document.documentElement.dataset.theme") == "dark"
