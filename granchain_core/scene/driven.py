"""The refusal of a scene without a drive, for computations that need one."""

from __future__ import annotations

from ..errors import BadInput
from .description import Description
from .given import require_scene


def refuse_undriven(scene: Description) -> None:
    """`BadInput` for a scene whose driver is at rest: its motion has no period, no orbit and no resonance curve."""
    require_scene(scene)
    if not scene.is_driven:
        raise BadInput(f"Scene {scene.name!r} has drive = rest: it only moves from its start, so there is no steady "
                       "state, orbit or resonance curve; the nearest valid value is drive = harmonic, or use "
                       "granchain run.")
