"""What several measurements of one motion's Lyapunov exponent decide together: the rule of single chains and batches.

A measurement whose error is too large for a decision is continued. One that is clearly chaotic decides by itself; any
other must agree with the one before it (regime_criteria.py).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..regime import Regime
from .regime_criteria import agree, clearly_chaotic, regime_from_exponents, undecided


@dataclass(eq=False)
class ExponentMeasurements:
    """Measurements of one motion so far.

    `latest` is the regime that the last complete measurement shows; `unfinished` holds the exponents (B,) of one whose
    error is too large for a decision.
    """

    latest: Regime | None = None
    unfinished: np.ndarray = field(default_factory=lambda: np.zeros(0))

    def add(self, exponents: np.ndarray, strobes: np.ndarray, run: int, last: bool = False) -> Regime | None:
        """The regime, if more exponents decide it.

        `exponents` (B,) are mean exponents per period of successive blocks, `strobes` (P, 2, N) the last ones of a
        motion that has run `run` periods. With `last` the measurement is not continued, however large its error.
        """
        measured = np.concatenate([self.unfinished, exponents])
        if undecided(measured) and not last:
            self.unfinished = measured
            return None
        self.unfinished = np.zeros(0)
        before, self.latest = self.latest, regime_from_exponents(measured, strobes, run)
        decided = clearly_chaotic(measured) or (before is not None and agree(self.latest, before))
        return self.latest if decided else None
