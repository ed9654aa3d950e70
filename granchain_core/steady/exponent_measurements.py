"""What several measurements of one motion's Lyapunov exponent decide together: the rule of single chains and batches.

A measurement whose error is too large for a decision is continued. One that is clearly chaotic decides by itself, and
so does a quasi-periodic one that was continued, since it is as long as two; any other must agree with the one before it
(regime_criteria.py).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..regime import Regime
from .regime_criteria import agree, clearly_chaotic, needs_more_periods, regime_from_exponents

#: [chaotic, quasi-periodic] Blocks in a measurement of the exponent. The standard error of the mean is computed from
#: them.
EXPONENT_BLOCKS = 10
#: [chaotic, quasi-periodic] Drive periods in a block, and more in a measurement that is continued. It has the same
#: number of longer blocks: on a closed curve the means of successive blocks swing up and down, and the swing falls as
#: 1/periods.
PERIODS_IN_BLOCK = 20


@dataclass(eq=False)
class ExponentMeasurements:
    """Measurements of one motion so far.

    `latest` is the regime that the last complete measurement shows, `complete` the number of them; `unfinished` holds
    the exponents (B,) of one whose error is too large for a decision. `offset` (2(N+2),), scaled, leads to the
    neighbouring trajectory where the last one ended: the next one goes on with it, since a new neighbour would have to
    turn into the leading direction again.
    """

    latest: Regime | None = None
    complete: int = 0
    offset: np.ndarray | None = None
    unfinished: np.ndarray = field(default_factory=lambda: np.zeros(0))

    @property
    def approach_rate(self) -> float:
        """Mean exponent per period by which neighbours approach, as on the way to an orbit; 0 where they do not.

        It is that of the last complete measurement.
        """
        latest = self.latest
        if latest is None or latest.name != "unsettled" or latest.lyapunov is None:
            return 0.0
        return max(0.0, -latest.lyapunov[0])

    def add(self, exponents: np.ndarray, strobes: np.ndarray, periods_run: int, last: bool = False) -> Regime | None:
        """The regime, if more exponents decide it.

        `exponents` are `EXPONENT_BLOCKS` mean exponents of successive blocks of `PERIODS_IN_BLOCK` periods, `strobes`
        (P, 2, N) the last ones of a motion that has run `periods_run` periods. With `last` the measurement is not
        continued, however large its error.
        """
        measured = np.concatenate([self.unfinished, exponents])
        periods = PERIODS_IN_BLOCK * len(measured)
        blocks = measured.reshape(EXPONENT_BLOCKS, -1).mean(axis=1)
        if needs_more_periods(blocks, periods) and not last:
            self.unfinished = measured
            return None
        self.unfinished = np.zeros(0)
        before, self.latest = self.latest, regime_from_exponents(blocks, periods, strobes, periods_run)
        self.complete += 1
        as_long_as_two = self.latest.name == "quasi-periodic" and len(measured) > EXPONENT_BLOCKS
        agreed = before is not None and agree(self.latest, before)
        return self.latest if clearly_chaotic(blocks) or as_long_as_two or agreed else None
