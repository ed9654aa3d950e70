"""A fit as tables: parameters with intervals, data with the model, profiles, and all evaluated points."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..tables import Column, Table, axis
from .curve_target import CurveTarget
from .evaluation import Evaluation
from .feature_target import FeatureTarget
from .intervals import Profile
from .parameters import Free
from .records import RecordsTarget
from .search import Target
from .series_target import SeriesTarget


def parameter_table(free: Sequence[Free], best: np.ndarray, profiles: Sequence[Profile]) -> Table:
    """One row per parameter; the units differ, so `unit` is a column."""
    along = ("parameter",)
    columns = {
        "best": Column(best, along, "", "value with the least misfit, in `unit`"),
        "bound_low": Column(np.array([parameter.low for parameter in free]), along, "", "lower bound, in `unit`"),
        "bound_high": Column(np.array([parameter.high for parameter in free]), along, "", "upper bound, in `unit`"),
        "unit": Column(np.array([parameter.unit for parameter in free], dtype=object), along, "",
                       "unit of the parameter")}
    if profiles:
        for end in ("low", "high"):
            columns[end] = Column(np.array([getattr(profile, end) for profile in profiles]), along, "",
                                  f"{'lower' if end == 'low' else 'upper'} end of the 95 % interval, in `unit`")
            columns[f"open_{end}"] = Column(
                np.array([getattr(profile, f"open_{end}") for profile in profiles], dtype=np.int8), along, "1",
                "1 if the interval continues beyond that end, which is a bound or the farthest value that was tried")
    return Table("parameters", axis("parameter", np.array([parameter.name for parameter in free], dtype=object), "",
                                    "name of the parameter"), columns)


def data_table(target: Target, evaluation: Evaluation) -> Table:
    """One row per datum: the measured value, the model's, and the residual."""
    along, count = ("datum",), len(evaluation.residuals)
    unit = "Hz" if isinstance(target, FeatureTarget) else "N"
    columns = {"residual": Column(evaluation.residuals, along, "1", "model − measured, in standard deviations"),
               "model": Column(evaluation.model, along, unit, "the model's value")}
    if isinstance(target, (SeriesTarget, RecordsTarget)):
        records = target.records if isinstance(target, RecordsTarget) else (target,)
        columns |= _samples(records)
    else:
        columns["frequency"] = Column(target.frequencies, along, "Hz", "measured or stated frequency")
    if isinstance(target, CurveTarget):
        columns |= {"measured": Column(target.measured.force, along, "N", "measured largest force"),
                    "sigma": Column(target.sigma, along, "N", "standard deviation of the measured force"),
                    "regime": Column(np.array(evaluation.regimes, dtype=object), along, "", "the model's motion")}
    return Table("data", axis("datum", np.arange(count), "1", "number of the datum"), columns)


def _samples(records: Sequence[SeriesTarget]) -> dict[str, Column]:
    """The measured samples, record by record, with the drive frequencies of records that have their own."""
    along = ("datum",)
    forces = [values for record in records for values in record.channels.values()]
    names = [name for record in records for name, values in record.channels.items() for _ in values]
    times = [record.time for record in records for _ in record.channels]
    columns = {"measured": Column(np.concatenate(forces), along, "N", "measured force"),
               "channel": Column(np.array(names, dtype=object), along, "", "which force"),
               "time": Column(np.concatenate(times), along, "s", "time in the series")}
    own = [record.frequency for record in records for values in record.channels.values() for _ in values]
    if all(f is not None for f in own):
        columns["frequency"] = Column(np.array(own, dtype=float), along, "Hz", "measured or stated frequency")
    return columns


def profile_table(free: Sequence[Free], profiles: Sequence[Profile]) -> Table:
    """The profiles of all parameters, one below the other."""
    names = [parameter.name for parameter, profile in zip(free, profiles, strict=True) for _ in profile.values]
    values = [value for profile in profiles for value in profile.values]
    rises = [rise for profile in profiles for rise in profile.rises]
    along = ("place",)
    return Table("profiles", axis("place", np.arange(len(names)), "1", "place on a profile"), {
        "name": Column(np.array(names, dtype=object), along, "", "name of the parameter"),
        "value": Column(np.array(values), along, "", "its value, in its unit"),
        "rise": Column(np.array(rises), along, "1", "least χ² there above the least of all")})


def landscape_table(free: Sequence[Free], landscape: tuple[np.ndarray, np.ndarray]) -> Table:
    """All sets of parameters that were evaluated, with their misfit."""
    values, misfits = landscape
    along = ("trial",)
    return Table("landscape", axis("trial", np.arange(len(misfits)), "1", "number of the evaluation"), {
        **{parameter.name: Column(values[:, i], along, parameter.unit, f"value of {parameter.name}")
           for i, parameter in enumerate(free)},
        "misfit": Column(misfits, along, "1", "χ² and the logarithms of the variances")})
