"""The trail of multipliers: those of earlier orbits, fading with age."""

from __future__ import annotations

import numpy as np

#: Most sets of multipliers in the trail.
_MOST_SETS = 14
#: Sets that differ by less than this are of the same orbit.
_SAME_SET = 1e-4


class Trail:
    """Sets of multipliers with the period of their orbit, oldest first; another scene starts a new trail."""

    def __init__(self) -> None:
        self._sets: list[tuple[int, np.ndarray]] = []
        self._last: tuple[int, np.ndarray] | None = None
        self._scene = ""

    def follow(self, multipliers: np.ndarray, period: int, scene: str) -> None:
        """Add the multipliers of the orbit that the chain now follows."""
        if scene != self._scene:
            self._sets, self._last, self._scene = [], None, scene
        if self._last is not None and not _same(self._last[1], multipliers):
            self._sets = [*self._sets, self._last][-_MOST_SETS:]
        self._last = period, multipliers

    def before(self, period: int) -> list[np.ndarray]:
        """Return earlier sets of multipliers of orbits of this period, oldest first."""
        return [multipliers for n, multipliers in self._sets if n == period]


def _same(multipliers: np.ndarray, other: np.ndarray) -> bool:
    return multipliers.shape == other.shape and bool((np.abs(multipliers - other) < _SAME_SET).all())
