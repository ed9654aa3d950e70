"""Scenes by name from assets/scenes/*.toml, each given by a parent and differences, and scenes from a user's file."""

from __future__ import annotations

import functools
import os
from pathlib import Path
from typing import Any

from ..errors import BadInput
from ..inputs.checks import unknown_name
from .files import TABLES, built, toml_of
from .model import Scene

_PACKAGE = Path(__file__).resolve().parents[1]
#: Folder of scenes and measured data: next to the packages in the source tree, inside this package when installed.
ASSETS = next(place for place in (_PACKAGE / "assets", _PACKAGE.parent / "assets") if place.is_dir())


def _read(name: str) -> dict[str, Any]:
    """Return the TOML of one preset merged over its ancestors, section by section."""
    return _over_parent(toml_of(ASSETS / "scenes" / f"{name}.toml"))


def _over_parent(data: dict[str, Any]) -> dict[str, Any]:
    """Return the sections of a scene merged over those of its parent, if it has one."""
    if "parent" not in data:
        return data
    base = _read(data["parent"])
    own = data.get("knobs", {})
    for section in TABLES:
        base[section] = {**base.get(section, {}), **data.get(section, {})}
    if "kappa" in own:
        base["knobs"].pop("k", None)
    elif "k" in own:
        base["knobs"].pop("kappa", None)
    for word in ("title", "look_at", "paper", "order"):
        if word in data:
            base[word] = data[word]
    return base


@functools.cache
def scene_names() -> tuple[str, ...]:
    """Return the names of all presets, in teaching order.

    Returns
    -------
    tuple of str
        Names that `scene` accepts.

    Examples
    --------
    >>> from granchain_core import scene_names
    >>> scene_names()[:3]
    ('sec2', 'fig3a', 'fig3b')
    """
    names = [p.stem for p in (ASSETS / "scenes").glob("*.toml")]
    return tuple(sorted(names, key=lambda n: (_read(n).get("order", 1000), n)))


def question_of(name: str) -> str:
    """Return the question that this scene asks its viewer."""
    return str(toml_of(ASSETS / "scenes" / f"{name}.toml").get("question", ""))


def scene(name: str | os.PathLike[str]) -> Scene:
    """Return a preset by its name, or the scene in a file.

    Parameters
    ----------
    name : str or path-like
        One of `scene_names()`: "sec2", "fig3a", "rig", … (files in assets/scenes), or a `pathlib.Path` to a scene file
        (docs/scene-file.md). The scene in "mine.toml" is called "mine". A string is never interpreted as a path.

    Returns
    -------
    Scene
        A frozen description in SI units; `evolve` returns one with other knobs.

    Raises
    ------
    BadInput
        There is no such scene (the message suggests the nearest one), or the file is unusable (the message says why).

    Examples
    --------
    >>> from granchain_core import scene
    >>> chain = scene("sec2")
    >>> chain.N, chain.f, chain.A0
    (11, 340.0, 5e-07)
    >>> scene("sec22")
    Traceback (most recent call last):
    ...
    granchain_core.errors.BadInput: Unknown scene 'sec22'; the nearest is 'sec2'; known: ...
    """
    return _preset(name) if isinstance(name, str) else _from_file(Path(name))


@functools.cache
def _preset(name: str) -> Scene:
    if name not in scene_names():
        raise unknown_name("scene", name, scene_names())
    return built(name, _read(name))


def _from_file(path: Path) -> Scene:
    """Return the scene in a user's file, read again each time; its texts are not inherited from its parent."""
    data, name = toml_of(path), path.stem
    try:
        if name in scene_names():
            raise BadInput(f"the name {name!r} belongs to a scene of granchain; give the file another one.")
        if "parent" in data and data["parent"] not in scene_names():
            raise unknown_name("parent", data["parent"], scene_names())
        texts = {"title": data.get("title", name), "look_at": data.get("look_at", ""), "paper": data.get("paper", "")}
        return built(name, {**_over_parent(data), **texts})
    except BadInput as problem:
        raise BadInput(f"{path.name}: {problem}") from None
