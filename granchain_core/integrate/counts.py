"""Counters of steps, evaluations, events and rejected steps."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..kernels.status import EVALUATIONS, EVENTS, STEPS


@dataclass
class Counts:
    """Counters of a computation: accepted steps, evaluations of the equations, contact events, rejected steps."""

    array: np.ndarray = field(default_factory=lambda: np.zeros(4, dtype=np.int64))

    @property
    def by_name(self) -> dict[str, int]:
        """All four counters."""
        return dict(zip(("steps", "rhs", "events", "rejected"), map(int, self.array), strict=True))

    @property
    def steps(self) -> int:
        """Accepted steps."""
        return int(self.array[STEPS])

    @property
    def rhs(self) -> int:
        """Evaluations of the equations of motion."""
        return int(self.array[EVALUATIONS])

    @property
    def events(self) -> int:
        """Contact events located."""
        return int(self.array[EVENTS])
