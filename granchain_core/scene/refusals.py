"""Refusals of what is no scene, and of scenes without a drive where a computation needs one."""

from __future__ import annotations

from ..errors import BadInput
from .description import Description


def require_scene(value: object) -> None:
    """`BadInput` for anything but a scene; where it is the name of one, its sentence says how to get it."""
    if isinstance(value, Description):
        return
    from .presets import scene_names  # which builds scenes, and these are checked here

    near = value if isinstance(value, str) and value in scene_names() else "sec2"
    raise BadInput(f"A chain is given as a Scene, not as {_shown(value)}; scene({near!r}) is one.")


def refuse_undriven(scene: Description) -> None:
    """`BadInput` for a scene whose driver is at rest: its motion has no period, no orbit and no resonance curve."""
    require_scene(scene)
    if not scene.is_driven:
        raise BadInput(f"Scene {scene.name!r} has drive = rest: it only moves from its start, so there is no steady "
                       "state, orbit or resonance curve; the nearest valid value is drive = harmonic, or use "
                       "granchain run.")


def _shown(value: object) -> str:
    """A text itself, and of anything else its type."""
    return repr(value[:40]) if isinstance(value, str) else f"a value of type {type(value).__name__}"
