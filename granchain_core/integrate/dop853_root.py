"""Stepping with error control along a short chain in vectors; other chains are refused."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..errors import BadInput
from ..execution.stop import Stop
from ..kernels.compiling.entry import Entries, types_of
from ..kernels.dop853.step import ALL_STAGES, Dop853, Dop853Workspace
from ..kernels.dop853_root.chain import STATE_ROWS, Dop853RootWorkspace, Stages
from ..kernels.dop853_root.run import run_dop853_root
from ..kernels.effects.registry import unknown_slots
from ..kernels.error_control.run import SampleRange
from ..kernels.forces.largest import new_log
from ..kernels.samples import KernelIO, Samples
from ..kernels.simd.vector import BLOCK_WIDTH, aligned
from .dop853 import Dop853Stepper, dop853_workspace
from .error_controlled import ErrorControlledStepper, largest_step
from .fixed import SHORT_CHAIN, chain_width, short_chain_workspace
from .scaling import ScaledChain
from .stepper import CallStart, empty_samples

_RUN_DOP853_ROOT = Entries(run_dop853_root)


class Dop853RootStepper(ErrorControlledStepper):
    """DOP853 in (u, w) with a relative tolerance per step, in a transformed time next to contact events."""

    def __init__(self, tolerance: float, scaled: ScaledChain, samples: int) -> None:
        self._vectors = _workspace(scaled)
        super().__init__(Dop853(tolerance, largest_step(scaled)), scaled, samples)

    def new_workspace(self) -> Dop853Workspace:
        """Return the workspace of DOP853, of which these kernels use a part; the rest is in `_vectors`."""
        return dop853_workspace(self.scaled)

    def new_type_key(self) -> Any:
        """Return a key for the types of slots, method and workspace, including the chain's vectors."""
        return super().new_type_key(), types_of(self._vectors)

    def use(self, scaled: ScaledChain) -> None:
        """Continue with other values in the same slots, or with other effects. Raises `BadInput`."""
        self._vectors = _workspace(scaled)
        super().use(scaled)

    def run_range(self, y: np.ndarray, first: int, points: int, stride: int, samples: Samples,
                  out: KernelIO) -> tuple[int, int]:
        """Call the kernel once over `points` grid points from `first` on; return status and rows filled."""
        wanted = SampleRange(first, points, self.grid, stride)
        status, rows = _RUN_DOP853_ROOT(self.type_key, self.method, self._vectors, self.trajectory(y), wanted,
                                        samples, out)
        return status, rows

    def locate_failure(self, y: np.ndarray, start: CallStart | None, done: float,
                       stop: Stop) -> tuple[int, int | None]:
        """Find the bead with dop853, whose stages are separate, by repeating the call from its start.

        If dop853 does not fail, no bead is reported.
        """
        if start is None:
            return super().locate_failure(y, start, done, stop)
        before, _, first = start
        again, now = Dop853Stepper(self.method.tolerance, self.scaled, self.grid), before.copy()
        again.prepare(now)
        kept = empty_samples(self.scaled, round(self.grid * (done + 2.0)))
        again.samples(now, first, kept, KernelIO(new_log(), np.zeros(4, dtype=np.int64), stop.flag))
        stop.check()
        return again.locate_failure(now, start, done, stop)


def _workspace(scaled: ScaledChain) -> Dop853RootWorkspace:
    """Return the workspace of a short chain; raise `BadInput` if it is too long or has effects without code here."""
    width = chain_width(scaled)
    unknown = unknown_slots(scaled.slots, "dop853_root")
    if not width or unknown or scaled.slots.driver is None:
        named = f" It does not support: {', '.join(unknown)}." if unknown else ""
        raise BadInput(f"The method dop853-root takes chains of up to {SHORT_CHAIN} beads with a driver "
                       "that is harmonic or at rest, without a tension cut or an energy account; use dop853 for this "
                       f"one.{named}")

    def rows(count: int) -> Stages:
        return Stages(aligned(count, width), aligned(count, width), *(aligned(count, BLOCK_WIDTH) for _ in range(2)))

    return Dop853RootWorkspace(short_chain_workspace(scaled, width), rows(ALL_STAGES), rows(7), rows(1),
                           aligned(STATE_ROWS, width), aligned(1, width), np.zeros(8))
