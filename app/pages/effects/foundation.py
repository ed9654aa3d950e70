"""k and κ = k/(K√A₀) say the same thing at one amplitude only: what a moved A₀ does to κ, in words."""

from __future__ import annotations

import math
from collections.abc import Collection

from granchain_core import Scene, scene


def foundation_words(current: Scene) -> str:
    """The foundation frequency, or that there is none."""
    frequency = current.foundation_frequency
    return f"{frequency:.1f} Hz" if frequency > 0 and math.isfinite(frequency) else "none"


def beside_kappa(current: Scene) -> str:
    """For the page: what κ was before A₀ moved, where k is still the preset's; else nothing."""
    preset = scene(current.name)
    if current.A0 == preset.A0 or current.k != preset.k or current.k == 0.0:
        return ""
    return f"κ was {preset.kappa:.4g}; A₀ moved, not k"


def kept_spring(before: Scene, after: Scene, named: Collection[str]) -> str:
    """For the command line: what an A0 that was set without k or kappa did to kappa, in one sentence; else nothing."""
    if "A0" not in named or {"k", "kappa"} & set(named) or after.A0 == before.A0 or after.k == 0.0:
        return ""
    return (f"A0 was set and k stays {after.k:.6g} N/m, so kappa goes from {before.kappa:.6g} to {after.kappa:.6g}; "
            f"--set kappa={before.kappa:.6g} would keep it.")


def kept_along(current: Scene, *knobs: str) -> str:
    """For the command line: that kappa changes along a branch or map in A0, in one sentence; else nothing."""
    if "A0" not in knobs or {"k", "kappa"} & set(knobs) or current.k == 0.0:
        return ""
    return (f"A0 is moved and k stays {current.k:.6g} N/m, so kappa goes with 1/√A0; "
            f"it is {current.kappa:.6g} at {current.A0:g} m.")
