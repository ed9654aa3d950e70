"""`observe`: model (3) of Zhang et al. 2016, a chain without driver, with a measured force on its first bead.

    m ü_1 = F_in(t) − F_1 − k u_1,   wall and foundation as the scene has them

The motion is computed with steps that are halved until the stated integration error is small enough, by the rules of
`run` (integrate/stated.py). It is computed once more from every second sample: `IRREGULAR` times the difference is
stated as the interpolation error. Where a contact's dashpot makes the force jump, this error is of the order of the
sampling interval and depends on the place of the jump in it, so that halving the interval may gain little.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ..errors import BadInput
from ..execution.stop import Stop
from ..execution.stopwatch import Stopwatch
from ..experiment import Sensors
from ..integrate.chain_in_pieces import MOST_HALVINGS, Refined, refined
from ..integrate.methods import RK4_SPLIT
from ..integrate.safety_factors import IRREGULAR
from ..integrate.stated import relative_changes, relative_difference
from ..results.forces import ForceErrors
from ..results.recorded_motion import MOST_RECORDED, elastic_output
from ..results.run import Cost
from ..scene import Scene
from ..scene.state import State, checked_start, rest
from .force_driven_chain import ForceDrivenChain
from .observation import Observation, residual
from .record import ForceRecord, force_record, prepared


def observe(scene: Scene, time: object, force: object = None, output: object = None, start: State | None = None,
            offset: float | str = 0.0, gap: str = "refuse", stop: Stop | None = None,
            progress: Callable[[float], None] | None = None, bandwidth: float = math.inf) -> Observation:
    """Compute the observer of model (3), Zhang et al. 2016: the chain without driver, a given force on its first bead.

    Steps are halved until the error due to the steps is at most the requested accuracy. A further computation from
    every second sample gives the interpolation error (docs/observers.md).

    Parameters
    ----------
    scene : Scene
        The chain; its driver is left out.
    time : array_like, shape (T,), or ForceRecord
        Times of the samples [s], ascending, or a record that was read from a file, instead of all three arrays.
    force : array_like, shape (T,), optional
        Force on bead 1 [N]; required with times.
    output : array_like, shape (T,), optional
        Measured output force at the same times [N], for comparison.
    start : State, optional
        Where the chain starts; by default at rest.
    offset : float or "median"
        Offset that is subtracted from the force [N].
    gap : str
        Treatment of a gap in the record: "refuse", "zero" or "interpolate".
    stop : Stop, optional
        Ends the computation when another thread sets it.
    progress : callable, optional
        Called with the completed fraction, 0 to 1.
    bandwidth : float
        Bandwidth of the force sensors [Hz]. The computed output force passes their low-pass before it is compared, and
        a record may be sampled as slowly as their shortest pulse allows. The given force is applied unchanged.

    Returns
    -------
    Observation
        The motion at every sample. Its `status` is "done", or "accuracy-not-reached" if samples are too far apart for
        the requested accuracy, or if the observer magnifies every error.

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
    >>> observed = observe(chain, true.time, true.input_force, true.output_force)
    >>> observed.displacement.shape, observed.residual.relative < 0.05
    ((1025, 2), True)
    """
    sensors = Sensors(bandwidth=bandwidth)
    record = prepared(_record_of(time, force, output), scene, offset, gap, sensors)
    _check_size(record, scene)
    spent = Stopwatch()
    begin = rest(scene) if start is None else checked_start(scene, start)
    chain = ForceDrivenChain(scene, record, Stop() if stop is None else stop)
    tell = progress or (lambda done: None)
    finest = refined(chain, begin, lambda halvings: tell(halvings / (MOST_HALVINGS + 1)))
    interpolation = _interpolation_errors(chain, record, begin, finest)
    tell(1.0)
    return _observation(chain, record, sensors, finest, interpolation, spent)


def _record_of(time: object, force: object, output: object) -> ForceRecord:
    """The record itself if `time` is one, otherwise that of the arrays. Raises `BadInput` if both are given."""
    if not isinstance(time, ForceRecord):
        return force_record(time, force, output)
    if force is not None or output is not None:
        raise BadInput("A record has its own forces; give either a record, or time, force and output.")
    return time


def _check_size(record: ForceRecord, scene: Scene) -> None:
    """Raise `BadInput` if the motion would have too many values."""
    if len(record.time) * scene.N > MOST_RECORDED:
        raise BadInput(f"{len(record.time)} samples for {scene.N} beads are more than {MOST_RECORDED:.0e} values; "
                       f"give at most {MOST_RECORDED // scene.N} samples.")


def _interpolation_errors(chain: ForceDrivenChain, record: ForceRecord, begin: State, finest: Refined) -> np.ndarray:
    """Relative errors (4,) of displacements and largest forces due to the interpolation between the record's samples.

    They follow from the difference between the `finest` motion and one from every second sample.
    """
    thin, kept, of_thin = record.thinned()
    thinned = chain.driven_by(thin)
    coarse = thinned.run(begin, finest.halvings)
    changes = [relative_difference(finest.samples.displacement[kept], coarse.displacement[of_thin]),
               *relative_changes(finest.maxima, thinned.maxima)]
    return np.asarray(IRREGULAR * np.maximum(changes, changes[0]))  # two largest forces may agree by chance


def _observation(chain: ForceDrivenChain, record: ForceRecord, sensors: Sensors, finest: Refined,
                 interpolation: np.ndarray, spent: Stopwatch) -> Observation:
    """The result in SI; `interpolation` are the relative errors (4,) due to the interpolation."""
    scene, scales, motion = chain.scaled.scene, chain.scaled.scales, finest.samples
    displacement, forces = scales.displacements(motion.displacement), scales.forces(motion.force)
    forces[:, 0] = record.force
    elastic = elastic_output(scene, displacement[:, -1])
    errors = finest.errors + interpolation
    _, output, output_elastic = (scales.forces(float(largest)) for largest in finest.maxima)
    return Observation(
        scene=scene, record=record, displacement=displacement, velocity=scales.velocities(motion.velocity),
        force=forces, max_output_force=output, max_output_force_elastic=output_elastic,
        integration_error=float(finest.errors[0]), interpolation_error=float(interpolation[0]),
        status="done" if errors[0] <= scene.accuracy else "accuracy-not-reached",
        force_errors=ForceErrors.of(np.array([np.nan, *errors[2:]])),
        cost=Cost.of(spent.seconds, chain.counts, RK4_SPLIT),
        residual=residual(sensors.passed(record.time, forces[:, -1], record.time), record.output),
        residual_elastic=residual(sensors.passed(record.time, elastic, record.time), record.output),
    )
