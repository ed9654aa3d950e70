"""Stories: their statements are checked by computation, and a bad file is refused with a sentence that says where."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from app.dashboard.table import overlay_names
from app.frames import samples_for
from app.session.stories import FOLDER, Story, StoryStep, differences, read_story, state_before, stories, told_words
from granchain_core import BadInput, Run, settle

OVERLAYS = overlay_names()
TOLD, REFUSED = stories(OVERLAYS)
STEPS = [(story, number) for story in TOLD for number in range(1, len(story.steps) + 1)]

GOOD = """
title = "A story"
about = "About it."

[[steps]]
scene = "sec2"
set = { f = 340.0 }
say = "It has {output}."
expect = { regime = "periodic", period = 1, output = 0.6285, input = 0.6975 }
"""


def motion_of(step: StoryStep) -> Run:
    """Return the motion of a step, with the page's number of samples."""
    return settle(step.scene, start=state_before(step), samples=samples_for(step.scene)).run


def test_every_story_of_the_repository_can_be_read() -> None:
    assert REFUSED == ()
    assert {story.name for story in TOLD} == {path.stem for path in FOLDER.glob("*.toml")}
    assert len(TOLD) >= 3


@pytest.mark.parametrize(("story", "number"), STEPS, ids=[f"{story.name}-{number}" for story, number in STEPS])
def test_the_numbers_of_a_step_are_those_that_are_computed(story: Story, number: int) -> None:
    step = story.steps[number - 1]
    assert differences(step, motion_of(step)) == []


@pytest.mark.parametrize(("story", "number"), STEPS, ids=[f"{story.name}-{number}" for story, number in STEPS])
def test_no_force_is_written_in_digits(story: Story, number: int) -> None:
    """A number that is not computed could be wrong; frequencies and amplitudes are those of the step's knobs."""
    step = story.steps[number - 1]
    for words in (step.say, step.ask, step.answer):
        assert not re.search(r"\d\s*(?:[kmµn]?N\b|%)", words)


def test_a_wrong_number_is_found(tmp_path: Path) -> None:
    path = tmp_path / "wrong.toml"
    path.write_text(GOOD.replace("0.6285", "0.66").replace("period = 1", "period = 2"))
    step = read_story(path, OVERLAYS).steps[0]
    found = differences(step, motion_of(step))
    assert len(found) == 2 and "not periodic 2" in found[0] and "0.6285 N, not 0.66 N" in found[1]


def test_a_wrong_speed_of_a_pulse_is_found(tmp_path: Path) -> None:
    path = tmp_path / "wrong.toml"
    path.write_text((FOLDER / "solitary-wave.toml").read_text().replace("speed = 260.72", "speed = 265.0"))
    step = read_story(path, OVERLAYS).steps[0]
    assert differences(step, motion_of(step)) == ["the pulse's speed is 260.7 m/s, not 265 m/s."]


def test_numbers_stand_in_the_text(tmp_path: Path) -> None:
    path = tmp_path / "one.toml"
    path.write_text(GOOD.replace("It has {output}.", "{output} {input} {share} {f} {1.output}"))
    assert told_words(read_story(path, OVERLAYS), 1, "say") == "0.628 N 0.698 N 90 % 340 Hz 0.628 N"


@pytest.mark.parametrize(("change", "to", "told"), [
    ("title =", "titel =", "'titel'; the nearest is 'title'"),
    ('"sec2"', '"sec3"', "step 1: Unknown scene 'sec3'"),
    ("f = 340.0", "f = -1.0", "step 1: drive frequency f"),
    ("say =", "sya =", "step 1: Unknown field of a step 'sya'"),
    ("period = 1, ", "", "only a periodic motion has a period"),
    ("output = 0.6285", "output = 0", "expect needs output"),
    ("output =", "speed = 260.0, output =", "only a motion without a drive has a pulse"),
    ("{output}", "{speed}", "'speed'; the nearest is"),
    ("{output}", "{ouput}", "'ouput'; the nearest is 'output'"),
    ("{output}", "{7.output}", "is of step 7, but there are 1"),
    ("say =", 'page = "map"\nsay =', "Unknown page 'map'"),
    ("say =", 'look = "stage"\nsay =', "Unknown look 'stage'"),
    ("[[steps]]", "[[step]]", "Unknown field of a story 'step'"),
    ("title", "=", "it is not a TOML file"),
])
def test_an_error_of_a_story_names_step_and_field(tmp_path: Path, change: str, to: str, told: str) -> None:
    path = tmp_path / "bad.toml"
    path.write_text(GOOD.replace(change, to, 1))
    with pytest.raises(BadInput) as refused:
        read_story(path, OVERLAYS)
    assert told in str(refused.value)
    found, sentences = stories(OVERLAYS, tmp_path)
    assert found == () and sentences[0].startswith("bad.toml: ")
