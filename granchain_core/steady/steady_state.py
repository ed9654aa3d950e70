"""The steady state of a scene, found in a batch or by settling its chain alone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..results.forces import ForceErrors
from ..results.regime import Regime
from ..scene import Scene
from ..scene.state import State

#: [chaotic, quasi-periodic, unsettled] Drive periods over which the largest forces of a curve's point are determined.
IRREGULAR_PERIODS = 100


@dataclass(frozen=True, eq=False)
class SteadyState:
    """A steady state with its largest forces `maxima` (3,) [N] in the order input, output, elastic output.

    `errors` (3,) are their relative errors, None if no errors are stated; `state` is at drive phase 0. If the
    computation failed, `failure` is a sentence, `status` is the name of the failure, and the forces are NaN. `number`
    is that of its start. If `undecided`, the batch could not decide, and `settle` has to continue from `state`.
    """

    scene: Scene
    maxima: np.ndarray
    regime: Regime
    errors: np.ndarray | None
    state: State
    failure: str = ""
    status: str = "done"
    number: int = 0
    undecided: bool = False

    @property
    def force_errors(self) -> ForceErrors:
        """The relative errors by name."""
        return ForceErrors.of(self.errors)

    @property
    def output_force_error(self) -> float | None:
        """Relative error of the output force, infinite where that force is zero; None if no error is stated."""
        return None if self.errors is None else float(self.errors[1])
