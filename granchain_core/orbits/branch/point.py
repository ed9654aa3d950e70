"""One orbit of a branch, with everything in which it is compared with its neighbours."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ...errors import ComputationError
from ...former_names import with_former_names
from ...integrate import Engine, dop853_setting
from ...integrate.scaling import scale_chain
from ...kernels.error_control.orbit_record import OrbitRecord, record_orbit
from ...kernels.forces.peaks import PEAKS, largest_forces
from ...kernels.status import FULL
from ...scene import Scene
from ...scene.state import State
from ..orbit import liouville_error, sorted_multipliers
from ..unit_circle import least_modulus_outside, outside
from .equations import BranchEquations, Solved

#: Tolerance per step of the run that records forces and contacts; errors are about 1e-9.
_TOLERANCE = 1e-11
#: Tolerance per step of the run along an orbit that only helps to find others; errors of overlaps are about 1e-7.
_ROUGH_TOLERANCE = 1e-9
#: Initial room for extrema of overlaps, per contact and period.
_FIRST_ROOM = 32
#: Number of closings stored for a contact that is always closed; 0 is stored for one that is always open.
_CLOSED = -1
#: Columns of an extremum (`OrbitRecord`): contact, +1 for a maximum and −1 for a minimum of the overlap, time, overlap.
CONTACT, EXTREMUM_SIGN, TIME, OVERLAP = range(4)


@with_former_names
@dataclass(frozen=True, eq=False)
class BranchPoint:
    """A periodic orbit on a branch.

    `knob` is in SI. `x` (2N,) is the scaled state (u, w) at phase 0; `tangent` (2N + 1,) is the branch's unit tangent
    in (x/√(2N), ζ); `arclength` is measured from the starting orbit. `multipliers` (2N,) are sorted by modulus, largest
    first. The three largest forces are in N. `closings` (N + 1,) count how often each contact closes along the orbit: 0
    if it is always open, −1 if it is always closed. `slope` (2N,) is the derivative of the map with respect to ζ.
    `residuals` are those of Newton's method, the last being the orbit's; `liouville_error` is the difference between
    ln |det| of the monodromy matrix and ∫ trace. `overlap_extrema` are the extrema of all overlaps
    (kernels/error_control/orbit_record.py). `damped` tells whether the chain loses energy.
    """

    knob: float
    x: np.ndarray
    tangent: np.ndarray
    arclength: float
    multipliers: np.ndarray
    max_input_force: float
    max_output_force: float
    max_output_force_elastic: float
    closings: np.ndarray
    slope: np.ndarray
    residuals: tuple[float, ...]
    liouville_error: float
    overlap_extrema: np.ndarray
    damped: bool = True

    @property
    def residual(self) -> float:
        """Change of the orbit's state after its period, relative to the largest displacement and the largest w."""
        return self.residuals[-1]

    @property
    def unstable_multipliers(self) -> int:
        """Number of multipliers outside the unit circle; without damping, by `ON_CIRCLE` or more."""
        return int(outside(self.multipliers, self.damped).sum())

    @property
    def stable(self) -> bool:
        """Whether no multiplier is outside the unit circle."""
        return self.unstable_multipliers == 0

    @property
    def knob_direction(self) -> int:
        """+1 where the knob grows along the branch, −1 where it falls."""
        return 1 if self.tangent[-1] > 0.0 else -1

    @property
    def doubling_sign(self) -> int:
        """Sign of det(M + I) of the monodromy matrix M: it changes where a real multiplier passes −1."""
        real = self.multipliers.real[self.multipliers.imag == 0.0]
        return -1 if (real <= -least_modulus_outside(self.damped)).sum() % 2 else 1

    @property
    def signature(self) -> tuple[int, ...]:
        """Integers whose change between neighbours marks a special point."""
        return (self.knob_direction, self.unstable_multipliers, self.doubling_sign, *(int(n) for n in self.closings))


def branch_point(equations: BranchEquations, solved: Solved, tangent: np.ndarray, arclength: float) -> BranchPoint:
    """Make the point with its multipliers, and with forces and contacts from a run along the orbit."""
    return recorded(equations, unrecorded(equations, solved, tangent, arclength), solved.flow.contact_events)


def unrecorded(equations: BranchEquations, solved: Solved, tangent: np.ndarray, arclength: float) -> BranchPoint:
    """Make the point without a run along its orbit: its forces are NaN and its closings are not counted."""
    multipliers = sorted_multipliers(solved.flow.derivative)
    return BranchPoint(
        knob=equations.value(solved.z), x=equations.state(solved.z), tangent=tangent, arclength=arclength,
        multipliers=multipliers, max_input_force=np.nan, max_output_force=np.nan, max_output_force_elastic=np.nan,
        closings=np.zeros(equations.size // 2 + 1, dtype=int), slope=solved.knob_slope, residuals=solved.residuals,
        liouville_error=liouville_error(multipliers, solved.flow.log_determinant), overlap_extrema=np.zeros((0, 4)),
        damped=equations.axis.damped_at(equations.value(solved.z)))


def recorded(equations: BranchEquations, point: BranchPoint, contact_events: np.ndarray) -> BranchPoint:
    """Add forces and contacts to a point; `contact_events` are those of its orbit, as in `Flow`."""
    engine, record = record_along(equations, point.x, point.knob)
    maxima = engine.scaled.scales.forces(largest_forces(record.peaks))
    return replace(
        point, max_input_force=float(maxima[0]), max_output_force=float(maxima[1]),
        max_output_force_elastic=float(maxima[2]), closings=_counts(len(point.closings), record, contact_events),
        overlap_extrema=record.turns)


def state_at(scene: Scene, x: np.ndarray) -> State:
    """The scaled state x of a scene at phase 0 in SI."""
    scaled = scale_chain(scene)
    return scaled.to_si(scaled.embed(x))


def rough_point(equations: BranchEquations, z: np.ndarray, tangent: np.ndarray, slope: np.ndarray,
                multipliers: np.ndarray, residuals: list[float], arclength: float) -> BranchPoint:
    """Make a point near the branch with its contacts, for the search only: without forces and Liouville's formula."""
    x, value = equations.state(z), equations.value(z)
    _, record = record_along(equations, x, value, _ROUGH_TOLERANCE)
    return BranchPoint(
        knob=value, x=x, tangent=tangent, arclength=arclength, multipliers=multipliers,
        max_input_force=np.nan, max_output_force=np.nan, max_output_force_elastic=np.nan,
        closings=_counted_extrema(len(x) // 2 + 1, record.turns), slope=slope, residuals=tuple(residuals),
        liouville_error=np.nan, overlap_extrema=record.turns, damped=equations.axis.damped_at(value))


def record_along(equations: BranchEquations, x: np.ndarray, value: float,
                 tolerance: float = _TOLERANCE) -> tuple[Engine, OrbitRecord]:
    """Record largest forces and the extrema of all overlaps along the motion from the scaled state x."""
    engine = Engine(equations.axis.scene_at(value), dop853_setting(tolerance), 1, stop=equations.stop)
    stepper, room = engine.stepper, _FIRST_ROOM * (equations.size // 2 + 1) * equations.period
    while True:
        engine.start_scaled(x)
        record = OrbitRecord(np.zeros((room, 4)), np.zeros(PEAKS))
        status, done, rows = record_orbit(stepper.method, stepper.trajectory(engine.y), equations.period, record,
                                          engine.counts.array, engine.stop.flag)
        if status != FULL:
            engine.raise_for(status, done)
            return engine, record._replace(turns=record.turns[:rows].copy())
        room = rows


def _counted_extrema(contacts: int, extrema: np.ndarray) -> np.ndarray:
    """Closings of every contact from its overlap's extrema alone: between two of them it crosses zero at most once."""
    closings = np.zeros(contacts, dtype=int)
    for contact in range(contacts):
        pressed = extrema[extrema[:, CONTACT] == contact, OVERLAP] > 0.0
        closings[contact] = np.sum(pressed & ~np.roll(pressed, 1))
        if len(pressed) and pressed.all():
            closings[contact] = _CLOSED
    return closings


def _counts(contacts: int, record: OrbitRecord, contact_events: np.ndarray) -> np.ndarray:
    """Closings of every contact; the overlap's extrema distinguish contacts always open from those always closed."""
    numbers = contact_events[:, 0].astype(int)
    closings = np.bincount(numbers[numbers > 0] - 1, minlength=contacts)
    if not np.array_equal(closings, np.bincount(-numbers[numbers < 0] - 1, minlength=contacts)):
        raise ComputationError("A contact closed more often than it opened along a closed orbit.", "contacts")
    for contact in np.flatnonzero(closings == 0):
        overlaps = record.turns[record.turns[:, CONTACT] == contact, OVERLAP]
        if len(overlaps) and overlaps.max() > 0.0:
            closings[contact] = _CLOSED
    return closings
