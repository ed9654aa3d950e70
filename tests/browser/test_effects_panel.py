"""The effects panel: a switch changes equation, slots and cost, and current computations are listed correctly."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from evidence import watch
from knobs import COMPILED, Visit, field, play_button
from playwright.sync_api import Locator, Page, expect


def panel(page: Page) -> Locator:
    """Open the Effects tab, enlarged."""
    page.get_by_role("tab", name="effects").click()
    page.get_by_title("Larger: cover the curve").click()
    return page.locator("#tabs")


def effect(tab: Locator, name: str) -> Locator:
    """Return one effect's row."""
    return tab.locator(f'[data-effect="{name}"]')


def activity(tab: Locator, name: str) -> Locator:
    """Return one line of the list of current computations."""
    return tab.locator(f'[data-activity="{name}"]')


# Records the text of an effect's row each time it is drawn since its tab was opened.
ROWS_SEEN = """(body, name) => {
  window.rowsSeen = [];
  const look = () => {
    const row = body.querySelector(`[data-effect="${name}"]`);
    if (row) window.rowsSeen.push(row.innerText);
  };
  new MutationObserver(look).observe(body, { childList: true, subtree: true });
}"""


@pytest.fixture(scope="module")
def measured(shared: Visit) -> Page:
    """A page with the costs of account and dashpot, and the recorded texts of the account's row."""
    page = shared()
    page.locator("[role=tabpanel]").evaluate(ROWS_SEEN, "account")
    tab = panel(page)
    for name in ("account", "dashpot"):
        expect(effect(tab, name).locator(".cost").first).to_contain_text("ns", timeout=COMPILED)
    return page


@pytest.fixture
def page(measured: Page, request: pytest.FixtureRequest, log: Path) -> Page:
    """The same page, for one more test."""
    watch(request.node, measured, log)
    return measured


def test_the_panel_shows_no_cost_before_it_is_measured(page: Page) -> None:
    first = page.evaluate("rowsSeen")[0]
    assert not re.search(r"\d ns", first) and re.search("not measured yet|measuring|compiling", first), first


def test_an_effect_that_is_switched_off_leaves_equation_slot_and_code(page: Page) -> None:
    tab = page.locator("#tabs")
    expect(page.locator("#equation")).to_contain_text("D")
    expect(effect(tab, "dashpot")).to_contain_text("LinearDashpot")
    page.get_by_role("switch", name="contact damping").click()
    expect(effect(tab, "dashpot")).to_contain_text("no code")
    expect(page.locator("#equation")).not_to_contain_text("D")
    expect(effect(tab, "tension")).to_contain_text("no contact can pull")
    expect(page.get_by_role("switch", name="tension cut")).to_be_disabled()
    expect(effect(tab, "dashpot").locator(".cost").nth(1)).to_contain_text("%", timeout=COMPILED)  # its cost in another motion
    page.get_by_role("switch", name="contact damping").click()
    expect(effect(tab, "dashpot")).to_contain_text("LinearDashpot")
    expect(page.locator("#equation")).to_contain_text("D")


def test_the_foundation_comes_with_its_knob(page: Page) -> None:
    tab = page.locator("#tabs")
    page.get_by_role("switch", name="foundation").click()
    expect(effect(tab, "foundation")).to_contain_text("Foundation")
    expect(field(page, "kappa")).to_have_value("0.001")
    page.get_by_role("switch", name="foundation").click()
    expect(field(page, "k")).to_have_value("0")


def test_the_status_line_shows_the_energy_account(page: Page) -> None:
    tab = page.locator("#tabs")
    expect(activity(tab, "energy account")).to_contain_text("switched off")
    page.get_by_role("switch", name="energy account").click()
    expect(effect(tab, "account")).to_contain_text("EnergyAccount")
    expect(page.locator("#foot")).to_contain_text("energy residual ", timeout=COMPILED)
    expect(activity(tab, "energy account")).to_contain_text("closes to")
    page.get_by_role("switch", name="energy account").click()
    expect(activity(tab, "energy account")).to_contain_text("switched off")


@pytest.mark.long
def test_the_panel_lists_every_activity_with_its_state(visit: Visit) -> None:
    """The chain has three beads, because a whole sweep of eleven took four minutes on a busy machine."""
    page = visit("?v=1&scene=sec2&N=3")
    page.get_by_role("tab", name="effects").click()
    tab = page.locator("#tabs")
    expect(activity(tab, "resonance curve, from rest")).to_contain_text("all points are computed", timeout=COMPILED)
    expect(activity(tab, "resonance curve, sweep up")).to_contain_text("not selected")
    expect(activity(tab, "Lyapunov exponent")).to_contain_text("off")
    expect(activity(tab, "live run")).to_contain_text("off")
    page.get_by_label("sweep up").check()
    expect(activity(tab, "resonance curve, sweep up")).to_contain_text("all points are computed", timeout=COMPILED)
    page.get_by_role("button", name="The run continues").click()
    expect(activity(tab, "live run")).to_contain_text("paused")
    play_button(page).click()
    expect(activity(tab, "live run")).to_contain_text("computing")
    play_button(page).click()
    page.get_by_title("Larger: cover the curve").click()
    page.locator('[data-knob="D"] input[type="range"]').press("ArrowRight")
    expect(activity(tab, "resonance curve, from rest")).to_contain_text("not on the screen")
