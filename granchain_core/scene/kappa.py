"""Sentences about κ = k/(K√A₀): at constant k it changes with the drive amplitude A₀."""

from __future__ import annotations

from .model import Scene


def moved_kappa(before: Scene, after: Scene) -> str:
    """κ before A₀ changed at constant k, in words; empty if A₀ did not change, k did, or there is no foundation."""
    if after.A0 == before.A0 or after.k != before.k or after.k == 0.0:
        return ""
    return f"κ was {before.kappa:.4g} before A₀ changed at constant k"
