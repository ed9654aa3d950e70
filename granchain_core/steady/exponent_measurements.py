"""The decision from several measurements of one motion's Lyapunov exponent: one rule for single chains and batches.

A measurement that does not suffice for a decision is continued. A clearly chaotic one decides alone, and so does a
quasi-periodic one that was continued, since it is as long as two. Any other must agree with the previous measurement
(regime_criteria.py).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..results.regime import Regime
from .lyapunov import block_means
from .regime_criteria import agree, clearly_chaotic, needs_more_periods, regime_from_exponents

#: [chaotic, quasi-periodic] Overlapping blocks in a measurement of the exponent (`block_means` in lyapunov.py). The
#: standard error of the mean is computed from them. A continued measurement has as many blocks, but longer ones.
EXPONENT_BLOCKS = 10
#: [chaotic, quasi-periodic] Drive periods of a measurement of the exponent, and of each continuation.
MEASURED_PERIODS = 220
#: [chaotic, quasi-periodic] First drive periods of a measurement with a new neighbour, which do not count: its offset
#: turns into the leading direction.
TURNING_PERIODS = 20


@dataclass(eq=False)
class ExponentMeasurements:
    """The measurements of one motion so far.

    `latest` is the regime that the last complete measurement shows, and `complete` the number of complete ones.
    `unfinished` is the growth (P,), period by period, of a measurement that does not suffice for a decision. `offset`
    (2(N+2),), scaled, leads to the neighbouring trajectory at the end of the last measurement, if the next one begins
    there and continues with this neighbour.
    """

    latest: Regime | None = None
    complete: int = 0
    offset: np.ndarray | None = None
    unfinished: np.ndarray = field(default_factory=lambda: np.zeros(0))

    def interrupted(self) -> None:
        """Drop the neighbour, because other periods pass before the next measurement.

        At another place of the closed curve, the old offset is not tangent to it, and may need hundreds of periods to
        turn back into the curve's direction.
        """
        self.offset = None

    @property
    def approach_rate(self) -> float:
        """Mean exponential rate per period at which neighbours approach, as on the way to an orbit; 0 if they do not.

        It comes from the last complete measurement.
        """
        latest = self.latest
        if latest is None or latest.name != "unsettled" or latest.lyapunov is None:
            return 0.0
        return max(0.0, -latest.lyapunov[0])

    def add(self, growth: np.ndarray, offset: np.ndarray, strobes: np.ndarray, periods_run: int,
            last: bool = False) -> Regime | None:
        """Add the growth (P,) in `MEASURED_PERIODS` more periods; return the regime if that decides it.

        `offset` leads to the neighbouring trajectory at their end. `strobes` (P, 2, N) are the last ones of a motion
        that has run `periods_run` periods. With `last`, the measurement is not continued, however large its error.
        """
        continued, turning = len(self.unfinished) > 0, TURNING_PERIODS if self.offset is None else 0
        measured = np.concatenate([self.unfinished, growth[turning:]])
        periods, blocks, self.offset = len(measured), block_means(measured, EXPONENT_BLOCKS), offset
        if needs_more_periods(blocks, periods) and not last:
            self.unfinished = measured
            return None
        self.unfinished = np.zeros(0)
        before, self.latest = self.latest, regime_from_exponents(blocks, periods, strobes, periods_run)
        self.complete += 1
        as_long_as_two = self.latest.name == "quasi-periodic" and continued
        agreed = before is not None and agree(self.latest, before)
        return self.latest if clearly_chaotic(blocks) or as_long_as_two or agreed else None
