"""`observe`: model (3) of Zhang et al. 2016, a chain without driver whose first bead is pushed by a measured force.

    m ü_1 = F_in(t) − F_1 − k u_1,   wall and foundation as the scene has them

The motion is computed with steps that are halved until the stated integration error is small enough, by the rules of
`run` (integrate/stated.py), and once more from every second sample. `IRREGULAR` times the difference from that is
stated as the interpolation error. Where a contact's dashpot makes the force jump, it is of the order of the spacing and
depends on the place of the jump in it, so that one halving may gain little.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import asdict, dataclass

import numpy as np

from ..errors import BadInput
from ..execution.stop import Stop
from ..execution.stopwatch import Stopwatch
from ..experiment import Misfit, Sensors
from ..integrate.chain_in_pieces import MOST_HALVINGS, refined
from ..integrate.methods import RK4_SPLIT
from ..integrate.safety_factors import IRREGULAR
from ..integrate.stated import relative_changes, relative_difference
from ..results.recorded_motion import MOST_RECORDED, RecordedMotion, elastic_output, motion_columns, time_axis
from ..results.run import RUN_ERRORS, Cost, ForceErrors, said_forces
from ..scene import Scene
from ..scene.state import State, checked_start, rest
from ..tables import MAXIMA, Column, Table, bead_axis, contact_axis, provenance
from ..tables.provenance import Attribute
from .pushed_chain import PushedChain
from .record import ForceRecord, force_record, prepared

#: Difference of a computed output force from the measured one.
Residual = Misfit
#: What is written of it.
_WRITTEN = ("rms", "largest", "relative")


def written(found: Misfit | None) -> dict[str, float | None] | None:
    """A residual as JSON and files have it; None where nothing was measured."""
    return None if found is None else {name: getattr(found, name) for name in _WRITTEN}


@dataclass(frozen=True, eq=False, repr=False)
class Observation(RecordedMotion):
    """The motion of an observer at the T samples of its input, in SI.

    Attributes
    ----------
    scene : Scene
        The chain.
    record : ForceRecord
        The measured force that pushes bead 1.
    displacement, velocity : numpy.ndarray, shape (T, N)
        Of every bead: displacement from its rest position [m], and velocity [m/s].
    force : numpy.ndarray, shape (T, N + 1)
        Forces of the contacts [N]; column 0 is the input.
    max_output_force, max_output_force_elastic : float
        Largest force on the wall and its elastic part [N].
    force_errors : ForceErrors
        Relative errors of these two, by steps and interpolation (docs/observers.md). None is stated of the largest
        input force, which is a sample.
    integration_error, interpolation_error : float
        Relative errors of the displacements by the steps and by the interpolation between samples; their sum
        is `displacement_error`, also called `error_estimate` (docs/result-files.md, "Which name is which error").
    status : str
        "done" if `displacement_error` is at most the accuracy asked for, else "accuracy-not-reached".
    cost : Cost
        Computing time, steps and evaluations.
    residual, residual_elastic : Residual or None
        Difference from the measured output force, of the total and of the elastic force: `rms`, `largest` [N],
        `relative` (None if the measured force is 0 throughout), and the others of a `Misfit`.

    Examples
    --------
    >>> import numpy as np
    >>> from granchain_core import observe, scene
    >>> time = np.linspace(0.0, 1e-3, 65)
    >>> found = observe(scene("sec2").evolve(N=2), time, np.sin(np.pi * time / 1e-3) ** 2)
    >>> found.time.shape, found.force.shape
    ((65,), (65, 3))
    """

    scene: Scene
    record: ForceRecord
    displacement: np.ndarray
    velocity: np.ndarray
    force: np.ndarray
    max_output_force: float
    max_output_force_elastic: float
    force_errors: ForceErrors
    integration_error: float
    interpolation_error: float
    status: str
    cost: Cost
    residual: Residual | None
    residual_elastic: Residual | None

    @property
    def time(self) -> np.ndarray:
        """Times of the samples (T,) [s], as in the input."""
        return self.record.time

    @property
    def max_input_force(self) -> float:
        """Largest sample of the force that pushes bead 1 [N]."""
        return float(self.input_force.max())

    @property
    def displacement_error(self) -> float:
        """Both errors together."""
        return self.integration_error + self.interpolation_error

    def tables(self) -> tuple[Table, ...]:
        """One table, `observation`, laid out as a run's is, so that one reader reads both."""
        axes = {**time_axis(self.time, "time as in the measured force"), **bead_axis(self.scene.N),
                **contact_axis(self.scene.N)}
        columns = motion_columns(self)
        columns["force"] = Column(self.force, ("time", "contact"), "N",
                                  "contact force, elastic and damping; contact 0 is the given force")
        if self.record.output is not None:
            columns["measured_output_force"] = Column(self.record.output, ("time",), "N", "the measured output force")
        return (Table("observation", axes, columns),)

    def attributes(self) -> dict[str, Attribute]:
        """Status, largest forces, errors, how the input was read, residuals, cost, and where it comes from."""
        residuals: dict[str, Attribute] = {
            name: json.dumps(written(found)) for name in ("residual", "residual_elastic")
            if (found := getattr(self, name)) is not None}
        return {**provenance(self.scene, self.cost.method, self.displacement_error), "status": self.status,
                "integration_error": self.integration_error, "interpolation_error": self.interpolation_error,
                "input": "; ".join((self.record.understood, *self.record.notes)),
                "cost": json.dumps(asdict(self.cost)), **residuals, **{name: getattr(self, name) for name in MAXIMA},
                **dict(zip(RUN_ERRORS, self.force_errors.row, strict=True))}

    def summary(self) -> list[str]:
        """Largest forces, errors, and the difference from what was measured."""
        duration, status = self.time[-1] - self.time[0], self.status.replace("-", " ")
        sentences = [f"{len(self.time)} samples over {duration:.4g} s; {status}", *said_forces(self)[:2],
                     f"relative error of displacements {self.integration_error:.1e} by steps, "
                     f"{self.interpolation_error:.1e} between samples"]
        if self.residual is not None:
            sentences.append(f"model − measured: {self.residual.words()}")
        return sentences


def observe(scene: Scene, time: object, force: object = None, output: object = None, start: State | None = None,
            offset: float | str = 0.0, gap: str = "refuse", stop: Stop | None = None,
            progress: Callable[[float], None] | None = None, bandwidth: float = math.inf) -> Observation:
    """The observer of model (3), Zhang et al. 2016: the chain without driver, a given force on its first bead.

    Steps are halved until the error by the steps is at most the accuracy asked for. A further computation from every
    second sample gives the interpolation error (docs/observers.md).

    Parameters
    ----------
    scene : Scene
        The chain; its driver is left out.
    time : array_like, shape (T,), or ForceRecord
        Times of the samples [s], ascending; or a record that was read from a file.
    force : array_like, shape (T,)
        Force on bead 1 [N].
    output : array_like, shape (T,), optional
        Measured output force at the same times [N], to compare with.
    start : State, optional
        Where the chain begins; at rest if not given.
    offset : float or "median"
        Subtracted from the force [N].
    gap : str
        Treatment of a gap in the record: "refuse", "zero" or "interpolate".
    stop : Stop, optional
        Ends the computation when another thread sets it.
    progress : callable, optional
        Called with the fraction that is done, 0 to 1.
    bandwidth : float
        Bandwidth of the force sensors [Hz]. The computed output force passes their low-pass before it is compared, and
        a record may be sampled as slowly as their shortest pulse allows. The given force is applied as it is.

    Returns
    -------
    Observation
        The motion at every sample. Its `status` is "done", or "accuracy-not-reached" where samples are too far apart
        for the accuracy asked for, or where the observer magnifies every error.

    Raises
    ------
    BadInput
        The arrays do not fit together, times do not ascend, or there is a gap.
    ComputationError
        The motion is no longer finite.
    Cancelled
        `stop` was set.

    Examples
    --------
    >>> from granchain_core import observe, run, scene
    >>> chain = scene("sec2").evolve(N=2, f=2000.0)
    >>> true = run(chain, periods=0, record=4, samples=256)
    >>> found = observe(chain, true.time, true.input_force, true.output_force)
    >>> found.displacement.shape, found.residual.relative < 0.05
    ((1025, 2), True)
    """
    record = time if isinstance(time, ForceRecord) else force_record(time, force, output)
    sensors = Sensors(bandwidth=bandwidth)
    record = prepared(record, scene, offset, gap, sensors)
    if len(record.time) * scene.N > MOST_RECORDED:
        raise BadInput(f"{len(record.time)} samples for {scene.N} beads are more than {MOST_RECORDED:.0e} values; "
                       f"give at most {MOST_RECORDED // scene.N} samples.")
    spent = Stopwatch()
    stop = Stop() if stop is None else stop
    begin = rest(scene) if start is None else checked_start(scene, start)
    chain = PushedChain(scene, record, stop)
    now, maxima, halvings, integration, _ = refined(
        chain, begin, lambda done: None if progress is None else progress(done / (MOST_HALVINGS + 1)))
    thin, kept, of_thin = record.thinned()
    thinned = PushedChain(scene, thin, stop, chain.counts)
    coarse = thinned.run(begin, halvings)
    changes = [relative_difference(now.displacement[kept], coarse.displacement[of_thin]),
               *relative_changes(maxima, thinned.maxima)]
    interpolation = IRREGULAR * np.maximum(changes, changes[0])  # two largest forces may agree by chance
    errors, scales = integration + interpolation, chain.scaled.scales
    displacement = now.displacement * scales.length
    forces = now.force * scales.force
    forces[:, 0] = record.force
    elastic = elastic_output(scene, displacement[:, -1])
    if progress is not None:
        progress(1.0)
    return Observation(
        scene=scene, record=record, displacement=displacement, velocity=now.velocity * scales.velocity, force=forces,
        max_output_force=float(maxima[1]) * scales.force, max_output_force_elastic=float(maxima[2]) * scales.force,
        integration_error=float(integration[0]), interpolation_error=float(interpolation[0]),
        status="done" if errors[0] <= scene.accuracy else "accuracy-not-reached",
        force_errors=ForceErrors.of(np.array([np.nan, *errors[2:]])),
        cost=Cost.of(spent.seconds, chain.counts, RK4_SPLIT),
        residual=residual(sensors.passed(record.time, forces[:, -1], record.time), record.output),
        residual_elastic=residual(sensors.passed(record.time, elastic, record.time), record.output),
    )


def residual(computed: np.ndarray, measured: np.ndarray | None) -> Residual | None:
    """Difference of `computed` from `measured`; None where nothing was measured."""
    return None if measured is None else Misfit.of(computed, measured)
