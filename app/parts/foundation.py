"""What stands beside the knobs k and κ = k/(K√A₀): the foundation's frequency, and what a moved A₀ did to κ."""

from __future__ import annotations

import math

from granchain_core import Scene, scene


def foundation_words(current: Scene) -> str:
    """The foundation frequency, or that there is none."""
    frequency = current.foundation_frequency
    return f"{frequency:.1f} Hz" if frequency > 0 and math.isfinite(frequency) else "none"


def beside_kappa(current: Scene) -> str:
    """What κ was before A₀ moved, where k is still the preset's; else nothing."""
    preset = scene(current.name)
    if current.A0 == preset.A0 or current.k != preset.k or current.k == 0.0:
        return ""
    return f"κ was {preset.kappa:.4g}; A₀ moved, not k"
