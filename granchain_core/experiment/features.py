"""Features of the measured resonance curve that the paper's text states: their kinds and frequencies."""

from __future__ import annotations

import functools
import tomllib
from dataclasses import dataclass

from ..scene import ASSETS


@dataclass(frozen=True)
class Feature:
    """One stated feature: frequency [Hz], kind, number of repeated tests, and where the text states it."""

    frequency: float
    kind: str
    repeats: int
    source: str
    quantity: str = "frequency of a local extremum of the maximum transmitted force; no force is stated"

    @property
    def is_resonance(self) -> bool:
        """Whether the extremum is a peak (rather than a valley)."""
        return "anti" not in self.kind


@functools.cache
def stated_features() -> tuple[Feature, ...]:
    """Return all features in assets/experiment/zhang-2016.toml, in ascending frequency."""
    data = tomllib.loads((ASSETS / "experiment" / "zhang-2016.toml").read_text(encoding="utf-8"))
    return tuple(Feature(**f) for f in sorted(data["feature"], key=lambda f: f["frequency"]))
