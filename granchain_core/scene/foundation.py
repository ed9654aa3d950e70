"""The foundation's k and κ = k/(K√A₀) say the same at one amplitude only: what a moved A₀ does to κ, in words."""

from __future__ import annotations

from .model import Scene


def moved_kappa(before: Scene, after: Scene) -> str:
    """What κ was before A₀ moved and k stayed; empty where that is not what happened, or without a foundation."""
    if after.A0 == before.A0 or after.k != before.k or after.k == 0.0:
        return ""
    return f"κ was {before.kappa:.4g}; A₀ moved, not k"
