"""k and kappa = k/(K√A0) say the same thing at one amplitude only: what a moved A0 does to kappa, in words."""

from __future__ import annotations

from collections.abc import Collection

from granchain_core import Scene


def kept_spring(before: Scene, after: Scene, named: Collection[str]) -> str:
    """What an A0 that was set without k or kappa did to kappa, in one sentence; else nothing."""
    if "A0" not in named or {"k", "kappa"} & set(named) or after.A0 == before.A0 or after.k == 0.0:
        return ""
    return (f"A0 was set and k stays {after.k:.6g} N/m, so kappa goes from {before.kappa:.6g} to {after.kappa:.6g}; "
            f"--set kappa={before.kappa:.6g} would keep it.")


def kept_along(current: Scene, *knobs: str) -> str:
    """That kappa changes along a branch or map in A0, in one sentence; else nothing."""
    if "A0" not in knobs or {"k", "kappa"} & set(knobs) or current.k == 0.0:
        return ""
    return (f"A0 is moved and k stays {current.k:.6g} N/m, so kappa goes with 1/√A0; "
            f"it is {current.kappa:.6g} at {current.A0:g} m.")
