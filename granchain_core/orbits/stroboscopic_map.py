"""The n-period stroboscopic map with its derivative, integrated from contact event to contact event."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import BadInput
from ..execution.stop import Stop
from ..integrate import Engine, dop853_setting
from ..integrate.dop853 import Dop853Stepper
from ..integrate.failure import MOST_EVENTS_OF_ORBIT
from ..integrate.scaling import ScaledChain, scale_like
from ..kernels.effects.contact import FrozenContacts
from ..kernels.effects.dissipation import LinearDashpot
from ..kernels.flow.attempt import ContactStatus, FlowProblem
from ..kernels.flow.run import run_flow
from ..kernels.flow.tangent import Tangent, columns_of, new_tangent
from ..kernels.flow.velocity_tangent import VelocityTangent, new_velocity_tangent
from ..kernels.status import EVENTS_PER_CONTACT
from ..scene import Scene
from ..scene.refusals import refuse_undriven
from ..steady.residuals import orbit_change

#: [step size] flow: tolerance of one step, relative to the largest displacement and w. The map is then accurate enough
#: for Newton's method to converge to `RESIDUAL_GOAL` (steady/residuals.py); a chain with its observer is integrated to
#: about 1e-11.
TOLERANCE = 1e-13
#: [no threshold] Error of the derivative at that tolerance near grazings, relative to its largest entry; docs/orbits.md
#: ("Error of the tangents") has the measurements, near grazings and elsewhere.
TANGENT_ERROR = 1e-6
#: [no threshold] How closely a point of a bifurcation curve meets its condition on a multiplier, and how far inside the
#: unit circle a multiplier must be for an observer not to be examined for a drift: about the error of a leading
#: multiplier, which the same section has.
MULTIPLIER_ERROR = 1e-6
#: [step size] flow: first step to try, in scaled time, in a period that is long enough.
_INITIAL_STEP = 0.1
#: [step size] flow: fewest steps in a drive period from which the first one follows.
_LEAST_STEPS = 12
#: The method, in the provenance of results.
FLOW_METHOD = "tangent flow (DOP853, time substitution at events)"
#: [no threshold] An orbit that returns to within this relative distance after a fraction of its period has that shorter
#: period.
SAME_ORBIT_DISTANCE = 1e-8


@dataclass(frozen=True, eq=False)
class Flow:
    """The flow over n periods: end (2N,), displacements then w in scaled units, and derivative (2N, columns).

    `log_determinant` is ∫ trace along the motion, to be compared with the derivative's own (Liouville).
    `contact_events` (events, 2) are those of the motion: contact + 1, negative where it opened, and the time in drive
    periods.
    """

    end: np.ndarray
    derivative: np.ndarray
    log_determinant: float
    contact_events: np.ndarray


def refuse_cut(scene: Scene) -> None:
    """Raise `BadInput` for a scene that cuts tension."""
    if scene.cuts_tension:
        raise BadInput("tension = cut lets contacts touch without force, which the flow of orbits does not model, so "
                       "orbits and multipliers are not computed; the nearest valid value is tension = allowed.")


class StroboscopicMap:
    """x → the state n drive periods later, with its derivative by the tangent flow, for scaled x = (u, w) at phase 0.

    Raises `BadInput` for a scene that cuts tension: only open and pressed contacts are implemented.
    """

    def __init__(self, scene: Scene, periods: int, stop: Stop | None = None, tolerance: float = TOLERANCE) -> None:
        refuse_undriven(scene)
        refuse_cut(scene)
        self.engine = Engine(scene, dop853_setting(tolerance), 1, stop=stop)
        self.periods = periods
        self._prepare(tolerance)

    def move(self, scene: Scene, tolerance: float) -> None:
        """Become the map of another scene with as many beads: bit for bit a new map, at a third of the cost."""
        engine, scaled = self.engine, scale_like(self.engine.scaled, scene)
        engine.stepper = Dop853Stepper(tolerance, scaled, 1)
        engine.stepper.pause = engine.stop.pause
        self._prepare(tolerance)

    def _prepare(self, tolerance: float) -> None:
        self.tolerance = tolerance
        row = self.engine.scaled.bodies
        events = np.zeros((min(EVENTS_PER_CONTACT * (row - 1) * self.periods, MOST_EVENTS_OF_ORBIT), 2))
        self._contacts = ContactStatus(np.zeros(2 * row), np.zeros(row - 1, dtype=np.int64), events,
                                       np.zeros(1, dtype=np.int64))
        frozen = self.engine.stepper.work.forces._replace(frozen=FrozenContacts(self._contacts.closed))
        self._work = self.engine.stepper.work._replace(forces=frozen)

    def inner(self, y: np.ndarray) -> np.ndarray:
        """The beads' entries of a full state array."""
        return self.engine.scaled.beads_of(y)

    def residual(self, end: np.ndarray, x: np.ndarray) -> float:
        """Change from x (2N,) to `end`, relative to the sizes of displacements and of w (steady/residuals.py)."""
        return orbit_change(end - x, x, self.engine.scaled.beta)

    def __call__(self, x: np.ndarray, observer: bool = False, directions: np.ndarray | None = None) -> Flow:
        """The flow from x with the derivative, or its product with the columns of `directions` (2N, columns).

        With `observer`, the tangents are those of a chain driven by the recorded input force.
        """
        start = np.eye(len(x)) if directions is None else directions
        tangent = new_tangent(start, self.engine.scaled.bodies, 1 if observer else 0)
        trace = self._run(x, tangent)
        return Flow(self.inner(self.engine.y), columns_of(tangent, start.shape[1]), trace, self.contact_events)

    def derivative_by_saltation(self, x: np.ndarray, jumps: bool = True) -> np.ndarray:
        """The derivative (2N, 2N) in (u, w), from tangents in (u, v) with their jumps at contact events.

        Without `jumps` it is wrong on purpose: the saltation is left out, for comparison. Raises `BadInput` for a
        damping g(δ) other than the linear dashpot's: its saltation is the identity, since g(0) = 0, but the tangents
        in (u, v) have a term g'(δ) δ̇, which this method leaves out.

        Only tests use it. `VelocityTangent` is among the kernels and not in tests/, because `run_flow` with these
        tangents is kept on disk under the hash of the kernels' folder: an edit of code elsewhere would not be noticed.
        """
        scaled = self.engine.scaled
        if scaled.slots.dissipation is not None and not isinstance(scaled.slots.dissipation, LinearDashpot):
            raise BadInput(f"dissipation = {scaled.scene.dissipation}: the tangents in (u, v) have no term for the "
                           "change of the damping with the overlap, which is unbounded where a contact closes; valid "
                           "values are linear and none.")
        before = velocity_jacobian(scaled, x)
        tangent = new_velocity_tangent(before, scaled.bodies, float(jumps))
        self._run(x, tangent)
        return np.linalg.solve(velocity_jacobian(scaled, self.inner(self.engine.y)), tangent.matrix)

    def end(self, x: np.ndarray) -> np.ndarray:
        """The state n periods after x, by the tangent flow's kernel with no tangents."""
        self._run(x, new_tangent(np.zeros((len(x), 0)), self.engine.scaled.bodies, 0))
        return self.inner(self.engine.y)

    @property
    def contact_events(self) -> np.ndarray:
        """The contact events of the last run, as in `Flow`."""
        events = self._contacts.log[: self._contacts.logged[0]].copy()
        events[:, 1] /= self.engine.scaled.period
        return events

    def _run(self, x: np.ndarray, tangent: Tangent | VelocityTangent) -> float:
        engine = self.engine
        engine.start_scaled(x)
        self._work.next_step[0] = min(_INITIAL_STEP, engine.scaled.period / _LEAST_STEPS)
        trajectory = engine.stepper.trajectory(engine.y)._replace(workspace=self._work)
        problem = FlowProblem(trajectory, self._contacts, tangent)
        status, done, trace = run_flow(engine.stepper.method, problem, self.periods, engine.counts.array,
                                       engine.stop.flag)
        engine.raise_for(status, done)
        return float(trace)


def velocity_jacobian(scaled: ScaledChain, x: np.ndarray) -> np.ndarray:
    """Derivative (2N, 2N) of (u, v) with respect to (u, w) at state x, phase 0, with a linear dashpot or none."""
    n = scaled.beads
    matrix = np.eye(2 * n)
    if scaled.slots.dissipation is None:
        return matrix
    u = np.concatenate([[0.0], x[:n], [0.0]])
    static = scaled.slots.preload.static if scaled.slots.preload is not None else 0.0
    gate = scaled.slots.dissipation.coefficient * (u[:-1] - u[1:] + static > 0.0)  # ∂G/∂δ of every contact
    inverse = scaled.slots.chain.inverse_mass[1:-1]
    rows = np.arange(n)
    matrix[n + rows, rows] = -inverse * (gate[:-1] + gate[1:])
    matrix[n + rows[1:], rows[:-1]] = inverse[1:] * gate[1:-1]
    matrix[n + rows[:-1], rows[1:]] = inverse[:-1] * gate[1:-1]
    return matrix
