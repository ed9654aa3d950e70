"""Results of a resonance curve: the curve and its points."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass, field

import numpy as np

from ...results.forces import ForceErrors, force_sentences
from ...results.regime import Regime
from ...results.regime_columns import evidence_columns, regime_columns
from ...scene import Amplitude, Scene
from ...scene.state import State
from ...tables import (
    MAXIMA,
    Column,
    Labelled,
    Table,
    amplitude_attribute,
    axis,
    error_columns,
    force_columns,
    provenance,
)
from ...tables.provenance import Attribute
from ..batch.starts import settling_methods
from ..steady_state import SteadyState


@dataclass(frozen=True, eq=False)
class CurvePoint:
    """The steady state at one frequency.

    Attributes
    ----------
    frequency : float
        Drive frequency [Hz].
    max_output_force, max_output_force_elastic, max_input_force : float
        Largest forces [N]; where the motion is not periodic, those of the last periods. NaN where the computation
        failed.
    regime : Regime
        What kind of motion it is.
    force_errors : ForceErrors
        Relative errors of the three; each None where the motion is not periodic.
    state : State
        State of the chain at drive phase 0.
    failure : str
        A sentence where the computation failed.
    status : str
        "done", or the failure's name.

    Examples
    --------
    >>> from granchain_core import resonance_curve, scene
    >>> point = resonance_curve(scene("sec2").evolve(N=2), [2000.0]).points[0]
    >>> point.status, point.regime.period, point.force_errors.output < 1e-3
    ('done', 1, True)
    """

    frequency: float
    max_output_force: float
    max_output_force_elastic: float
    max_input_force: float
    regime: Regime
    force_errors: ForceErrors
    state: State
    failure: str = ""
    status: str = "done"

    @classmethod
    def of(cls, state: SteadyState) -> CurvePoint:
        """The point of a steady state."""
        input_force, output_force, elastic = map(float, state.maxima)
        return cls(state.scene.f, max_output_force=output_force, max_output_force_elastic=elastic,
                   max_input_force=input_force, regime=state.regime, force_errors=state.force_errors, state=state.state,
                   failure=state.failure, status=state.status)

    @property
    def error_estimate(self) -> float | None:
        """`force_errors.output`, under its name in the command line's JSON.

        For a single motion, this name means the error of the displacements (docs/result-files.md, "Which name is which
        error").
        """
        return self.force_errors.output


@dataclass(eq=False, repr=False)
class Curve(Labelled):
    """A resonance curve in ascending frequency.

    Attributes
    ----------
    scene : Scene
        The chain.
    start : str
        One of `CURVE_STARTS` (order.py).
    points : list of CurvePoint
        One for each frequency.
    wall_s : float
        Wall-clock time [s].
    amplitude : Amplitude or None
        The drive amplitude over the frequency, where it is not that of the scene.

    Examples
    --------
    >>> from granchain_core import resonance_curve, scene
    >>> curve = resonance_curve(scene("sec2").evolve(N=2), [1800.0, 2000.0])
    >>> curve.column("max_input_force").shape
    (2,)
    """

    scene: Scene
    start: str
    points: list[CurvePoint] = field(default_factory=list)
    wall_s: float = 0.0
    amplitude: Amplitude | None = None

    @property
    def varied(self) -> tuple[str, ...]:
        """The frequency, and the drive amplitude where it follows the frequency."""
        return ("f",) if self.amplitude is None else ("f", "A0")

    @property
    def drive_amplitude(self) -> np.ndarray:
        """A0 at every point [m]."""
        return np.array([self.scene.A0 if self.amplitude is None else self.amplitude.at(p.frequency)
                         for p in self.points])

    def column(self, name: str) -> np.ndarray:
        """One attribute of all points as an array."""
        return np.array([getattr(p, name) for p in self.points])

    def tables(self) -> tuple[Table, ...]:
        """One table, `curve`: largest forces with errors, regime with its evidence, and status, over the frequency."""
        along = ("frequency",)
        forces = np.array([[getattr(p, name) for name in MAXIMA] for p in self.points]).reshape(-1, 3)
        errors = np.array([p.force_errors.row for p in self.points]).reshape(-1, 3)
        drive = {} if self.amplitude is None else {
            "drive_amplitude": Column(self.drive_amplitude, along, "m", "drive amplitude A0")}
        outcomes = np.array([p.status for p in self.points], dtype=object)
        return (Table("curve", axis("frequency", self.column("frequency"), "Hz", "drive frequency"), {
            **drive, **force_columns(forces, along), **error_columns(errors, along),
            **regime_columns([p.regime for p in self.points], "frequency"),
            **evidence_columns([p.regime for p in self.points], "frequency"),
            "status": Column(outcomes, along, "", "done, or how the computation failed")}),)

    def attributes(self) -> dict[str, Attribute]:
        """Start, cost and provenance; `accuracy_reached` is the largest error of an output force.

        Only points that were settled alone were computed to `accuracy_asked`, at best to `CURVE_ACCURACY`.
        """
        method = settling_methods(self.scene, "point")
        reached = [p.force_errors.output for p in self.points if p.force_errors.output is not None]
        return {**provenance(self.scene, method, max(reached) if reached else None), "start": self.start,
                "wall_s": self.wall_s, **amplitude_attribute(self.amplitude)}

    def summary(self) -> list[str]:
        """The highest point, and the number of points by regime."""
        known = [p for p in self.points if math.isfinite(p.max_output_force)]
        if not known:
            return [f"{len(self.points)} points, none with a force"]
        top = max(known, key=lambda p: p.max_output_force)
        counts = Counter(f"period {p.regime.period}" if p.regime.period else p.regime.name for p in self.points)
        return [f"{len(self.points)} points, {self.points[0].frequency:g} to {self.points[-1].frequency:g} Hz, "
                f"start: {self.start}", f"highest at {top.frequency:g} Hz ({top.regime.sentence})",
                *force_sentences(top), ", ".join(f"{count} {name}" for name, count in sorted(counts.items()))]
