"""Every story, played to its end: at each step, the screen shows the motion that the story describes."""

from __future__ import annotations

import re

import pytest
from knobs import Visit
from layout_faults import faults
from playwright.sync_api import Page, ViewportSize, expect
from server import until

from app.dashboard.table import overlay_names
from app.session.stories import IRREGULAR_TOLERANCE, TOLERANCE, UNDRIVEN, Story, stories, told_words

LAPTOP, PHONE = ViewportSize(width=1280, height=800), ViewportSize(width=390, height=844)

# The largest output force drawn at the wall [N].
FORCE = """() => {
  const figure = figures.model("output force");
  const [, letter] = figure.below[0].axis_label.match(/\\((.*)N\\)/), line = figure.renderers.at(-1);
  return Math.max(...line.data_source.data.force) * { "": 1, m: 1e-3, "µ": 1e-6 }[letter];
}"""


def shows(page: Page, story: Story, number: int) -> None:
    """Check that the badge and the pictures are those of the step."""
    step = story.steps[number - 1]
    badge = page.locator("#foot #regime")
    expect(badge).not_to_contain_text("preview")
    regime = "transient without a drive" if step.expect.regime == UNDRIVEN else step.expect.regime
    period = re.compile(rf"period {step.expect.period}(,|$)")  # the evidence behind it is hidden if there is no room
    expect(badge).to_contain_text(period if step.expect.period else regime)
    began = "start: a given state" if step.via else "start: from rest"
    expect(page.locator('select[title="where the steady state starts"] option').first).to_have_text(began)
    curve = page.locator("#curvebar")
    words = "there is no resonance curve"
    expect(curve).to_contain_text(words) if regime == "transient without a drive" else expect(curve).not_to_contain_text(words)
    # The line joins samples, and the peak may be between two: up to 0.7 % higher at 96 per period in these scenes.
    allowed = max(TOLERANCE, 7e-3) if step.expect.period else IRREGULAR_TOLERANCE
    page.wait_for_function(f"([told, allowed]) => Math.abs(({FORCE})() / told - 1) < allowed",
                           arg=[step.expect.output, allowed + 1e-3])


def tells(page: Page, story: Story, number: int, revealed: bool) -> None:
    """Check that the tab has the step's text, and its answer once revealed, and that the screen agrees."""
    tab = page.locator("#tabs")
    expect(tab).to_contain_text(f"{number} of {len(story.steps)}")
    expect(tab).to_contain_text(told_words(story, number, "say"))
    shows(page, story, number)
    answer = told_words(story, number, "answer")
    if answer:
        if not revealed:
            expect(tab.get_by_text(answer)).to_be_hidden()
            tab.get_by_role("button", name="answer").click()
        expect(tab.get_by_text(answer)).to_be_visible()
    if story.steps[number - 1].look:
        expect(page.locator(f"#{story.steps[number - 1].look}.looked-at")).to_have_count(1)


@pytest.mark.long
@pytest.mark.parametrize("story", stories(overlay_names())[0], ids=lambda story: story.name)
def test_the_pictures_of_a_story_are_those_of_its_text(at: Visit, story: Story) -> None:
    """Each step is opened on a laptop or a phone, then viewed on the other, where the next step is opened."""
    page = at()
    now, other = LAPTOP, PHONE
    tab = page.locator("#tabs")
    tab.get_by_role("button", name=story.title).click()
    for number in range(1, len(story.steps) + 1):
        tells(page, story, number, revealed=False)
        page.set_viewport_size(other)
        tells(page, story, number, revealed=True)
        now, other = other, now
        tab.get_by_role("button", name="next" if number < len(story.steps) else "all stories").click()
    expect(tab.get_by_role("button", name=story.title)).to_be_visible()
    expect(page.locator(".looked-at")).to_have_count(0)
    for size in (now, other):
        page.set_viewport_size(size)
        until(page, lambda: faults(page) == [])


def test_a_story_is_read_whole_on_a_laptop(at: Visit) -> None:
    """It has more room than other tabs; a button announces text that does not fit and scrolls to it."""
    page = at("?v=1&scene=sec2&story=sonic-vacuum.1")
    tab = page.locator("#tabs")
    more, panel = tab.get_by_role("button", name="more"), tab.get_by_role("tabpanel")
    whole = "(body) => body.scrollHeight <= body.clientHeight"
    expect(tab.get_by_text("Follow one bright stripe")).to_be_in_viewport(ratio=1)
    assert panel.evaluate(whole)
    expect(more).to_be_hidden()
    tab.get_by_role("button", name="answer").click()
    page.set_viewport_size({"width": 1280, "height": 720})
    expect(more).to_be_visible()
    more.click()
    expect(more).to_be_hidden()
    expect(tab.get_by_text("This is the 1:1 resonance.")).to_be_in_viewport(ratio=1)


def test_going_back_shows_the_earlier_step_again(at: Visit) -> None:
    """The second step is reached through another frequency, so going back and forth must not change its motion."""
    page = at()
    (story,) = (one for one in stories(overlay_names())[0] if one.name == "coexisting")
    tab = page.locator("#tabs")
    tab.get_by_role("button", name=story.title).click()
    shows(page, story, 1)
    for name, number in (("next", 2), ("back", 1), ("next", 2)):
        tab.get_by_role("button", name=name).click()
        shows(page, story, number)


def test_a_term_with_a_capital_has_its_definition(at: Visit) -> None:
    page = at("?v=1&scene=sec2&story=chaos.2")
    page.locator("#tabs").get_by_role("button", name="answer").click()
    page.locator("#tabs dfn", has_text="Lyapunov exponent").hover()
    expect(page.get_by_role("tooltip")).to_contain_text("mean logarithmic growth of a small disturbance")
