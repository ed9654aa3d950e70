"""What a change of the drive amplitude A₀ does to κ = k/(K√A₀), in words: k stays, so κ moves."""

from __future__ import annotations

from .model import Scene


def moved_kappa(before: Scene, after: Scene) -> str:
    """κ before A₀ moved while k stayed, in words; empty where something else moved, or without a foundation."""
    if after.A0 == before.A0 or after.k != before.k or after.k == 0.0:
        return ""
    return f"κ was {before.kappa:.4g}; A₀ moved, not k"
