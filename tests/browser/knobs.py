"""Helpers for tests on the page: read or set a knob, wait for the final picture or the address, check visibility."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial

from playwright.sync_api import Locator, Page, expect

#: The fixture `visit` of conftest.py.
Visit = Callable[..., Page]
#: Long enough for a first visit that has to compile kernels on a machine busy with tests [ms].
COMPILED = 240_000


#: The popovers: name of the opening button, element that gets the focus, and a window width at which the button is on
#: the bar.
POPOVERS = {"Help and keys (?)": (".popover.help", 1920),
            "Export: pictures, tables, a program": (".popover .export-menu :is(button, select) >> nth=0", 1920),
            "Link to this picture": ("input[aria-label='link to this picture']", 1920),
            "More controls": (".popover.menu :is(button, select, input) >> nth=0", 1000)}


def look_seldom(page: Page) -> None:
    """Poll every 50 ms in waits.

    By default, Playwright polls at every frame, and makes the browser draw sixty per second.
    """
    setattr(page, "wait_for_function", partial(page.wait_for_function, polling=50))  # noqa: B010


def field(page: Page, name: str) -> Locator:
    """Return the number field of a knob."""
    return page.locator(f'[data-knob="{name}"] input[type="text"]')


def knob(page: Page, name: str) -> str:
    """Return the text in the number field of a knob."""
    return field(page, name).input_value()


def type_into(page: Page, name: str, text: str) -> None:
    """Type a value and press Enter."""
    field(page, name).fill(text)
    field(page, name).press("Enter")


def play_button(page: Page) -> Locator:
    """Return the button that plays or pauses the replay; its name says which of the two it does."""
    return page.get_by_role("button", name=re.compile(r"^(Play|Pause) \(space\)$"))


def settled(page: Page) -> None:
    """Wait until the final picture for the current knobs is painted, and the status line agrees."""
    page.wait_for_function("granchain.address.isSettled() && painted.at(-1)?.number === granchain.shown.number", timeout=COMPILED)
    expect(page.locator("#foot #regime")).not_to_contain_text("preview")


def looks(page: Page, name: str) -> list[str]:
    """Return the page's messages about a tab or page: "true" when it is being looked at, "false" when it is not."""
    return [one.split()[2] for one in page.evaluate("sent") if one.startswith(f"visible {name} ")]


def addressed(page: Page, fields: str) -> None:
    """Wait until the address has these fields, "f=615.3&tab=effects": any value for "from=*", no field for "tab=".

    Numbers are compared as numbers: an address has "D=80.0".
    """
    page.wait_for_function("""(fields) => {
      const has = new URLSearchParams(location.search);
      const same = (is, value) => is === value || (value !== "" && is !== "" && Number(is) === Number(value));
      return [...new URLSearchParams(fields)].every(
        ([name, value]) => (value === "*" ? has.has(name) : same(has.get(name) ?? "", value)));
    }""", arg=fields)
