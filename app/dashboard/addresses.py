"""What an address says is on the screen, taken over by a session: at a visit, and for every step back or forward."""

from __future__ import annotations

from granchain_core import BadInput, State

from ..pages.stories.page import story_places
from ..session.pins import Pin, read_pin
from ..session.session import Session
from ..session.share import EXTRAS, PINS, START, decode
from ..session.starts import read_start
from .table import overlay_names, tab_names


def take_address(session: Session, query: str) -> tuple[State | None, list[str]]:
    """Make the session what an address says; what that leaves out gets its default.

    Returns the state in which the motion begins, None for rest, and a sentence for every field that was refused.
    """
    places = {"tab": tab_names(), "page": overlay_names(), "embed": ("1",)}
    scene, fields, sentences = decode(query, {**places, "story": story_places()})
    view = {name: fields.get(name, values[0]) for name, values in EXTRAS.items()}
    session.scene = scene
    session.mode, session.start, session.scale = view["mode"], view["start"], view["scale"]
    session.curves, session.theme = view["curves"], view["look"]
    session.speed, session.account = float(view["speed"]), view["account"] == "on"
    session.place = {name: fields[name] for name in places if name in fields}
    session.story = fields.get("story", "")
    session.pins = tuple(_pins([fields[name] for name in PINS if name in fields], sentences))
    session.picture, session.started_from = None, None
    try:
        start = read_start(fields[START], scene) if START in fields else None
    except BadInput as problem:
        sentences.append(str(problem))
        start = None
    return start, sentences


def _pins(texts: list[str], sentences: list[str]) -> list[Pin]:
    found = []
    for text in texts:
        try:
            found.append(read_pin(text))
        except BadInput as problem:
            sentences.append(str(problem))
    return found
