"""The result of `observe`: the motion of a force-driven chain, its errors, and its difference from the measurement."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass

import numpy as np

from ..experiment import Misfit
from ..results.forces import RUN_ERRORS, ForceErrors, force_sentences
from ..results.recorded_motion import RecordedMotion, motion_columns, time_axis
from ..results.run import Cost
from ..scene import Scene
from ..tables import MAXIMA, Column, Table, bead_axis, contact_axis, provenance
from ..tables.provenance import Attribute
from .record import ForceRecord

#: Difference of a computed output force from the measured one.
Residual = Misfit
#: The numbers of a residual that are written to JSON and files.
_WRITTEN = ("rms", "largest", "relative")


def written(difference: Misfit | None) -> dict[str, float | None] | None:
    """A residual as written to JSON and files; None if nothing was measured."""
    return None if difference is None else {name: getattr(difference, name) for name in _WRITTEN}


@dataclass(frozen=True, eq=False, repr=False)
class Observation(RecordedMotion):
    """The motion of an observer at the T samples of its input, in SI.

    Attributes
    ----------
    scene : Scene
        The chain.
    record : ForceRecord
        The measured force on bead 1.
    displacement, velocity : numpy.ndarray, shape (T, N)
        Displacement of every bead from its rest position [m], and its velocity [m/s].
    force : numpy.ndarray, shape (T, N + 1)
        Forces of the contacts [N]; column 0 is the input.
    max_output_force, max_output_force_elastic : float
        Largest force on the wall and its elastic part [N].
    force_errors : ForceErrors
        Relative errors of these two, due to steps and interpolation (docs/observers.md). The largest input force has no
        stated error, because it is a sample.
    integration_error, interpolation_error : float
        Relative errors of the displacements due to the steps and to the interpolation between samples; their sum
        is `displacement_error`, also called `error_estimate` (docs/result-files.md, "Which name is which error").
    status : str
        "done" if `displacement_error` is at most the requested accuracy, otherwise "accuracy-not-reached".
    cost : Cost
        Computing time, steps and evaluations.
    residual, residual_elastic : Residual or None
        Difference of the total and of the elastic force from the measured output force: `rms`, `largest` [N],
        `relative` (None if the measured force is 0 throughout), and the other attributes of a `Misfit`.

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
        """Largest sample of the force on bead 1 [N]."""
        return float(self.input_force.max())

    @property
    def displacement_error(self) -> float:
        """The sum of the integration error and the interpolation error."""
        return self.integration_error + self.interpolation_error

    def tables(self) -> tuple[Table, ...]:
        """One table, `observation`, with the layout of a run's, so that one reader can read both."""
        axes = {**time_axis(self.time, "time as in the measured force"), **bead_axis(self.scene.N),
                **contact_axis(self.scene.N)}
        columns = motion_columns(self)
        columns["force"] = Column(self.force, ("time", "contact"), "N",
                                  "contact force, elastic and damping; contact 0 is the given force")
        if self.record.output is not None:
            columns["measured_output_force"] = Column(self.record.output, ("time",), "N", "the measured output force")
        return (Table("observation", axes, columns),)

    def attributes(self) -> dict[str, Attribute]:
        """Status, largest forces, errors, how the input was read, residuals, cost and provenance."""
        residuals: dict[str, Attribute] = {
            name: json.dumps(written(difference)) for name in ("residual", "residual_elastic")
            if (difference := getattr(self, name)) is not None}
        return {**provenance(self.scene, self.cost.method, self.displacement_error), "status": self.status,
                "integration_error": self.integration_error, "interpolation_error": self.interpolation_error,
                "input": "; ".join((self.record.understood, *self.record.notes)),
                "cost": json.dumps(asdict(self.cost)), **residuals, **{name: getattr(self, name) for name in MAXIMA},
                **dict(zip(RUN_ERRORS, self.force_errors.row, strict=True))}

    def summary(self) -> list[str]:
        """Largest forces, errors, and the difference from the measurement."""
        duration, status = self.time[-1] - self.time[0], self.status.replace("-", " ")
        sentences = [f"{len(self.time)} samples over {duration:.4g} s; {status}", *force_sentences(self)[:2],
                     f"relative error of displacements {self.integration_error:.1e} by steps, "
                     f"{self.interpolation_error:.1e} between samples"]
        if self.residual is not None:
            sentences.append(f"model − measured: {self.residual.words()}")
        return sentences


def residual(computed: np.ndarray, measured: np.ndarray | None) -> Residual | None:
    """Difference of `computed` from `measured`; None if nothing was measured."""
    return None if measured is None else Misfit.of(computed, measured)
