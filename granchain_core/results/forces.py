"""Largest forces of a motion and their relative errors, as attributes and in words."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

#: Attributes with the relative errors of a run's largest forces.
RUN_ERRORS = ("error_estimate_input", "error_estimate_output", "error_estimate_elastic")


@dataclass(frozen=True)
class ForceErrors:
    """Relative errors of the largest input, output and elastic output force; None if none is stated."""

    input: float | None = None
    output: float | None = None
    elastic: float | None = None

    @classmethod
    def of(cls, errors: np.ndarray | None) -> ForceErrors:
        """Return the errors of an array (3,) in that order; a force that is zero has no relative error."""
        return cls() if errors is None else cls(*(e if math.isfinite(e) else None for e in errors.tolist()))

    @property
    def row(self) -> tuple[float, float, float]:
        """Return the errors of input, output and elastic force as numbers, NaN if none is stated."""
        values = (self.input, self.output, self.elastic)
        return tuple(np.nan if e is None else e for e in values)  # type: ignore[return-value]


class LargestForces(Protocol):
    """Results with largest forces [N]: a run, a driven motion, an observation, a point of a curve, an attractor."""

    @property
    def max_input_force(self) -> float: ...
    @property
    def max_output_force(self) -> float: ...
    @property
    def max_output_force_elastic(self) -> float: ...


class HasForces(LargestForces, Protocol):
    """Largest forces with their relative errors."""

    @property
    def force_errors(self) -> ForceErrors: ...


def force_sentences(motion: HasForces) -> list[str]:
    """Describe the largest forces and their errors in words."""
    errors = (motion.force_errors.output, motion.force_errors.elastic, motion.force_errors.input)
    forces = (motion.max_output_force, motion.max_output_force_elastic, motion.max_input_force)
    return [f"largest {name} force {force:.6g} N" + (", no error stated" if e is None else f", relative error {e:.1e}")
            for name, force, e in zip(("output", "elastic output", "input"), forces, errors, strict=True)]
