"""Columns shared by several results: largest forces, their errors, multipliers, states; axes of beads and contacts."""

from __future__ import annotations

import numpy as np

from .table import Column, axis

#: Columns with the largest forces, in the order used everywhere.
MAXIMA = ("max_input_force", "max_output_force", "max_output_force_elastic")
_MEANT = ("largest force of the driver on bead 1", "largest force on the wall, elastic and damping",
          "largest elastic force on the wall, the paper's F_out")
#: Columns with their relative errors in the same order; `error_estimate` is that of the output force
#: (docs/result-files.md, "Which name is which error").
ERRORS = ("error_estimate_input", "error_estimate", "error_estimate_elastic")
_FORCES = ("input", "output", "elastic output")


def force_columns(forces: np.ndarray, axes: tuple[str, ...], when: str = "in the steady state") -> dict[str, Column]:
    """Return columns of largest forces (…, 3) [N] in the order of `MAXIMA`; `when` says over which time."""
    return {name: Column(forces[..., i], axes, "N", f"{_MEANT[i]}, {when}") for i, name in enumerate(MAXIMA)}


def error_columns(errors: np.ndarray, axes: tuple[str, ...]) -> dict[str, Column]:
    """Return columns of relative errors (…, 3) in the same order, NaN where none is stated."""
    return {name: Column(errors[..., i], axes, "1",
                         f"relative error of the largest {_FORCES[i]} force, NaN where none is claimed")
            for i, name in enumerate(ERRORS)}


def bead_axis(beads: int) -> dict[str, Column]:
    """Return the axis of bead numbers."""
    return axis("bead", np.arange(1, beads + 1), "1", "bead number from the driver")


def contact_axis(beads: int) -> dict[str, Column]:
    """Return the axis of contact numbers."""
    return axis("contact", np.arange(beads + 1), "1", "contact number; c joins bodies c and c + 1")


def multiplier_columns(multipliers: np.ndarray, axes: tuple[str, ...], errors: np.ndarray | None = None,
                       prefix: str = "") -> dict[str, Column]:
    """Return real and imaginary parts of multipliers (netCDF has no complex numbers), and their errors if known."""
    of = "the observer's multiplier" if prefix else "multiplier"
    columns = {f"{prefix}multiplier_real": Column(multipliers.real, axes, "1", f"{of}, real part"),
               f"{prefix}multiplier_imag": Column(multipliers.imag, axes, "1", f"{of}, imaginary part")}
    if errors is not None:
        columns[f"{prefix}multiplier_error"] = Column(errors, axes, "1", f"{of}, absolute error")
    return columns


def state_columns(displacement: np.ndarray, velocity: np.ndarray, axes: tuple[str, ...]) -> dict[str, Column]:
    """Return displacements [m] and velocities [m/s] of the beads at drive phase 0."""
    return {"displacement": Column(displacement, axes, "m", "bead displacement from its rest position, at phase 0"),
            "velocity": Column(velocity, axes, "m/s", "bead velocity, at phase 0")}
