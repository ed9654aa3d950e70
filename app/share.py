"""Share links: the scene's name, the knobs that differ from it, and the view, as one versioned query string.

Every field is checked by itself: a bad one is refused with its sentence and the others still count.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any
from urllib.parse import parse_qsl, urlencode

from granchain_core import BadInput, Scene, scene, scene_names
from granchain_core.quantities import QUANTITIES

VERSION = "1"
#: View settings a link may carry and what they may be; the first is what an old link means.
EXTRAS: dict[str, tuple[str, ...]] = {
    "mode": ("settled", "live"),
    "start": ("rest", "previous"),
    "look": ("auto", "light", "dark", "projector"),
}
_LONGEST = 2000


def encode(shown: Scene, extras: Mapping[str, str]) -> str:
    """The query string (without "?") that brings back this scene and view."""
    fields: dict[str, Any] = {"v": VERSION, "scene": shown.name}
    for name, value in shown.differences().items():
        fields[name] = value if isinstance(value, str) else repr(value)
    for name, value in extras.items():
        if name in EXTRAS and value in EXTRAS[name] and value != EXTRAS[name][0]:
            fields[name] = value
    return urlencode(fields)


def decode(query: str) -> tuple[Scene, dict[str, str], list[str]]:
    """Scene, view settings, and one sentence for every field that was refused."""
    if len(query) > _LONGEST:
        return scene(scene_names()[0]), {}, [f"The link is longer than {_LONGEST} characters and was not read."]
    fields = dict(parse_qsl(query.lstrip("?"), keep_blank_values=True))
    refused: list[str] = []
    if fields.pop("v", VERSION) != VERSION:
        refused.append(f"The link is of another version than {VERSION}; what is understood of it is shown.")
    base = _scene(fields.pop("scene", scene_names()[0]), refused)
    extras: dict[str, str] = {}
    for name, text in fields.items():
        if name in EXTRAS:
            if text in EXTRAS[name]:
                extras[name] = text
            else:
                refused.append(f"{name} = {text[:40]!r} in the link is not one of {', '.join(EXTRAS[name])}.")
            continue
        try:
            if name == "k" and "kappa" in fields:
                raise BadInput("k and kappa in the link say the same thing; kappa was used.")
            base = base.evolve(**{name: text})
        except BadInput as problem:
            refused.append(f"In the link: {problem}")
    if "kappa" in fields and "A0" in fields:
        base = _again(base, fields["kappa"])
    return base, extras, refused


def _scene(name: str, refused: list[str]) -> Scene:
    try:
        return scene(name)
    except BadInput as problem:
        refused.append(f"In the link: {problem}")
        return scene(scene_names()[0])


def _again(base: Scene, kappa: str) -> Scene:
    """kappa once more, now that the scene has its own A0; it was refused before if it is bad."""
    try:
        return base.evolve(kappa=kappa)
    except BadInput:
        return base


if set(EXTRAS) & set(QUANTITIES):
    raise RuntimeError("a view setting has the name of a knob")
