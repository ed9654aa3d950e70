"""Target of a fit: series at several drive frequencies with common parameters."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..errors import BadInput
from ..execution.stop import Stop
from ..scene import Amplitude, Scene
from .evaluation import Compared, Evaluation
from .series_target import SeriesTarget


@dataclass(frozen=True, eq=False)
class RecordsTarget(Compared):
    """Measured series at several drive frequencies; all parameters except A0@f are common to them.

    Each of the `records` has a `frequency`. Either all of them have an error or none has.
    """

    records: tuple[SeriesTarget, ...]

    def __post_init__(self) -> None:
        if not self.records:
            raise BadInput("There is no record to fit.")
        for number, record in enumerate(self.records, start=1):
            if record.frequency is None:
                raise BadInput(f"Record {number} of {len(self.records)} has no drive frequency; give each its own.")
        if len({record.sigma_known for record in self.records}) > 1:
            raise BadInput("Some of the records have an error and some do not; give an error for all of them, or for "
                           "none.")

    @property
    def frequencies(self) -> np.ndarray:
        """The distinct drive frequencies [Hz], ascending."""
        return np.unique([record.frequency for record in self.records if record.frequency is not None])

    @property
    def sigma_known(self) -> bool:
        """Whether the standard deviations were given."""
        return self.records[0].sigma_known

    @property
    def sizes(self) -> list[int]:
        """Number of data of each record."""
        return [len(record.channels) * len(record.time) for record in self.records]

    def where(self, datum: int) -> str:
        """The record, force and time of a datum, in words."""
        for record, size in zip(self.records, self.sizes, strict=True):
            if datum < size:
                return f"{record.where(datum)} of the record at {record.frequency:g} Hz"
            datum -= size
        raise IndexError(datum)

    def evaluate(self, scene: Scene, amplitude: Amplitude | None, stop: Stop | None) -> Evaluation:
        """Compute the residuals of all records, one after another, in standard deviations, and the model's forces [N].

        Raises `Cancelled`.
        """
        evaluations = [record.evaluate(scene, amplitude, stop) for record in self.records]
        return Evaluation(np.concatenate([evaluation.residuals for evaluation in evaluations]),
                          sum(evaluation.log_variance for evaluation in evaluations),
                          tuple(regime for evaluation in evaluations for regime in evaluation.regimes),
                          np.concatenate([evaluation.model for evaluation in evaluations]))

    def parts(self, evaluation: Evaluation) -> Iterator[tuple[SeriesTarget, slice, str]]:
        """Yield each record with the slice of its data in the evaluation, and the model's regime there."""
        begin = 0
        for record, size, regime in zip(self.records, self.sizes, evaluation.regimes, strict=True):
            yield record, slice(begin, begin + size), regime
            begin += size
