"""Columns that several results have: largest forces, their errors, regimes; and the axes of beads and contacts."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..regime import Regime
from .provenance import or_nan
from .table import Column, axis

#: Columns with the largest forces, in this order everywhere.
MAXIMA = ("max_input_force", "max_output_force", "max_output_force_elastic")
_MEANT = ("largest force of the driver on bead 1", "largest force on the wall, elastic and damping",
          "largest elastic force on the wall, the paper's F_out")
#: Columns with their relative errors in the same order; `error_estimate` is that of the output force
#: (docs/result-files.md, "Which name is which error").
ERRORS = ("error_estimate_input", "error_estimate", "error_estimate_elastic")
_FORCES = ("input", "output", "elastic output")


def force_columns(forces: np.ndarray, axes: tuple[str, ...], when: str = "in the steady state") -> dict[str, Column]:
    """Largest forces (…, 3) [N] in the order of `MAXIMA`; `when` says over which time."""
    return {name: Column(forces[..., i], axes, "N", f"{_MEANT[i]}, {when}") for i, name in enumerate(MAXIMA)}


def error_columns(errors: np.ndarray, axes: tuple[str, ...]) -> dict[str, Column]:
    """Relative errors (…, 3) in the same order, NaN where none is stated."""
    return {name: Column(errors[..., i], axes, "1",
                         f"relative error of the largest {_FORCES[i]} force, NaN where none is claimed")
            for i, name in enumerate(ERRORS)}


def regime_columns(found: Sequence[Regime], along: str) -> dict[str, Column]:
    """Regime and period along an axis."""
    return {"regime": Column(np.array([one.name for one in found], dtype=object), (along,), "",
                             "periodic, quasi-periodic, chaotic or unsettled"),
            "period": Column(np.array([one.period or 0 for one in found], dtype=np.int64), (along,), "1",
                             "period in drive periods, 0 where not periodic")}


#: The evidence for a regime that every result keeps, and what each number means.
EVIDENCE = {
    "decay": "factor by which changes shrank per orbit, NaN where not seen",
    "multiplier": "modulus of the leading multiplier, NaN where not computed",
    "lyapunov": "largest Lyapunov exponent per drive period, NaN where not measured",
    "lyapunov_error": "standard error of the Lyapunov exponent",
    "lyapunov_periods": "drive periods over which the Lyapunov exponent was measured, NaN where not measured",
}
#: The rest of it, which a map's cells do not keep.
MORE_EVIDENCE = {
    "distance": "bound on the relative distance to the orbit, NaN where not periodic",
    "return_distance": "median distance of late strobes from the nearest early one, NaN where not measured",
    "return_limit": "what the return distance must be below for a quasi-periodic motion",
    "smallest_window_ratio": "smallest ratio of a window's largest change to that of the window before, NaN if unknown",
    "largest_window_ratio": "largest ratio of a window's largest change to that of the window before, NaN if unknown",
}


def evidence_columns(found: Sequence[Regime], along: str) -> dict[str, Column]:
    """All evidence for regimes along an axis."""

    def whole(values: list[int], meaning: str) -> Column:
        return Column(np.array(values, dtype=np.int64), (along,), "1", meaning)

    meanings = EVIDENCE | MORE_EVIDENCE
    numbers = np.array([_evidence(one) for one in found], dtype=float).reshape(-1, len(meanings))
    return {
        "periods_run": whole([one.periods_run for one in found], "drive periods run until that was decided"),
        "followed": whole([one.followed for one in found],
                          "1 where Newton's method or extrapolation found the orbit of a motion still approaching it"),
        "approaches": whole([one.approaches or 0 for one in found],
                            "period of an orbit that an unsettled motion approaches, 0 where none is known"),
        **{name: Column(values, (along,), "1", meaning)
           for (name, meaning), values in zip(meanings.items(), numbers.T, strict=True)}}


def _evidence(regime: Regime) -> tuple[float, ...]:
    """The numbers of `EVIDENCE`, then of `MORE_EVIDENCE`."""
    lyapunov, ratios = regime.lyapunov or (np.nan, np.nan), regime.window_ratios or (np.nan, np.nan)
    return (or_nan(regime.decay), or_nan(regime.multiplier), *lyapunov, or_nan(regime.lyapunov_periods),
            or_nan(regime.distance), or_nan(regime.return_distance), or_nan(regime.return_limit), *ratios)


def bead_axis(beads: int) -> dict[str, Column]:
    """Numbers of the beads."""
    return axis("bead", np.arange(1, beads + 1), "1", "bead number from the driver")


def contact_axis(beads: int) -> dict[str, Column]:
    """Numbers of the contacts."""
    return axis("contact", np.arange(beads + 1), "1", "contact number; c joins bodies c and c + 1")


def multiplier_columns(found: np.ndarray, axes: tuple[str, ...], errors: np.ndarray | None = None,
                       prefix: str = "") -> dict[str, Column]:
    """Real and imaginary parts of multipliers (netCDF has no complex numbers), and their errors where known."""
    of = "the observer's multiplier" if prefix else "multiplier"
    columns = {f"{prefix}multiplier_real": Column(found.real, axes, "1", f"{of}, real part"),
               f"{prefix}multiplier_imag": Column(found.imag, axes, "1", f"{of}, imaginary part")}
    if errors is not None:
        columns[f"{prefix}multiplier_error"] = Column(errors, axes, "1", f"{of}, absolute error")
    return columns


def state_columns(displacement: np.ndarray, velocity: np.ndarray, axes: tuple[str, ...]) -> dict[str, Column]:
    """Displacements [m] and velocities [m/s] of beads at drive phase 0."""
    return {"displacement": Column(displacement, axes, "m", "bead displacement from its rest position, at phase 0"),
            "velocity": Column(velocity, axes, "m/s", "bead velocity, at phase 0")}
