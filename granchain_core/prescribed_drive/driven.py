"""`drive`: the motion of a chain whose driver follows a given signal.

The motion is computed with steps that are halved until the stated error is small enough, by the rules of `run`
(integrate/stated.py). The signal's motion is computed exactly. If it represents a formula (signal.py), the effect of
its difference from the formula is added to the stated errors. If it represents samples, the motion is computed twice
more, from the samples with even and with odd numbers, and an error estimated from the differences is added.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict, dataclass

import numpy as np

from ..errors import BadInput
from ..execution.stop import Stop
from ..execution.stopwatch import Stopwatch
from ..integrate.chain_in_pieces import MOST_HALVINGS, Refined, refined
from ..integrate.methods import RK4_SPLIT
from ..integrate.safety_factors import SAMPLED_DRIVE
from ..integrate.stated import or_whole_motion, relative_changes, relative_difference
from ..results.forces import RUN_ERRORS, ForceErrors, force_sentences
from ..results.recorded_motion import MOST_RECORDED, RecordedMotion, motion_columns, time_axis
from ..results.run import Cost, residual
from ..scene import Scene
from ..scene.hertz import EXPONENT, OVERLAP_POWER
from ..scene.laws import LAWS
from ..scene.refusals import require_scene
from ..scene.state import State, checked_start, rest
from ..tables import MAXIMA, Column, Table, bead_axis, contact_axis, provenance
from ..tables.provenance import Attribute
from .moved_chain import MovedChain
from .signal import Signal

#: Error of the beads' displacements over that of the driver's, which oscillates from knot to knot. Random chains showed
#: 0.003 to 0.03 where the motion does not magnify errors.
_TRANSMITTED_ERROR = 0.03


@dataclass(frozen=True, eq=False, repr=False)
class Driven(RecordedMotion):
    """The motion of a chain at the T knots of its signal, in SI.

    Attributes
    ----------
    scene : Scene
        The chain; its own drive is ignored.
    signal : Signal
        The motion of the driver.
    displacement, velocity : numpy.ndarray, shape (T, N)
        Displacements [m] and velocities [m/s] of the beads.
    force : numpy.ndarray, shape (T, N + 1)
        Forces of the contacts [N].
    max_input_force, max_output_force, max_output_force_elastic : float
        Largest forces from the start to the end [N], including between the knots.
    force_errors : ForceErrors
        Relative errors of these forces.
    displacement_error : float
        Largest error of any displacement over the largest displacement.
    energy_residual : float
        Largest |work − loss − change of stored energy| over the largest of |work|, |loss| and the stored energy above
        that of the preload at rest.
    status : str
        "done" or "accuracy-not-reached".
    cost : Cost
        Computing time, steps and evaluations.
    interpolation_error : float
        Contribution of the interpolation between samples of the driver's motion to `displacement_error`; 0 for a
        formula and for a motion that is exact.

    Examples
    --------
    >>> from granchain_core import Signal, drive, scene
    >>> chain = scene("sec2").evolve(N=2)
    >>> found = drive(chain, Signal.burst(chain.A0, 2000.0, 4, 0.004))
    >>> found.status, found.energy_residual < 1e-5
    ('done', True)
    """

    scene: Scene
    signal: Signal
    displacement: np.ndarray
    velocity: np.ndarray
    force: np.ndarray
    max_input_force: float
    max_output_force: float
    max_output_force_elastic: float
    force_errors: ForceErrors
    displacement_error: float
    energy_residual: float
    status: str
    cost: Cost
    interpolation_error: float = 0.0

    @property
    def time(self) -> np.ndarray:
        """The knots (T,) [s]."""
        return self.signal.time

    @property
    def drive_displacement(self) -> np.ndarray:
        """Displacement of the driver (T,) [m]."""
        return self.signal.displacement

    def tables(self) -> tuple[Table, ...]:
        """One table, `driven`, with the layout of a run's."""
        axes = {**time_axis(self.time, "time since the signal's own zero"), **bead_axis(self.scene.N),
                **contact_axis(self.scene.N)}
        velocity = Column(self.signal.velocity, ("time",), "m/s", "driver velocity")
        return (Table("driven", axes, {**motion_columns(self), "drive_velocity": velocity}),)

    def attributes(self) -> dict[str, Attribute]:
        """The signal, largest forces with their errors, status, energy, cost and provenance."""
        return {**provenance(self.scene, self.cost.method, self.displacement_error), "status": self.status,
                "drive": self.signal.words, "interpolation_error": self.interpolation_error,
                "energy_residual": self.energy_residual, "cost": json.dumps(asdict(self.cost)),
                **{name: getattr(self, name) for name in MAXIMA},
                **dict(zip(RUN_ERRORS, self.force_errors.row, strict=True))}

    def summary(self) -> list[str]:
        """The signal, largest forces and errors."""
        between = f", {self.interpolation_error:.1e} of it between samples" if self.signal.coarser else ""
        return [f"driver: {self.signal.words}", *force_sentences(self),
                f"{len(self.time)} knots; displacements: relative error {self.displacement_error:.1e}{between}; "
                f"{self.status.replace('-', ' ')}"]


def drive(scene: Scene, signal: Signal, start: State | None = None, stop: Stop | None = None,
          progress: Callable[[float], None] | None = None) -> Driven:
    """Compute the motion of a chain whose driver follows a signal.

    Parameters
    ----------
    scene : Scene
        The chain; its own drive is ignored. `scene.accuracy` is the requested relative error of displacements.
    signal : Signal
        The motion of the driver.
    start : State, optional
        Where the chain starts; by default at rest, or with the scene's initial velocities. Its phase is ignored.
    stop : Stop, optional
        Ends the computation when another thread sets it.
    progress : callable, optional
        Called with the completed fraction, 0 to 1.

    Returns
    -------
    Driven
        The motion at every knot. Its `status` is "done" or "accuracy-not-reached"; the latter also if the samples of a
        measured motion are too far apart for the accuracy.

    Raises
    ------
    BadInput
        `signal` is not a signal, has too many knots for the chain, or needs too many steps.
    ComputationError
        The motion is no longer finite.
    Cancelled
        `stop` was set.

    Examples
    --------
    >>> from granchain_core import Signal, drive, scene
    >>> chain = scene("sec2").evolve(N=3)
    >>> found = drive(chain, Signal.chirp(chain.A0, 500.0, 1500.0, 0.01))
    >>> found.displacement.shape[1], found.displacement_error <= chain.accuracy
    (3, True)
    """
    require_scene(scene)
    if not isinstance(signal, Signal):
        raise BadInput("A drive is a Signal, for example Signal.chirp(…), not a value of type "
                       f"{type(signal).__name__}.")
    if len(signal.time) * scene.N > MOST_RECORDED:
        raise BadInput(f"{len(signal.time)} knots for {scene.N} beads are more than {MOST_RECORDED:.0e} values; give a "
                       "shorter signal or fewer beads.")
    spent, begin = Stopwatch(), rest(scene) if start is None else checked_start(scene, start)
    chain = MovedChain(scene, signal, Stop() if stop is None else stop)
    tell = progress or (lambda done: None)
    finest = refined(chain, begin, lambda halvings: tell(halvings / MOST_HALVINGS))
    between = _sampling_errors(chain, signal, begin, finest)
    return _driven(chain, signal, finest, between, spent)


def _sampling_errors(chain: MovedChain, signal: Signal, begin: State, finest: Refined) -> np.ndarray:
    """Relative errors (4,) of displacements and largest forces due to the interpolation between the signal's samples.

    They follow from the differences between the `finest` motion and those from half of the samples; 0 for a formula.
    """
    differences = np.zeros(4)
    for coarser in signal.coarser:
        moved = chain.moved_by(coarser)
        half = moved.run(begin, finest.halvings)
        differences = np.maximum(differences, sampling_differences(
            (signal.time, finest.samples.displacement, finest.maxima),
            (coarser.time, half.displacement, moved.maxima)))
    return or_whole_motion(SAMPLED_DRIVE / (2.0**signal.order - 1.0) * differences)


def _driven(chain: MovedChain, signal: Signal, finest: Refined, between: np.ndarray, spent: Stopwatch) -> Driven:
    """The result in SI; `between` are the relative errors (4,) due to the interpolation between samples."""
    scene, scales, motion = chain.scaled.scene, chain.scaled.scales, finest.samples
    largest = scales.displacements(float(np.abs(motion.displacement).max()))
    maxima = scales.forces(finest.maxima)
    error, *errors = finest.errors + between + formula_errors(scene, signal, finest.growth, largest, maxima)
    balance = residual(motion.energy, chain.scaled.static_energy)
    assert balance is not None, "the chain has an account"
    inward, outward, elastic = (float(force) for force in maxima)
    return Driven(scene, signal=signal, displacement=scales.displacements(motion.displacement),
                  velocity=scales.velocities(motion.velocity), force=scales.forces(motion.force),
                  max_input_force=inward, max_output_force=outward, max_output_force_elastic=elastic,
                  force_errors=ForceErrors.of(np.array(errors)), displacement_error=float(error),
                  energy_residual=balance, status="done" if error <= scene.accuracy else "accuracy-not-reached",
                  cost=Cost.of(spent.seconds, chain.counts, RK4_SPLIT), interpolation_error=float(between[0]))


def formula_errors(scene: Scene, signal: Signal, growth: float, displacement: float, maxima: np.ndarray) -> np.ndarray:
    """Relative errors (4,) of displacements and largest forces due to the signal's difference from its formula.

    `growth` is the growth of errors in this motion, `displacement` the largest displacement of a bead [m], and `maxima`
    are the largest input, output and elastic output force [N].

    The overlap of a contact is at most [δ] = (F/K)^{2/3}, because its force is elastic where the overlap is largest. An
    error e of a displacement changes the force by up to (3/2) K √[δ] e, and an error e of a velocity by up to g([δ]) e.
    Both errors oscillate from knot to knot, and little of them remains behind contact 0.
    """
    behind = max(1.0, growth) * _TRANSMITTED_ERROR * signal.displacement_error
    stiffness = scene.contact_stiffness()[[0, -1, -1]]
    overlap = (np.maximum(maxima, 0.0) / stiffness) ** OVERLAP_POWER
    slope = EXPONENT * stiffness * overlap ** (EXPONENT - 1.0)
    change = slope * (behind + np.array([signal.displacement_error, 0.0, 0.0]))
    if scene.has_dissipation:
        deep = (overlap[0] / scene.reference_overlap) ** LAWS[scene.dissipation].exponent
        change[0] += scene.D * deep * signal.velocity_error
    known = np.array([displacement, *maxima])
    return np.divide([behind, *change], known, out=np.zeros(4), where=known > 0.0)


def sampling_differences(full: tuple[np.ndarray, np.ndarray, np.ndarray],
                         half: tuple[np.ndarray, np.ndarray, np.ndarray]) -> np.ndarray:
    """Relative differences (4,) of a motion from half of the samples: of displacements, then of the largest forces.

    `full` is the motion from all samples and `half` that from every second one: times (T,), displacements (T, N) and
    largest input, output and elastic output force (3,), in any unit. Largest forces may agree by chance, so their
    difference counts as at least that of the displacements.
    """
    (times, displacement, maxima), (half_times, half_displacement, half_maxima) = full, half
    _, of_full, of_half = np.intersect1d(times, half_times, assume_unique=True, return_indices=True)
    difference = relative_difference(displacement[of_full], half_displacement[of_half])
    return np.array([difference, *np.maximum(difference, relative_changes(maxima, half_maxima))])
