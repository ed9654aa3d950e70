"""The result of a fit: best values with their intervals, misfit and verdict, also as tables and plain data."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..former_names import with_former_keys, with_former_names
from ..scene import Amplitude, Scene
from ..tables import Labelled, Table, or_nan, provenance
from ..tables.provenance import Attribute
from .evaluation import Evaluation
from .intervals import LEVEL, Profile, limit
from .parameters import Free
from .search import Target
from .series_target import SeriesTarget
from .tables import data_table, landscape_table, parameter_table, profile_table
from .verdict import scale_degrees_of_freedom


@with_former_names
@dataclass(frozen=True, eq=False, repr=False)
class Fit(Labelled):
    """The result of a fit.

    Attributes
    ----------
    scene : Scene
        The scene with the best values.
    amplitude : Amplitude or None
        The drive amplitude over the frequency, if one was fitted for each frequency.
    free : tuple of Free
        The fitted parameters, with bounds and priors.
    best : numpy.ndarray, shape (p,)
        Values with the least misfit.
    profiles : tuple of Profile
        The profile and 95 % interval of each parameter; empty if they were not requested.
    misfit : float
        The least −2 ln likelihood up to a constant: χ² plus the logarithms of enlarged variances.
    data : int
        Number of data and priors.
    degrees_of_freedom : int
        Number of data and priors minus number of parameters.
    probability : float or None
        Probability of a χ² at least as large if the model were true; None if the data's errors are not known.
    verdict : str
        Whether the model can describe the data: "can" (compatible), "cannot" (incompatible) or "not known" (undecided).
    sentence : str
        The verdict with its evidence.
    evaluation : Evaluation
        Residuals and model values at the best values.
    landscape : tuple of numpy.ndarray
        Values (n, p) and misfits (n,) of all evaluations.
    target : CurveTarget, SeriesTarget, RecordsTarget or FeatureTarget
        The measurement, with the rule by which it was compared.
    scale : float
        Unit of the misfit: 1, or χ² per degree of freedom if the data's errors are not known.
    wall_s : float
        Wall-clock time [s].
    correlation : numpy.ndarray, shape (p, p), or None
        Correlation of the estimates, from the residuals' slopes at the best values: near ±1, the data determine a
        combination of two parameters better than either. NaN if a parameter has no effect; None for features, whose
        residuals are not smooth, and if the best values are at a bound.

    Examples
    --------
    >>> import numpy as np
    >>> from granchain_core import fit, scene
    >>> from granchain_core.fitting import CurveTarget, Free, virtual_curve
    >>> truth = scene("sec2").evolve(N=2, D=120.0)
    >>> measured = virtual_curve(truth, np.linspace(1500.0, 2500.0, 9), 0.02, np.random.default_rng(1))
    >>> fitted = fit(truth.evolve(D=80.0), CurveTarget(measured), [Free("D", 50.0, 200.0)])
    >>> fitted.profiles[0].low < 120.0 < fitted.profiles[0].high, fitted.verdict
    (True, 'can')
    """

    scene: Scene
    amplitude: Amplitude | None
    free: tuple[Free, ...]
    best: np.ndarray
    profiles: tuple[Profile, ...]
    misfit: float
    data: int
    degrees_of_freedom: int
    probability: float | None
    verdict: str
    sentence: str
    evaluation: Evaluation
    landscape: tuple[np.ndarray, np.ndarray]
    target: Target
    scale: float = 1.0
    wall_s: float = 0.0
    correlation: np.ndarray | None = None

    @property
    def varied(self) -> tuple[str, ...]:
        """The frequency, unless a series at the scene's own was fitted, and the drive amplitude if it follows f."""
        own = isinstance(self.target, SeriesTarget) and self.target.frequency is None
        return (() if own else ("f",)) + (() if self.amplitude is None else ("A0",))

    def tables(self) -> tuple[Table, ...]:
        """`parameters` with their intervals, `data` with the model, `profiles`, and the `landscape` of the misfit."""
        profiles = (profile_table(self.free, self.profiles),) if self.profiles else ()
        return (parameter_table(self.free, self.best, self.profiles), data_table(self.target, self.evaluation),
                *profiles, landscape_table(self.free, self.landscape))

    def attributes(self) -> dict[str, Attribute]:
        """Misfit, verdict and provenance."""
        extra: dict[str, Attribute] = {} if self.amplitude is None else {
            "amplitude": json.dumps(self.amplitude.to_json())}
        if self.correlation is not None:
            extra["correlation"] = json.dumps(self._correlation_rows())
        return with_former_keys("fit", {
            **provenance(self.scene, "least squares, profile likelihood", None), "misfit": self.misfit,
            "data": self.data, "degrees_of_freedom": self.degrees_of_freedom, "probability": or_nan(self.probability),
            "verdict": self.verdict, "sentence": self.sentence, "scale": self.scale, "level": LEVEL,
            "wall_s": self.wall_s, **extra})

    @property
    def chi_squared(self) -> float:
        """The sum of the squared residuals and priors: the misfit without the logarithms of the variances."""
        return self.misfit - self.evaluation.log_variance

    @property
    def limit(self) -> float:
        """The rise of the misfit at the ends of the 95 % intervals."""
        return limit(self.scale, scale_degrees_of_freedom(self.target, self.degrees_of_freedom))

    def summary(self) -> list[str]:
        """Each parameter with its interval, and the verdict."""
        lines = []
        for i, parameter in enumerate(self.free):
            unit = "" if parameter.unit == "1" else f" {parameter.unit}"
            ends = (f", 95 %: {self.profiles[i].low:.5g} to {self.profiles[i].high:.5g}{unit}" if self.profiles else
                    ", no interval computed")
            lines.append(f"{parameter.name} = {self.best[i]:.5g}{unit}{ends}")
        return [*lines, self.sentence]

    def to_json(self) -> dict[str, Any]:
        """The result as plain data."""
        parameters = []
        for i, parameter in enumerate(self.free):
            entry: dict[str, Any] = {
                "name": parameter.name, "unit": parameter.unit, "best": float(self.best[i]),
                "bounds": [parameter.low, parameter.high], "prior": list(parameter.prior) if parameter.prior else None}
            if self.profiles:
                profile = self.profiles[i]
                entry |= {"low": profile.low, "high": profile.high, "open_low": profile.open_low,
                          "open_high": profile.open_high, "profile": [list(profile.values), list(profile.rises)]}
            parameters.append(entry)
        return with_former_keys("fit", {
            "scene": self.scene.name, "knobs": self.scene.knobs, "parameters": parameters, "level": LEVEL,
            "misfit": self.misfit, "chi_squared": self.chi_squared, "data": self.data,
            "degrees_of_freedom": self.degrees_of_freedom,
            "probability": self.probability, "verdict": self.verdict, "sentence": self.sentence,
            "evaluations": len(self.landscape[1]),
            "residuals": [float(r) for r in self.evaluation.residuals],
            "model": [float(m) if np.isfinite(m) else None for m in self.evaluation.model],
            "frequency": [float(f) for f in self.target.frequencies],
            "regimes": list(self.evaluation.regimes), "wall_s": self.wall_s,
            "correlation": self._correlation_rows()})

    def _correlation_rows(self) -> list[list[float | None]] | None:
        """The correlation as plain data, with None instead of NaN."""
        return None if self.correlation is None else [
            [float(value) if np.isfinite(value) else None for value in row] for row in self.correlation]
