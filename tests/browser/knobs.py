"""What tests do with the page: read a knob, type into it, wait for the certified picture."""

from __future__ import annotations

from playwright.sync_api import Page, expect


def knob(page: Page, name: str) -> str:
    """What stands in the number field of a knob."""
    return page.locator(f'[data-knob="{name}"] input[type="text"]').input_value()


def type_into(page: Page, name: str, text: str) -> None:
    """Type a value and press Enter."""
    field = page.locator(f'[data-knob="{name}"] input[type="text"]')
    field.fill(text)
    field.press("Enter")


def settled(page: Page) -> None:
    """Wait until the certified picture is on the screen."""
    page.wait_for_timeout(200)
    expect(page.locator("#foot b")).not_to_contain_text("preview", timeout=20_000)
