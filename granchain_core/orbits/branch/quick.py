"""The stroboscopic map without derivative, by the fixed-step method, for all but the last steps of Newton's method.

Its steps are split at contact events, so it is smooth: differences in the knob are accurate to 1e-6. Its kernels are
vectorised: near orbits of sec2 the map is accurate to 1e-8 in a sixth of the time that the flow takes at a tolerance of
1e-10 (docs/branches.md, "Few derivatives").
"""

from __future__ import annotations

import numpy as np

from ...execution.stop import Stop
from ...integrate import Engine, fixed_step_setting
from ...integrate.scaling import ScaledChain, scale_like
from ...kernels.effects.registry import unknown_slots
from ...scene import Scene

#: Number of steps that replace one default step.
_REFINEMENT = 8.0
#: Maximum number of steps per period. Beyond it the flow is faster, since its steps are long while contacts are open.
_MOST_QUICK_STEPS = 30_000
#: Significant binary digits of the number of steps, so that nearby orbits share the table of the driver's motion.
_BINARY_DIGITS = 4


class QuickMap:
    """(scene, x) → the state n drive periods later, for scenes that differ in the value of a knob.

    Only one thread may use it at a time. Equal calls give equal bits.
    """

    def __init__(self, periods: int, stop: Stop | None = None) -> None:
        self.periods, self.stop = periods, stop
        self._engine: Engine | None = None

    def end(self, scene: Scene, x: np.ndarray, steps: int) -> np.ndarray:
        """The state n periods of `steps` steps after x."""
        if self._engine is None:
            self._engine = Engine(scene, fixed_step_setting(), 1, stop=self.stop)
        engine, scaled = self._engine, scale_like(self._engine.scaled, scene)
        engine.move(scaled, steps)
        engine.start_scaled(x)
        engine.periods(self.periods, watch=False)
        return engine.scaled.beads_of(engine.y)


def quick_steps(scaled: ScaledChain) -> int:
    """Steps per period of the quick map of a scene; 0 where the flow is faster.

    The map would jump if their number changed with the knob, so all scenes that are compared use the number of one.
    """
    steps = int(_REFINEMENT * max(16.0, scaled.period / scaled.step)) + 1
    if steps > _MOST_QUICK_STEPS or unknown_slots(scaled.slots, "rk4"):
        return 0
    unit = 2 ** max(0, steps.bit_length() - _BINARY_DIGITS)
    return -(-steps // unit) * unit
