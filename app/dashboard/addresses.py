"""Sets a session from an address: when its page is opened, and at every step back or forward."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TypeVar
from urllib.parse import parse_qsl

from granchain_core import BadInput, State

from .. import former_names
from ..former_names import present_tab
from ..pages.analysis.questions import read_question
from ..pages.stories.page import story_places, story_step
from ..session.initial_state import read_initial_state
from ..session.pins import Pin, read_pin
from ..session.session import Session
from ..session.share import BROWSER_FIELDS, INITIAL_STATE, PINS, QUESTION, decode
from .table import overlay_names, tab_names

T = TypeVar("T")

#: Fields that do not determine the motion. A link with a story and no other fields than these, such as people write by
#: hand, shows the motion of the story's step.
_NOT_A_MOTION = {"v", "story", *BROWSER_FIELDS}


def apply_address(session: Session, query: str) -> tuple[State | None, list[str]]:
    """Set a session from an address; fields that the address leaves out get their defaults.

    Returns the state in which the motion begins (None for rest), and a sentence for every refused field.
    """
    names = (*tab_names(), *(row.former for row in former_names.TABS))
    places = {"tab": names, "page": names, "embed": ("1",)}
    scene, fields, sentences = decode(query, {**places, "story": story_places(overlay_names())})
    session.scene = scene
    session.story_to_settle = False
    if "story" in fields and {name for name, _ in parse_qsl(query.lstrip("?"))} <= _NOT_A_MOTION:
        step = story_step(fields["story"], overlay_names())
        session.scene, session.story_to_settle = step.scene, bool(step.via)
        fields = {**({"curves": step.curves} if step.curves else {}), **fields}
    session.apply_view(fields)
    session.place = {name: present_tab(fields[name]) for name in places if name in fields}
    if session.place.get("page", "") not in ("", *overlay_names()):  # a page without an overlay has only a tab
        session.place["tab"] = session.place.pop("page")
    session.story = fields.get("story", "")
    session.pins = tuple(_pins([fields[name] for name in PINS if name in fields], sentences))
    session.question = fields.get(QUESTION, "")
    if session.question and _read(lambda: read_question(session.question, scene), sentences) is None:
        session.question = ""
    session.settled, session.initial_state = None, None
    if INITIAL_STATE not in fields:
        return None, sentences
    return _read(lambda: read_initial_state(fields[INITIAL_STATE], scene), sentences), sentences


def _pins(texts: list[str], sentences: list[str]) -> list[Pin]:
    pins = (_read(partial(read_pin, text), sentences) for text in texts)
    return [pin for pin in pins if pin is not None]


def _read(read: Callable[[], T], sentences: list[str]) -> T | None:
    """Return the result of `read`; None if it raises `BadInput`, whose sentence is appended to `sentences`."""
    try:
        return read()
    except BadInput as problem:
        sentences.append(str(problem))
        return None
