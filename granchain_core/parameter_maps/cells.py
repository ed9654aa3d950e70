"""The cells of a parameter map as one table: regime, period, largest forces, error, and the evidence for the regime."""

from __future__ import annotations

import json
from dataclasses import dataclass

import numpy as np

from ..results.forces import ForceErrors
from ..results.regime import NAMES, Regime
from ..results.regime_columns import EVIDENCE
from ..scene import Scene
from ..scene.quantities import QUANTITIES
from ..steady.batch.starts import settling_methods
from ..steady.steady_state import SteadyState
from ..tables import (
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
from ..tables.provenance import Attribute
from ..tables.words import ERRORS
from .grid import Grid

#: A cell's regime by number, in this order; "failed" has no forces. A cell that is not yet computed has −1.
CELL_REGIMES = (*NAMES, "failed")
#: One cell. Forces are in N, NaN if the computation failed. Stated errors are relative, NaN if no error is stated;
#: `error_estimate` is that of the output force (docs/result-files.md, "Which name is which error"). `period` is in
#: drive periods, 0 if not periodic. `decay` (per orbit), `multiplier` (the largest |μ|), `lyapunov` (per drive period)
#: and `lyapunov_periods`, over which it was measured, are NaN if not observed or not computed.
CELL = np.dtype([
    ("number", "<i4"), ("regime", "i1"), ("period", "<i2"), ("periods_run", "<i4"), ("max_input_force", "<f8"),
    ("max_output_force", "<f8"), ("max_output_force_elastic", "<f8"), ("error_estimate_input", "<f8"),
    ("error_estimate", "<f8"), ("error_estimate_elastic", "<f8"),
    ("decay", "<f8"), ("multiplier", "<f8"), ("lyapunov", "<f8"), ("lyapunov_error", "<f8"),
    ("lyapunov_periods", "<f8"),
])


def empty_cells(grid: Grid) -> np.ndarray:
    """A table (cells,) in which no cell is computed yet."""
    cells = np.zeros(grid.size, dtype=CELL)
    cells["number"] = np.arange(grid.size)
    cells["regime"] = -1
    for name in (*MAXIMA, *ERRORS, *EVIDENCE):
        cells[name] = np.nan
    return cells


def cell_of(result: SteadyState) -> np.ndarray:
    """The row () of one result."""
    regime = result.regime
    name = "failed" if result.failure else regime.name
    mean, error = regime.lyapunov or (np.nan, np.nan)
    return np.array((result.number, CELL_REGIMES.index(name), regime.period or 0, regime.periods_run, *result.maxima,
                     *ForceErrors.of(result.errors).row, _or_nan(regime.observed_contraction),
                     _or_nan(regime.multiplier), mean, error,
                     _or_nan(regime.lyapunov_periods)), dtype=CELL)


def _or_nan(value: float | None) -> float:
    return np.nan if value is None else value


@dataclass(eq=False, repr=False)
class ParameterMap(Labelled):
    """A parameter map: regime and largest forces over two knobs.

    Attributes
    ----------
    grid : Grid
        The scene and its two axes; cell (i, j) has y value i and x value j.
    cells : numpy.ndarray, structured, shape (cells,)
        By number i · len(x) + j: regime, period, largest forces [N], relative errors, and the evidence for the regime.
    wall_s : float
        Wall-clock time [s].

    Examples
    --------
    >>> from granchain_core import parameter_map, scene
    >>> found = parameter_map(scene("sec2").evolve(N=2), ("f", [1900.0, 2000.0]), ("A0", [5e-7]))
    >>> found.complete, found.column("max_output_force").shape, found.regime(0).name
    (True, (1, 2), 'periodic')
    """

    grid: Grid
    cells: np.ndarray
    wall_s: float = 0.0

    @property
    def scene(self) -> Scene:
        """The chain."""
        return self.grid.scene

    @property
    def varied(self) -> tuple[str, ...]:
        """Both knobs, and the drive amplitude if it follows the frequency."""
        both = (self.grid.x.knob, self.grid.y.knob)
        return both if self.grid.amplitude is None else (*both, "A0")

    def column(self, name: str) -> np.ndarray:
        """One entry of all cells as an array (y, x)."""
        return self.cells[name].reshape(self.grid.shape)

    def tables(self) -> tuple[Table, ...]:
        """One table, `map`, over both knobs; regimes are numbers with CF's flag_values and flag_meanings."""
        both = (self.grid.y.knob, self.grid.x.knob)
        axes: dict[str, Column] = {}
        for side in (self.grid.y, self.grid.x):
            axes |= axis(side.knob, side.array, QUANTITIES[side.knob].unit, QUANTITIES[side.knob].label)
        flags = {"flag_values": np.array([-1, *range(len(CELL_REGIMES))], dtype=np.int8),
                 "flag_meanings": " ".join(["not_computed", *CELL_REGIMES])}
        forces, errors = (np.stack([self.column(name) for name in names], axis=-1) for names in (MAXIMA, ERRORS))
        columns = {
            **force_columns(forces, both), **error_columns(errors, both),
            "regime": Column(self.column("regime"), both, "", "what the motion is", flags),
            "period": Column(self.column("period"), both, "1", "period in drive periods, 0 where not periodic"),
            "periods_run": Column(self.column("periods_run"), both, "1", "drive periods run until that was decided"),
            **{name: Column(self.column(name), both, "1", meaning) for name, meaning in EVIDENCE.items()}}
        return (Table("map", axes, columns, both),)

    def attributes(self) -> dict[str, Attribute]:
        """Both knobs, cost and provenance; `accuracy_reached` is the largest error of an output force.

        Only cells that were settled alone were computed to `accuracy_asked`, at best to `CURVE_ACCURACY`.
        """
        errors = self.cells["error_estimate"]
        known = errors[np.isfinite(errors)]
        reached = float(known.max()) if len(known) else None
        return {**provenance(self.scene, settling_methods(self.scene, "cell"), reached),
                **amplitude_attribute(self.grid.amplitude), "map_digest": self.grid.digest, "wall_s": self.wall_s,
                "map_axes": json.dumps([self.grid.y.knob, self.grid.x.knob])}

    def summary(self) -> list[str]:
        """The ranges of both knobs, and the number of cells by regime."""
        sides = (f"{side.knob} {side.values[0]:g} to {side.values[-1]:g} {QUANTITIES[side.knob].unit}"
                 for side in (self.grid.x, self.grid.y))
        counts = {name: int((self.cells["regime"] == code).sum()) for code, name in enumerate(CELL_REGIMES)}
        missing = int((self.cells["regime"] < 0).sum())
        return [f"{self.grid.shape[1]} × {self.grid.shape[0]} cells: {', '.join(sides)}",
                ", ".join(f"{count} {name}" for name, count in counts.items() if count)
                + (f"; {missing} not computed" if missing else "")]

    @property
    def complete(self) -> bool:
        """Whether every cell is computed."""
        return bool((self.cells["regime"] >= 0).all())

    def regime(self, number: int) -> Regime | None:
        """The regime of a cell; None if it is not computed or the computation failed."""
        cell = self.cells[number]
        if not 0 <= cell["regime"] < CELL_REGIMES.index("failed"):
            return None
        lyapunov = None if np.isnan(cell["lyapunov"]) else (float(cell["lyapunov"]), float(cell["lyapunov_error"]))
        contraction, multiplier = (None if np.isnan(cell[name]) else float(cell[name])
                                   for name in ("decay", "multiplier"))
        measured = None if np.isnan(cell["lyapunov_periods"]) else int(cell["lyapunov_periods"])
        return Regime(name=CELL_REGIMES[cell["regime"]], period=int(cell["period"]) or None,
                      observed_contraction=contraction, distance=None, periods_run=int(cell["periods_run"]),
                      lyapunov=lyapunov, multiplier=multiplier, lyapunov_periods=measured)
