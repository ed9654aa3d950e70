"""What a link with nothing but the name of a scene means: tests/session/links.json.

A link that was sent keeps only what differs from its scene, so a scene must not change its meaning. The file has the
knobs and beads of `sec2`, and of every other scene those that differ. A row is added when a scene is new and is never
written again.
"""

from __future__ import annotations

import json
from dataclasses import astuple
from pathlib import Path
from typing import Any

from granchain_core import Scene, scene, scene_names

FILE = Path(__file__).resolve().parents[1] / "tests" / "session" / "links.json"


def meaning(chain: Scene) -> dict[str, Any]:
    """Knobs and beads (mass, radius, young, poisson) of `sec2`; those of another scene that differ from them."""
    found = {**chain.knobs, "beads": [list(astuple(bead)) for bead in chain.pattern]}
    if chain.name == "sec2":
        return found
    usual = meaning(scene("sec2"))
    return {name: value for name, value in found.items() if value != usual[name]}


def with_new_scenes() -> str:
    """The file's text with a row for every scene that has none."""
    rows = json.loads(FILE.read_text(encoding="utf-8"))
    rows |= {name: meaning(scene(name)) for name in scene_names() if name not in rows}
    lines = (f"  {json.dumps(name)}: {json.dumps(row)}" for name, row in rows.items())
    return "{\n" + ",\n".join(lines) + "\n}\n"
