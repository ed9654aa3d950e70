"""Refusals of values that are not scenes, and of scenes without a drive where a computation needs one."""

from __future__ import annotations

from ..errors import BadInput
from .description import Description


def require_scene(value: object) -> None:
    """Raise `BadInput` for anything but a scene; if it is the name of one, the message says how to get that scene."""
    if isinstance(value, Description):
        return
    from .presets import scene_names  # imported late: it builds scenes, which are checked here

    near = value if isinstance(value, str) and value in scene_names() else "sec2"
    raise BadInput(f"A chain is given as a Scene, not as {_shown(value)}; scene({near!r}) is one.")


def refuse_undriven(scene: Description) -> None:
    """Raise `BadInput` for a scene whose driver is at rest: it has no drive period, no orbit and no resonance curve."""
    require_scene(scene)
    if not scene.is_driven:
        raise BadInput(f"Scene {scene.name!r} has drive = rest: it only moves from its start, so there is no steady "
                       "state, orbit or resonance curve; the nearest valid value is drive = harmonic, or use "
                       "granchain run.")


def _shown(value: object) -> str:
    """Return the text itself, or the type of any other value."""
    return repr(value[:40]) if isinstance(value, str) else f"a value of type {type(value).__name__}"
