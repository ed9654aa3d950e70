"""The notes next to the knobs k and κ = k/(K√A₀): the foundation's frequency, and how a new A₀ changed κ."""

from __future__ import annotations

import math

from granchain_core import Scene, scene
from granchain_core.scene.validity import moved_kappa


def foundation_words(current: Scene) -> str:
    """Return the foundation frequency in words, or "none"."""
    frequency = current.foundation_frequency
    return f"{frequency:.1f} Hz" if frequency > 0 and math.isfinite(frequency) else "none"


def beside_kappa(current: Scene) -> str:
    """Return the preset's κ, in words, if A₀ has moved since and k has not; otherwise an empty string."""
    return moved_kappa(scene(current.name), current)
