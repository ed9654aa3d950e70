"""Guided stories, read from assets/stories/*.toml: scenes to look at, a question, and an answer.

The numbers of a story are in its file; tests/session/test_story_files.py computes them again. docs/stories.md describes
the format. Nothing in a file is trusted: a mistake becomes a sentence that says where it is.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from granchain_core import BadInput, Run, Scene, State, pulse, run, scene, settle
from granchain_core.execution.stop import Stop
from granchain_core.inputs.checks import unknown_name
from granchain_core.results.regime import NEVER_REPEATING
from granchain_core.scene import ASSETS

from .share import VIEW_VALUES

FOLDER = ASSETS / "stories"

#: Parts of the main page that a step may point to, by the names of their elements.
LOOKS = ("chain", "left", "map", "right", "curve")
#: Allowed relative difference between a computed force and the force in a story, if the motion repeats.
TOLERANCE = 5e-3
#: The same for a motion that does not repeat, whose largest force depends on the periods that are recorded.
IRREGULAR_TOLERANCE = 0.1
_STORY_FIELDS = ("title", "about", "order", "steps")
_STEP_FIELDS = ("say", "ask", "answer", "scene", "set", "via", "look", "curves", "page", "expect")
_EXPECT_FIELDS = ("regime", "period", "output", "input", "pulse", "speed")
#: The regime of a motion that nothing drives, as a story calls it.
UNDRIVEN = "undriven"
#: Samples in the time 1/f for which a pulse is followed.
_PULSE_SAMPLES = 4000
_NUMBER = re.compile(r"\{(?:(\d+)\.)?(\w+)\}")


@dataclass(frozen=True)
class Expect:
    """The expected motion of a step: regime and period, largest output and input force [N].

    Without a drive, also the largest force [N] and speed [m/s] of the first pulse in the middle of the chain.
    """

    regime: str
    period: int | None
    output: float
    input: float
    pulse: float | None = None
    speed: float | None = None


@dataclass(frozen=True)
class StoryStep:
    """One step. `via` has the frequencies [Hz] at which the chain first settles, one after another, from rest.

    `look` is the part of the main page that the step points to, and `page` the overlay that it offers to open.
    """

    say: str
    ask: str
    answer: str
    scene: Scene
    expect: Expect
    via: tuple[float, ...] = ()
    look: str = ""
    curves: str = ""
    page: str = ""


@dataclass(frozen=True)
class Story:
    """A sequence of steps under a title."""

    name: str
    title: str
    about: str
    order: int
    steps: tuple[StoryStep, ...] = field(repr=False)


def stories(pages: Sequence[str], folder: Path = FOLDER) -> tuple[tuple[Story, ...], tuple[str, ...]]:
    """Return all stories in order, and one sentence for every file that cannot be used.

    `pages` are the names of the pages that a step may offer to open.
    """
    known, refused = [], []
    for path in sorted(folder.glob("*.toml")):
        try:
            known.append(read_story(path, pages))
        except BadInput as problem:
            refused.append(f"{path.name}: {problem}")
    return tuple(sorted(known, key=lambda story: (story.order, story.name))), tuple(refused)


def read_story(path: Path, pages: Sequence[str]) -> Story:
    """Read a story from its file; its steps may open `pages`.

    Raises `BadInput` with one sentence for the first mistake.
    """
    try:
        data = tomllib.loads(path.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as problem:
        raise BadInput(f"it is not a TOML file: {problem}.") from None
    _known(data, _STORY_FIELDS, "a story")
    steps = data.get("steps")
    if not isinstance(steps, list) or not steps:
        raise BadInput("a story needs at least one [[steps]].")
    read = [_step(number, step, pages) for number, step in enumerate(steps, 1)]
    order = data.get("order", 100)
    if not isinstance(order, int):
        raise BadInput("order must be a whole number.")
    story = Story(path.stem, _text(data, "title", "the story"), _text(data, "about", "the story"), order, tuple(read))
    for number in range(1, len(read) + 1):
        for words in ("say", "ask", "answer"):
            told_words(story, number, words)
    return story


def told_words(story: Story, number: int, words: str) -> str:
    """Return `say`, `ask` or `answer` of step `number` (from 1) with its numbers: {output}, {2.output} of step 2, …"""

    def value(match: re.Match[str]) -> str:
        other = int(match[1] or number)
        if not 1 <= other <= len(story.steps):
            raise BadInput(f"step {number}: {match[0]} is of step {other}, but there are {len(story.steps)}.")
        step = story.steps[other - 1]
        repeats = step.expect.regime not in NEVER_REPEATING
        numbers = {"output": _force(step.expect.output, repeats), "input": _force(step.expect.input, repeats),
                   "share": f"{100 * step.expect.output / step.expect.input:.0f} %",
                   "f": f"{step.scene.f:g} Hz"}
        if step.expect.pulse is not None and step.expect.speed is not None:
            numbers |= {"pulse": _force(step.expect.pulse, repeats), "speed": f"{step.expect.speed:.3g} m/s"}
        if match[2] not in numbers:
            raise unknown_name("number", match[2], tuple(numbers))
        return numbers[match[2]]

    return _NUMBER.sub(value, getattr(story.steps[number - 1], words))


def state_before(step: StoryStep, stop: Stop | None = None) -> State | None:
    """Return the state in which a step's motion begins, reached at the last frequency of `via` (None for rest)."""
    state: State | None = None
    for frequency in step.via:
        state = settle(step.scene.evolve(f=frequency), start=state, stop=stop).state
    return state


def differences(step: StoryStep, shown: Run) -> list[str]:
    """Return sentences on how a run differs from what a step expects."""
    sentences, expected = [], step.expect
    regime = shown.regime.name if shown.regime.driven else UNDRIVEN
    if (regime, shown.regime.period) != (expected.regime, expected.period):
        sentences.append(f"it is {shown.regime.sentence}, not {expected.regime} {expected.period or ''}".rstrip() + ".")
    numbers = [("largest output force", "N", expected.output, shown.max_output_force),
               ("largest input force", "N", expected.input, shown.max_input_force)]
    if expected.pulse is not None and expected.speed is not None:
        first = pulse(run(step.scene, periods=0, record=1, samples=_PULSE_SAMPLES))
        middle = len(first.contact) // 2
        numbers += [("pulse's force", "N", expected.pulse, float(first.force[middle])),
                    ("pulse's speed", "m/s", expected.speed, float(first.speed_m_s[middle]))]
    allowed = IRREGULAR_TOLERANCE if regime in NEVER_REPEATING else TOLERANCE
    return sentences + [f"the {name} is {computed:.4g} {unit}, not {number:.4g} {unit}."
                        for name, unit, number, computed in numbers if abs(computed - number) > allowed * computed]


def _force(newtons: float, repeats: bool) -> str:
    """Return a force in newtons, so that steps can be compared; to two figures if the motion does not repeat."""
    return f"{newtons:.{3 if repeats else 2}g} N"


def _step(number: int, data: Any, pages: Sequence[str]) -> StoryStep:
    try:
        if not isinstance(data, dict):
            raise BadInput("it is not a table.")
        _known(data, _STEP_FIELDS, "a step")
        shown = scene(_text(data, "scene", "it")).evolve(**_table(data, "set"))
        via = data.get("via", [])
        if not isinstance(via, list):
            raise BadInput("via must be a list of frequencies in Hz.")
        for frequency in via:
            shown.evolve(f=frequency)
        if "expect" not in data:
            raise BadInput("it needs expect, the expected motion.")
        return StoryStep(_text(data, "say", "it"), str(data.get("ask", "")), str(data.get("answer", "")), shown,
                         _expect(_table(data, "expect")), tuple(map(float, via)),
                         _one_of(data, "look", ("", *LOOKS)), _one_of(data, "curves", ("", *VIEW_VALUES["curves"])),
                         _one_of(data, "page", ("", *pages)))
    except BadInput as problem:
        raise BadInput(f"step {number}: {problem}") from None


def _expect(data: dict[str, Any]) -> Expect:
    _known(data, _EXPECT_FIELDS, "expect")
    if "regime" not in data:
        raise BadInput("expect needs regime, the regime of the motion.")
    regime = _one_of(data, "regime", ("periodic", *NEVER_REPEATING, UNDRIVEN))
    period = data.get("period")
    if (period is None) == (regime == "periodic") or not isinstance(period, (int, type(None))):
        raise BadInput("only a periodic motion has a period, and it needs one: a whole number of drive periods.")
    _positive(data, "output", "the largest output force in N")
    _positive(data, "input", "the largest input force in N")
    if ("pulse" in data or "speed" in data) != (regime == UNDRIVEN):
        raise BadInput("only a motion without a drive has a pulse and its speed, and it needs both.")
    if regime == UNDRIVEN:
        _positive(data, "pulse", "the largest force of the pulse in the middle of the chain in N")
        _positive(data, "speed", "its speed there in m/s")
    return Expect(regime, period, data["output"], data["input"], data.get("pulse"), data.get("speed"))


def _positive(data: Mapping[str, Any], name: str, what: str) -> None:
    if not isinstance(data.get(name), float) or not data[name] > 0.0:
        raise BadInput(f"expect needs {name}, {what}, as a number with a decimal point.")


def _known(data: Mapping[str, Any], names: Sequence[str], what: str) -> None:
    for name in data:
        if name not in names:
            raise unknown_name(f"field of {what}", name, tuple(names))


def _text(data: Mapping[str, Any], name: str, what: str) -> str:
    value = data.get(name)
    if not isinstance(value, str) or not value.strip():
        raise BadInput(f"{what} needs {name}, a text.")
    return value.strip()


def _table(data: Mapping[str, Any], name: str) -> dict[str, Any]:
    value = data.get(name, {})
    if not isinstance(value, dict):
        raise BadInput(f"{name} must be a table.")
    return value


def _one_of(data: Mapping[str, Any], name: str, known: tuple[str, ...]) -> str:
    value = data.get(name, "")
    if value not in known:
        raise unknown_name(name, str(value), tuple(filter(None, known)))
    return str(value)
