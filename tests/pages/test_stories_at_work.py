"""The Stories tab, without a browser: a step turns the knobs, and its motion may have to be settled from others."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest
from page_host import PageUnderTest, picture

from app.pages.stories import page as module
from app.pages.stories.page import story_places, story_step
from app.session.stories import StoryStep
from granchain_core import BadInput, Settled


@pytest.fixture
def tab(page_of: Callable[[str], PageUnderTest], monkeypatch: pytest.MonkeyPatch) -> PageUnderTest:
    """The tab, with motions that settle at once."""
    monkeypatch.setattr(module, "state_before", lambda step, stop: picture().state)
    return page_of("stories")


def place(tab: PageUnderTest, via: bool) -> tuple[str, int, StoryStep]:
    """Return a story, a number and the step, whose motion is reached through others or not."""
    found = next(place for place in story_places(tab.host.overlays) if bool(story_step(place, tab.host.overlays).via) is via)
    name, _, number = found.partition(".")
    return name, int(number), story_step(found, tab.host.overlays)


def test_a_step_from_rest_is_shown_at_once(tab: PageUnderTest) -> None:
    name, number, step = place(tab, via=False)
    tab.do("story-open", name=name, step=number)
    assert tab.submitted == [] and tab.host.shown == [(step.scene, None, step.curves)]
    assert tab.host.session.story == f"{name}.{number}"
    assert (tab.state["story"]["step"], tab.state["story"]["look"]) == (number, step.look) and tab.state["story"]["say"]


def test_a_step_that_is_reached_through_others_is_shown_when_they_are_settled(tab: PageUnderTest) -> None:
    name, number, step = place(tab, via=True)
    tab.do("story-open", name=name, step=number)
    assert [submitted.pool for submitted in tab.submitted] == ["analyses"] and tab.host.shown == []
    tab.compute()
    assert tab.host.shown == [(step.scene, picture().state, step.curves)]


def test_a_moved_knob_and_another_step_give_up_the_one_before(tab: PageUnderTest) -> None:
    name, number, _ = place(tab, via=True)
    tab.do("story-open", name=name, step=number)
    tab.move_knobs(f=2100.0)
    assert tab.under_way == []
    tab.do("story-open", name=name, step=number)
    early, first, step = place(tab, via=False)
    tab.do("story-open", name=early, step=first)
    assert tab.under_way == []
    tab.compute()
    assert tab.host.shown == [(step.scene, None, step.curves)]


def test_a_link_that_names_such_a_step_alone_has_it_settled_after_the_first_picture(tab: PageUnderTest) -> None:
    name, number, step = place(tab, via=True)
    tab.host.session.story, tab.host.session.story_to_settle = f"{name}.{number}", True
    tab.page.address_applied()
    not_final: Settled = replace(picture(), final=False)
    tab.deliver_picture(not_final)
    assert tab.under_way == [] and tab.state["story"]["name"] == name
    tab.deliver_picture()
    tab.deliver_picture()
    assert len(tab.submitted) == 1, "once"
    tab.compute()
    assert tab.host.shown == [(step.scene, picture().state, step.curves)]


def test_a_closed_story_leaves_words_and_address(tab: PageUnderTest) -> None:
    name, number, _ = place(tab, via=False)
    tab.do("story-open", name=name, step=number)
    tab.do("story-close")
    assert (tab.state["story"], tab.host.session.story, tab.host.addresses) == (None, "", 1)


def test_a_step_that_does_not_exist_is_refused(tab: PageUnderTest) -> None:
    name, _, _ = place(tab, via=False)
    for message in ({"name": "none", "step": 1}, {"name": name, "step": 99}, {"name": name}):
        with pytest.raises(BadInput):
            tab.do("story-open", **message)
    assert tab.host.session.story == ""
