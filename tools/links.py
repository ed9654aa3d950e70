"""The meaning of a link that contains only the name of a scene: tests/session/links.json.

A share link contains only the differences from its scene, so the meaning of a scene must not change. The file has the
knobs and beads of `sec2` and, for every other scene, those that differ. A row is added for a new scene and is never
changed afterwards.
"""

from __future__ import annotations

import json
from dataclasses import astuple
from pathlib import Path
from typing import Any

from granchain_core import Scene, scene, scene_names

FILE = Path(__file__).resolve().parents[1] / "tests" / "session" / "links.json"


def meaning(chain: Scene) -> dict[str, Any]:
    """Return the knobs and beads (mass, radius, young, poisson) of `sec2`; of another scene, those that differ."""
    found = {**chain.knobs, "beads": [list(astuple(bead)) for bead in chain.pattern]}
    if chain.name == "sec2":
        return found
    usual = meaning(scene("sec2"))
    return {name: value for name, value in found.items() if value != usual[name]}


def with_new_scenes() -> str:
    """Return the file's text with a row added for every scene without one."""
    rows = json.loads(FILE.read_text(encoding="utf-8"))
    rows |= {name: meaning(scene(name)) for name in scene_names() if name not in rows}
    lines = (f"  {json.dumps(name)}: {json.dumps(row)}" for name, row in rows.items())
    return "{\n" + ",\n".join(lines) + "\n}\n"
