"""Scenes by name, read from assets/scenes/*.toml: a parent and only the differences."""

from __future__ import annotations

import functools
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

from ..errors import BadInput, unknown_name
from ..quantities import QUANTITIES
from .description import Bead
from .model import Scene

_PACKAGE = Path(__file__).resolve().parents[1]
#: Scenes and measured data: beside the packages in the tree, within this one where it is installed.
ASSETS = next(place for place in (_PACKAGE / "assets", _PACKAGE.parent / "assets") if place.is_dir())
_SECTIONS = {"parent", "title", "look_at", "paper", "order", "chain", "knobs", "ranges"}


def _read(name: str) -> dict[str, Any]:
    """The TOML of one preset merged over its ancestors, section by section."""
    path = ASSETS / "scenes" / f"{name}.toml"
    data = tomllib.loads(path.read_text(encoding="utf-8"))
    unknown = set(data) - _SECTIONS
    if unknown:
        raise BadInput(f"{path.name}: unknown section {sorted(unknown)[0]!r}; known: {', '.join(sorted(_SECTIONS))}.")
    if "parent" not in data:
        return data
    base = _read(data["parent"])
    for section in ("chain", "knobs", "ranges"):
        base[section] = {**base.get(section, {}), **data.get(section, {})}
    own = data.get("knobs", {})
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
    """Names of all presets, in teaching order.

    Returns
    -------
    tuple of str
        Names that `scene` takes.

    Examples
    --------
    >>> from granchain_core import scene_names
    >>> scene_names()[:3]
    ('sec2', 'fig3a', 'fig3b')
    """
    names = [p.stem for p in (ASSETS / "scenes").glob("*.toml")]
    return tuple(sorted(names, key=lambda n: (_read(n).get("order", 1000), n)))


@functools.cache
def scene(name: str) -> Scene:
    """A preset by its name.

    Parameters
    ----------
    name : str
        One of `scene_names()`: "sec2", "fig3a", "rig", … (files in assets/scenes).

    Returns
    -------
    Scene
        A frozen description in SI; `evolve` gives one with other knobs.

    Raises
    ------
    BadInput
        There is no such scene; the message names the nearest one.

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
    if name not in scene_names():
        raise unknown_name("scene", name, scene_names())
    data = _read(name)
    chain, knobs = data["chain"], dict(data["knobs"])
    kappa = knobs.pop("kappa", None)
    new = Scene(
        name=name, title=data["title"], look_at=data["look_at"], paper=data["paper"],
        pattern=tuple(Bead(**b) for b in chain["pattern"]),
        impurities=tuple((i["place"], Bead(**{k: v for k, v in i.items() if k != "place"}))
                         for i in chain.get("impurities", ())),
        start_velocity=tuple((int(v["place"]), float(v["velocity"])) for v in chain.get("start_velocity", ())),
        reference_overlap=chain["reference_overlap"],
        ranges=tuple((knob, float(low), float(high)) for knob, (low, high) in data["ranges"].items()),
        **{"k": 0.0, **knobs},
    )
    new = new.evolve(**{n: v for n, v in new.knobs.items() if n != "kappa"})  # presets are checked like user input
    if kappa is not None:
        new = new.evolve(kappa=kappa)
    return replace(new, preset=tuple((n, new.knobs[n]) for n in QUANTITIES))
