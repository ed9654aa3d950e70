"""Sentences about kappa = k/(K√A0), which changes with A0, for commands that set either of them."""

from __future__ import annotations

from collections.abc import Collection

from granchain_core import Scene
from granchain_core.scene.validity import moved_kappa


def kappa_changed_by_amplitude(before: Scene, after: Scene, named: Collection[str]) -> str:
    """Say how a new A0 changed kappa and how to keep it; return "" if A0 did not change, or k or kappa was set too."""
    notice = "" if {"k", "kappa"} & set(named) else moved_kappa(before, after)
    return notice and f"{notice}. It is {after.kappa:.6g} now; --set kappa={before.kappa:.6g} keeps it."


def kappa_changes_along(current: Scene, *knobs: str) -> str:
    """Say that kappa changes along a branch or map in A0 at constant k; return "" if it does not."""
    if "A0" not in knobs or {"k", "kappa"} & set(knobs) or current.k == 0.0:
        return ""
    return (f"A0 varies at constant k = {current.k:.6g} N/m, so kappa is proportional to 1/√A0; "
            f"it is {current.kappa:.6g} at A0 = {current.A0:g} m.")
