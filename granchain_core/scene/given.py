"""The refusal of what is not a scene, where one was to be given."""

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


def _shown(value: object) -> str:
    """A text itself, and of anything else its type."""
    return repr(value[:40]) if isinstance(value, str) else f"a value of type {type(value).__name__}"
