"""Columns with regimes and their evidence, shared by several results."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..tables import Column, or_nan
from .regime import FOUND_BY, Regime


def regime_columns(regimes: Sequence[Regime], along: str) -> dict[str, Column]:
    """Return regime and period along an axis."""
    return {"regime": Column(np.array([regime.name for regime in regimes], dtype=object), (along,), "",
                             "periodic, quasi-periodic, chaotic or unsettled"),
            "period": Column(np.array([regime.period or 0 for regime in regimes], dtype=np.int64), (along,), "1",
                             "period in drive periods, 0 where not periodic")}


#: The evidence for a regime that every result keeps, with the meaning of each number.
EVIDENCE = {
    "decay": "observed contraction factor: factor by which changes shrank per period of the orbit, NaN where not seen",
    "multiplier": "modulus of the leading multiplier, NaN where not computed",
    "lyapunov": "largest Lyapunov exponent per drive period, NaN where not measured",
    "lyapunov_error": "standard error of the Lyapunov exponent",
    "lyapunov_periods": "drive periods over which the Lyapunov exponent was measured, NaN where not measured",
}
#: Further evidence, which the cells of a map do not keep.
MORE_EVIDENCE = {
    "distance": "bound on the relative distance to the orbit, NaN where not periodic",
    "return_distance": "median distance of late strobes from the nearest early one, NaN where not measured",
    "return_limit": "what the return distance must be below for a quasi-periodic motion",
    "smallest_window_ratio": "smallest ratio of a window's largest change to that of the window before, NaN if unknown",
    "largest_window_ratio": "largest ratio of a window's largest change to that of the window before, NaN if unknown",
}


def evidence_columns(regimes: Sequence[Regime], along: str) -> dict[str, Column]:
    """Return all evidence for regimes along an axis."""

    def whole(values: list[int], meaning: str) -> Column:
        return Column(np.array(values, dtype=np.int64), (along,), "1", meaning)

    meanings = EVIDENCE | MORE_EVIDENCE
    numbers = np.array([_evidence(regime) for regime in regimes], dtype=float).reshape(-1, len(meanings))
    return {
        "periods_run": whole([regime.periods_run for regime in regimes], "drive periods run until that was decided"),
        "followed": whole([regime.is_approach for regime in regimes],
                          "1 where Newton's method or extrapolation found the orbit of a motion still approaching it"),
        "approaches": whole([regime.approaches or 0 for regime in regimes],
                            "period of an orbit that an unsettled motion approaches, 0 where none is known"),
        **{name: Column(values, (along,), "1", meaning)
           for (name, meaning), values in zip(meanings.items(), numbers.T, strict=True)},
        "orbit_found_by": Column(np.array([regime.found_by_in_files or "" for regime in regimes], dtype=object),
                                 (along,), "",
                                 f"how the orbit was found: {', '.join(FOUND_BY[:-1])} or {FOUND_BY[-1]}; empty where "
                                 "not periodic")}


def _evidence(regime: Regime) -> tuple[float, ...]:
    """Return the numbers of `EVIDENCE`, then of `MORE_EVIDENCE`."""
    lyapunov, ratios = regime.lyapunov or (np.nan, np.nan), regime.window_ratios or (np.nan, np.nan)
    return (or_nan(regime.observed_contraction), or_nan(regime.multiplier), *lyapunov, or_nan(regime.lyapunov_periods),
            or_nan(regime.distance), or_nan(regime.return_distance), or_nan(regime.return_limit), *ratios)
