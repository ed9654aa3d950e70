"""Scales of the pictures: one for all pictures of a scene, or one for each picture.

*same*: the scale of a scene has the largest values of its pictures over the whole range of f, from rest, at the knobs
of its preset (`assets/scales.toml`, computed by `tools/scales.py`). The scale does not change while knobs move, so
strong motion looks strong and weak motion weak. A picture with a larger value widens the scale, until the scene is
opened again or the scale is chosen again.

*fit*: every picture is drawn to its own largest values.
"""

from __future__ import annotations

import tomllib
from functools import cache

from granchain_core import Scene
from granchain_core.scene import ASSETS

from ..frames import Extremes, Frames
from ..session.session import Session

FILE = ASSETS / "scales.toml"
#: Key of the digest of a table's scene; a test compares the digest with that of the preset.
DIGEST = "scene_digest"


@cache
def _of_scenes() -> dict[str, Extremes]:
    """Return the largest values of every scene, by name."""
    tables = tomllib.loads(FILE.read_text(encoding="utf-8"))
    return {name: Extremes(**{key: value for key, value in table.items() if key != DIGEST})
            for name, table in tables.items()}


class PictureScales:
    """The scales of one session's pictures, by the visitor's choice, "same" or "fit"."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._scene = ""
        self._largest = Extremes()

    @property
    def fit(self) -> bool:
        """Whether every picture is drawn to its own largest values."""
        return self._session.scale == "fit"

    def forget(self) -> None:
        """Return to the scene's own scale after larger values have widened it."""
        self._scene = ""

    def of(self, frames: Frames, scene: Scene) -> Extremes:
        """Return the largest values to which a picture of `scene` is drawn."""
        here = frames.extremes
        if self._scene != scene.name:
            self._scene, self._largest = scene.name, _of_scenes()[scene.name]
        if self.fit:
            return here
        self._largest = self._largest.widened(here)
        return self._largest
