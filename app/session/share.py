"""Share links: scene, knobs that differ from it, and view settings in one versioned query string.

A link stores differences only, so a changed preset changes the meaning of old links (tests/session/test_share.py).
Each field is checked separately: a bad field is refused with a sentence, and the other fields are used.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any
from urllib.parse import parse_qsl, urlencode

from granchain_core import BadInput, Scene, scene
from granchain_core.inputs.checks import unknown_name
from granchain_core.scene.quantities import QUANTITIES
from granchain_core.steady.curve.order import CURVE_STARTS

from ..plots.theme import THEMES

VERSION = "1"
#: The scene of a page that is opened without a link.
DEFAULT_SCENE = "sec2"
#: Items in the curve's figure: curves from rest and by sweeps, and the features that the paper states.
CURVES = (*CURVE_STARTS, "features")


def joined(names: Iterable[str]) -> str:
    """Return a choice of curves as text for a link."""
    chosen = set(names)
    return ".".join(name for name in CURVES if name in chosen) or "none"


#: Drive periods that the page can show per second; the first is the default.
SPEEDS = (1.0, 0.1, 0.25, 0.5, 2.0, 5.0, 20.0, 100.0)


@dataclass(frozen=True)
class ViewField:
    """A view setting of a link: its values, with the default first, and the attribute of `Session` that stores it.

    `read` converts the link's text to the attribute, and `text` the attribute to text.
    """

    attribute: str
    values: tuple[str, ...]
    read: Callable[[str], object] = str
    text: Callable[[Any], str] = str


#: The view settings by their names in a link; a new setting needs a row here and an attribute of `Session`. Links call
#: the theme "look"; with "auto", the browser chooses it. "curves" has every combination; with "auto", a scene shows its
#: own curves.
VIEW: dict[str, ViewField] = {
    "mode": ViewField("mode", ("settled", "live")),
    "start": ViewField("start", ("rest", "previous")),
    "scale": ViewField("scale", ("same", "fit")),
    "curves": ViewField("curves", ("auto", *sorted({joined(some) for size in range(len(CURVES) + 1)
                                                    for some in combinations(CURVES, size)}))),
    "look": ViewField("theme", ("auto", *THEMES)),
    "speed": ViewField("speed", tuple(f"{speed:g}" for speed in SPEEDS), float, lambda speed: f"{speed:g}"),
    "account": ViewField("energy_account", ("off", "on"), lambda text: text == "on", lambda on: "on" if on else "off"),
}
#: Fields that the browser adds to a link, because only the browser knows them (`parts/inline_scripts/address.js`): the
#: open tab, the overlay, the theme that the visitor has chosen, and whether another page embeds this one.
BROWSER_FIELDS = ("tab", "page", "look", "embed")
#: The values of the view settings; the first is the default.
VIEW_VALUES: dict[str, tuple[str, ...]] = {name: field.values for name, field in VIEW.items()}
#: Field for the state in which the motion began, a text that `initial_state.py` reads.
INITIAL_STATE = "from"
#: Fields for the pinned pictures, texts that `pins.py` reads.
PINS = ("pin", "pin2", "pin3")
#: Field for the question of the Analysis page, a text that `pages/analysis/questions.py` reads.
QUESTION = "question"
#: Largest number of characters in a link.
LONGEST_LINK = 4500
#: Number of characters reserved in a link for `BROWSER_FIELDS`; tests/dashboard/test_table.py compares it with the
#: longest values.
_ADDED_BY_BROWSER = 100


def encode(shown: Scene, view: Mapping[str, str], texts: Mapping[str, str] | None = None) -> str:
    """Return the query string (without "?") that restores this scene and view.

    `texts` has `INITIAL_STATE`, `PINS`, `QUESTION` and "story". If there is no room for all pins, the last are left out
    (`pins_in`).
    """
    fields: dict[str, Any] = {"v": VERSION, "scene": shown.name}
    for name, value in shown.differences().items():
        fields[name] = value if isinstance(value, str) else repr(value)
    for name, value in view.items():
        if name in VIEW_VALUES and value in VIEW_VALUES[name] and value != VIEW_VALUES[name][0]:
            fields[name] = value
    fields.update({name: text for name, text in (texts or {}).items() if text})
    query = urlencode(fields)
    for name in reversed(PINS):
        if len(query) + _ADDED_BY_BROWSER <= LONGEST_LINK:
            break
        if fields.pop(name, None):
            query = urlencode(fields)
    return query


def pins_in(query: str) -> int:
    """Return the number of pins in a link."""
    return sum(name in PINS for name, _ in parse_qsl(query))


def decode(query: str, more: Mapping[str, Sequence[str]] | None = None) -> tuple[Scene, dict[str, str], list[str]]:
    """Return scene, view fields, and one sentence for every refused field. Texts are not read here.

    `more` has further view settings with their values, which only the page knows.
    """
    known = {**VIEW_VALUES, **(more or {})}
    if len(query) > LONGEST_LINK:
        return scene(DEFAULT_SCENE), {}, [f"The link is longer than {LONGEST_LINK} characters and was not read."]
    refused: list[str] = []
    fields = _fields(query, refused)
    if fields.pop("v", VERSION) != VERSION:
        refused.append(f"The link's format is not version {VERSION}; only the fields that are understood were used.")
    shown = _scene(fields.pop("scene", DEFAULT_SCENE), refused)
    view: dict[str, str] = {}
    # kappa comes last: it is converted with the A0 of the link, and replaces k only if it is valid
    for name, text in sorted(fields.items(), key=lambda field: field[0] == "kappa"):
        if name in (INITIAL_STATE, QUESTION, *PINS):
            view[name] = text
            continue
        if name in known:
            if text in known[name]:
                view[name] = text
            else:
                refused.append(f"{name} = {text[:40]!r} in the link is not one of {', '.join(known[name])}.")
            continue
        if name not in QUANTITIES:
            fields_known = ("scene", *known, INITIAL_STATE, QUESTION, *PINS, *QUANTITIES)
            refused.append(f"In the link: {unknown_name('field', name, fields_known)}")
            continue
        try:
            shown = shown.evolve(**{name: text})
        except BadInput as problem:
            refused.append(f"In the link: {problem}")
            continue
        if name == "kappa" and "k" in fields:
            refused.append("The link sets both k and kappa, which are the same quantity; kappa was used.")
    return shown, view, refused


def _fields(query: str, refused: list[str]) -> dict[str, str]:
    """Return the fields of a query string; if a field occurs twice, the first counts."""
    fields: dict[str, str] = {}
    for name, text in parse_qsl(query.lstrip("?"), keep_blank_values=True):
        if name in fields:
            refused.append(f"{name[:40]} occurs twice in the link; the first value, {fields[name][:40]!r}, was used.")
        else:
            fields[name] = text
    return fields


def _scene(name: str, refused: list[str]) -> Scene:
    try:
        return scene(name)
    except BadInput as problem:
        refused.append(f"In the link: {problem}")
        return scene(DEFAULT_SCENE)


if {*VIEW_VALUES, INITIAL_STATE, QUESTION, *PINS} & set(QUANTITIES):
    raise RuntimeError("a view setting has the name of a knob")
