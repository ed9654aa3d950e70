"""The n-period stroboscopic map with its derivative, contact event by contact event."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import BadInput
from ..integrate import Engine, Setting
from ..kernels.dop853_tableau import STAGES
from ..kernels.flow import run_flow
from ..kernels.flow_step import Path
from ..kernels.simd import LANES, aligned
from ..kernels.tangent import Tangent
from ..scene import Scene

#: Tolerance of one step: the map is then smooth to about 1e-13, and Newton's method ends there.
TOLERANCE = 1e-13
#: More changes of contact than this for each contact in one period are chatter.
_EVENTS_PER_CONTACT = 500


@dataclass(frozen=True, eq=False)
class Flow:
    """Where n periods lead: end (2N,) of displacements then w in scaled units, derivative (2N, columns).

    `log_determinant` is ∫ trace along the way, to be compared with the derivative's own (Liouville).
    `changes` (events, 2) are the contact events on the way: contact + 1, negative where it opened, and the time over
    the drive period.
    """

    end: np.ndarray
    derivative: np.ndarray
    log_determinant: float
    changes: np.ndarray


class StroboscopicMap:
    """x → the state n drive periods later, for scaled x = (u, w) at phase 0.

    Raises `BadInput` for a scene that cuts tension: its force is no function of (u, w) with located kinks.
    """

    def __init__(self, scene: Scene, periods: int, stop: np.ndarray | None = None) -> None:
        if scene.cuts_tension:
            raise BadInput("tension = cut has contact forces whose end at F = 0 is not located, so orbits and "
                           "multipliers are not computed; the nearest valid value is tension = allowed.")
        self.engine = Engine(scene, Setting("dop853", tolerance=TOLERANCE), 1, stop=stop)
        self.periods = periods
        row = self.engine.lowered.row
        self._path = Path(np.zeros(2 * row), np.zeros(row - 1, dtype=np.int64),
                          np.zeros((_EVENTS_PER_CONTACT * (row - 1) * periods, 2)), np.zeros(1, dtype=np.int64))

    def inner(self, y: np.ndarray) -> np.ndarray:
        """The beads' part of a whole state array."""
        row = self.engine.lowered.row
        return np.concatenate([y[1 : row - 1], y[row + 1 : 2 * row - 1]])

    def __call__(self, x: np.ndarray, observer: bool = False, directions: np.ndarray | None = None) -> Flow:
        """The flow from x with the derivative, or its product with the columns of `directions` (2N, columns).

        With `observer` the tangents are those of a chain pushed by the recorded input force.
        """
        start = np.eye(len(x)) if directions is None else directions
        tangent = _tangent(start, self.engine.lowered.row - 1, 1 if observer else 0)
        trace = self._run(x, tangent)
        return Flow(self.inner(self.engine.y), _columns(tangent, start.shape[1]), trace, self.changes)

    def end(self, x: np.ndarray) -> np.ndarray:
        """Where n periods lead from x, without tangents."""
        self._run(x, None)
        return self.inner(self.engine.y)

    @property
    def changes(self) -> np.ndarray:
        """The contact events of the last run, as in `Flow`."""
        found = self._path.log[: self._path.logged[0]].copy()
        found[:, 1] /= self.engine.lowered.period
        return found

    def _run(self, x: np.ndarray, tangent: Tangent | None) -> float:
        engine = self.engine
        engine.start_scaled(x)
        lo = engine.lowered
        engine.clock[0] = min(0.1, lo.period / STAGES)
        status, done, trace = run_flow(engine.method, lo.slots, lo.beta, lo.period, self.periods, engine.y,
                                       engine.work, self._path, engine.clock, tangent, engine.counts.array,
                                       engine.stop)
        engine.raise_for(status, done)
        return float(trace)


def _tangent(start: np.ndarray, contacts: int, first_contact: int) -> Tangent:
    """The workspace of the tangents that begin with the columns of `start`, eight in a block."""
    rows, columns = start.shape
    blocks = -(-columns // LANES)
    matrix = aligned(blocks * rows)
    padded = np.zeros((rows, blocks * LANES))
    padded[:, :columns] = start
    matrix[:] = padded.reshape(rows, blocks, LANES).transpose(1, 0, 2).reshape(blocks * rows, LANES)
    return Tangent(matrix, np.zeros((STAGES + 1, contacts)), np.zeros((STAGES, contacts)), np.zeros((STAGES, contacts)),
                   aligned(STAGES * rows), aligned(rows), np.zeros((STAGES + 1, STAGES)), first_contact)


def _columns(tangent: Tangent, columns: int) -> np.ndarray:
    """The tangents as an ordinary matrix (2N, columns)."""
    rows = len(tangent.state)
    blocks = tangent.matrix.reshape(-1, rows, LANES)
    return np.ascontiguousarray(blocks.transpose(1, 0, 2).reshape(rows, -1)[:, :columns])
