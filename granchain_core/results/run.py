"""The result of a run, in SI units."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field

import numpy as np

from ..errors import BadInput
from ..integrate import Counts
from ..integrate.engine import Engine
from ..kernels.samples import Samples
from ..scene import Scene
from ..scene.state import State
from ..scene.validity import overlap_warnings
from ..tables import MAXIMA, Column, Table, axis, bead_axis, contact_axis, force_columns, or_nan, provenance
from ..tables.provenance import Attribute
from .forces import RUN_ERRORS, ForceErrors, force_sentences
from .recorded_motion import RecordedMotion, motion_columns, time_axis
from .regime import Regime

#: Starts of runs, the values of `start`: at rest, with the initial velocities of its scene, or in a given state.
AT_REST, INITIAL_VELOCITY, GIVEN_STATE = "rest", "initial velocity", "given state"
RUN_STARTS = (AT_REST, INITIAL_VELOCITY, GIVEN_STATE)


def start_words(scene: Scene, start: State | None) -> str:
    """Return the start of a motion of `scene` from `start`, one of `RUN_STARTS`; without `start`, the scene's own."""
    if start is not None:
        return GIVEN_STATE
    return INITIAL_VELOCITY if scene.moves_at_start else AT_REST


@dataclass(frozen=True)
class Cost:
    """The cost of a computation.

    Attributes
    ----------
    wall_s : float
        Wall-clock time [s]; for a run, without the compilation of kernels.
    steps : int
        Accepted steps.
    rhs : int
        Evaluations of the equations of motion.
    events : int
        Contact events that were located.
    method : str
        Name of the method.

    Examples
    --------
    >>> from granchain_core import run, scene
    >>> cost = run(scene("sec2").evolve(N=2, f=2000.0), periods=2, record=1, samples=8).cost
    >>> cost.method, cost.steps > 0
    ('rk4-split', True)
    """

    wall_s: float
    steps: int
    rhs: int
    events: int
    method: str

    @classmethod
    def of(cls, wall_s: float, counts: Counts, method: str) -> Cost:
        """Return the cost from an engine's counters."""
        return cls(wall_s, counts.steps, counts.rhs, counts.events, method)


@dataclass(frozen=True, eq=False)
class Jumps:
    """Forces that jump from 0 because a contact with a linear dashpot closes in motion. Openings are not among them.

    Methods that do not locate events only keep the jumps of the first and last contact.

    `time` (J,) [s], `contact` (J,) and `force` (J,) [N], the force just after the jump (its right limit). `missing`
    counts further jumps that were not kept, `unresolved` those of touches shorter than a step, which methods without
    located events do not resolve.
    """

    time: np.ndarray = field(default_factory=lambda: np.zeros(0))
    contact: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    force: np.ndarray = field(default_factory=lambda: np.zeros(0))
    missing: int = 0
    unresolved: int = 0

    def of(self, contact: int) -> tuple[np.ndarray, np.ndarray]:
        """Return the times and forces of the jumps of one contact."""
        of_contact = self.contact == contact
        return self.time[of_contact], self.force[of_contact]

    def axis(self) -> dict[str, Column]:
        """Return the axis of the jumps, numbered from 0."""
        return axis("jump", np.arange(len(self.time)), "1", "number of the closing at which a contact force jumps")

    def columns(self) -> dict[str, Column]:
        """Return times, contacts and forces of the jumps as columns of a table."""
        more = {"missing": self.missing, "unresolved": self.unresolved}
        return {"jump_time": Column(self.time, ("jump",), "s", "time at which a contact closes in motion", more),
                "jump_contact": Column(self.contact, ("jump",), "1", "contact that closes"),
                "jump_force": Column(self.force, ("jump",), "N", "its force just after, where it was 0 before")}


@dataclass(frozen=True, eq=False, repr=False)
class Run(RecordedMotion):
    """A recorded motion: T samples of N beads and N + 1 contacts, in SI units.

    Attributes
    ----------
    scene : Scene
        The chain.
    samples : int
        Samples per drive period.
    time : numpy.ndarray, shape (T,)
        Time [s] from drive phase 0 of the first period, including discarded periods.
    displacement, velocity : numpy.ndarray, shape (T, N)
        Displacement of every bead from its rest position [m], and velocity [m/s].
    force : numpy.ndarray, shape (T, N + 1)
        Total force (elastic and damping) of every contact [N].
    drive_displacement : numpy.ndarray, shape (T,)
        Displacement of the driver [m].
    kinetic_energy : numpy.ndarray, shape (T, N)
        Kinetic energy of every bead [J].
    input_force, output_force, output_force_elastic : numpy.ndarray, shape (T,)
        Force of the driver on bead 1, force on the wall, and the elastic part of the force on the wall, which is the
        paper's F_out [N].
    overlap : numpy.ndarray, shape (T, N + 1)
        Overlap of every contact, negative where there is a gap [m].
    max_input_force, max_output_force, max_output_force_elastic : float
        Suprema over the recorded time [N], including times between samples and the right limits at `jumps`.
    force_errors : ForceErrors
        Stated relative errors of these three suprema, `input`, `output`, `elastic`: numerical error only, an empirical
        bound (docs/accuracy.md), not a proof; None if none is stated.
    displacement_error : float or None
        Stated largest error of any displacement over the largest displacement: numerical error only, an empirical
        bound (docs/accuracy.md), not a proof; None if none is stated. Also called `error_estimate`
        (docs/result-files.md, "Which name is which error").
    energy_residual : float or None
        Largest |work − loss − change of stored energy| of the record over the largest of |work|, |loss| and the stored
        energy above that of the preload at rest; None if no account was kept.
    regime : Regime
        The kind of motion, with the evidence.
    status : str
        "done", "accuracy-not-reached" or "over-budget".
    start : str
        How the motion started, one of `RUN_STARTS`: "rest", "initial velocity" or "given state".
    cost : Cost
        Computing time, steps and evaluations.
    jumps : Jumps
        Forces that jump from 0 because a contact with a linear dashpot closes in motion.

    Examples
    --------
    >>> from granchain_core import run, scene
    >>> result = run(scene("sec2").evolve(N=2, f=2000.0), periods=60, record=1, samples=8)
    >>> result.kinetic_energy.shape
    (9, 2)
    >>> bool(result.max_output_force >= result.output_force.max())
    True
    """

    scene: Scene
    samples: int
    time: np.ndarray
    displacement: np.ndarray
    velocity: np.ndarray
    force: np.ndarray
    drive_displacement: np.ndarray
    max_input_force: float
    max_output_force: float
    max_output_force_elastic: float
    status: str
    regime: Regime
    displacement_error: float | None
    energy_residual: float | None
    cost: Cost
    start: str = AT_REST
    force_errors: ForceErrors = field(default_factory=ForceErrors)
    jumps: Jumps = field(default_factory=Jumps)

    @property
    def overlap(self) -> np.ndarray:
        """Overlap of every contact (T, N + 1) [m], negative where there is a gap."""
        rows = len(self.time)
        bodies = np.hstack([self.drive_displacement[:, None], self.displacement, np.zeros((rows, 1))])
        return bodies[:, :-1] - bodies[:, 1:] + self.scene.static_overlap()

    def tables(self) -> tuple[Table, ...]:
        """Return one table, `run`: the motion over time, bead and contact, the jumps of forces, and single values."""
        axes = time_axis(self.time, "time since the start, at drive phase 0")
        return (Table("run", {**axes, **bead_axis(self.scene.N), **contact_axis(self.scene.N), **self.jumps.axis()},
                      {**motion_columns(self), **self.jumps.columns(), **self._single()}),)

    def _single(self) -> dict[str, Column]:
        """Return largest forces, errors and regime as columns without an axis."""
        forces = np.array([getattr(self, name) for name in MAXIMA])
        kinds = ("input", "output", "elastic output")
        errors = {name: Column(np.array(error), (), "1", f"relative error of the largest {force} force, NaN if unknown")
                  for name, error, force in zip(RUN_ERRORS, self.force_errors.row, kinds, strict=True)}
        return {**force_columns(forces, (), "over the recorded time"), **errors,
                "error_estimate_displacement": Column(
                    np.array(or_nan(self.displacement_error)), (), "1",
                    "largest error of a displacement over the largest displacement, NaN if unknown"),
                "regime": Column(np.array(self.regime.name, dtype=object), (), "", "what kind of motion it is"),
                "period": Column(np.array(self.regime.period or 0), (), "1",
                                 "period in drive periods, 0 where not periodic")}

    def attributes(self) -> dict[str, Attribute]:
        """Return largest forces with their errors, regime, status, start, warnings, cost and provenance."""
        return {**provenance(self.scene, self.cost.method, self.displacement_error),
                "status": self.status, "start": self.start,
                "warnings": json.dumps(overlap_warnings(self.scene, self.overlap.max(axis=0))),
                "energy_residual": or_nan(self.energy_residual), "samples_per_period": self.samples,
                "cost": json.dumps(asdict(self.cost)), "regime": json.dumps(self.regime.to_json()),
                **{name: getattr(self, name) for name in MAXIMA},
                **dict(zip(RUN_ERRORS, self.force_errors.row, strict=True))}

    def summary(self) -> list[str]:
        """Return regime, largest forces and errors in words."""
        error = self.displacement_error
        reached = "no error stated" if error is None else f"relative error {error:.1e}"
        return [self.regime.sentence, *force_sentences(self),
                f"{len(self.time)} samples; displacements: {reached}; {self.status.replace('-', ' ')}"]


def require_run(value: object) -> None:
    """Raise `BadInput` for anything but a recorded motion; the message says how to get one."""
    if isinstance(value, Run):
        return
    near = "its attribute `run` is one" if isinstance(getattr(value, "run", None), Run) else \
        "run(scene) and settle(scene).run are two"
    raise BadInput(f"A recorded motion is given as a Run, not as a value of type {type(value).__name__}; {near}.")


def residual(energy: np.ndarray | None, static: float) -> float | None:
    """Return the largest |work − loss − change of stored energy| of a record, over the energies involved in the motion.

    These are the largest of |work|, |loss| and |stored energy − `static`|, where `static` is the energy of the contacts
    at rest under the preload (`ScaledChain.static_energy`). `energy` (T, 3) has the columns stored, work, lost; it is
    None if no account was kept.
    """
    if energy is None:
        return None
    stored, work, lost = (energy - energy[0]).T
    largest = max(float(np.abs(part).max()) for part in (work, lost, energy[:, 0] - static))
    return float(np.abs(work - lost - stored).max() / largest) if largest > 0.0 else 0.0


def run_from(engine: Engine, samples: Samples, first_sample: int, regime: Regime, error: float | None,
             cost: Cost, *, start: str, status: str = "done", force_errors: np.ndarray | None = None) -> Run:
    """Return the `Run` of recorded samples; time counts from drive phase 0, and `first_sample` is the index of row 0.

    `start` is how the motion started, one of `RUN_STARTS`.

    The arrays of `samples` become the run's and are scaled in place. For a long chain, they take hundreds of megabytes,
    and copying took up to a third of a second, during which the computation could not be cancelled.
    """
    scene, scales = engine.scaled.scene, engine.scaled.scales
    index = first_sample + np.arange(len(samples.displacement))
    inside = np.mod(index, engine.samples)
    maxima = scales.forces(np.where(np.isfinite(engine.maxima), engine.maxima, 0.0))
    scales.convert_in_place(samples.displacement, samples.velocity, samples.force)
    return Run(
        scene=scene, samples=engine.samples,
        time=(index // engine.samples + inside / engine.samples) * scene.period,
        displacement=samples.displacement, velocity=samples.velocity, force=samples.force,
        drive_displacement=scene.drive_amplitude * np.sin(2 * np.pi * inside / engine.samples),
        max_input_force=float(maxima[0]), max_output_force=float(maxima[1]), max_output_force_elastic=float(maxima[2]),
        status=status, regime=regime, displacement_error=error,
        energy_residual=residual(samples.energy, engine.scaled.static_energy), cost=cost,
        start=start, force_errors=ForceErrors.of(force_errors), jumps=_jumps(engine, first_sample),
    )


def _jumps(engine: Engine, first_sample: int) -> Jumps:
    """Return the jumps of the engine's last record, in SI units."""
    rows, scene = engine.closings, engine.scaled.scene
    period = (first_sample + rows[:, 0].astype(np.int64)) // engine.samples
    return Jumps((period + rows[:, 1] / (2.0 * np.pi)) * scene.period, contact=rows[:, 2].astype(np.int64),
                 force=engine.scaled.scales.forces(rows[:, 3]), missing=engine.closings_missing,
                 unresolved=engine.unresolved)
