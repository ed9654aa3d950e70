"""Bifurcation curves in a parameter map: found between neighbouring cells and continued through its rows.

The regimes of two neighbouring cells determine which bifurcation is sought between them (`_kinds`; the table is in
docs/parameter-map.md, under "Limits"). The orbit of the periodic cell is continued towards its neighbour; the search
for the point starts where a multiplier is nearest to its critical value.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from ..errors import BadInput, ComputationError
from ..execution.stop import Stop
from ..orbits import Orbit, periodic_orbit
from ..orbits.stroboscopic_map import refuse_cut
from ..parameter_maps.cells import CELL_REGIMES, ParameterMap
from ..scene.quantities import QUANTITIES
from .continuation import END_WORDS, REACHED, follow_curve
from .point import BifurcationPoint, bifurcation_point

#: Number of steps in which an orbit is continued from its cell to the neighbour.
_STEPS = 6
#: A point more than this many cells outside the pair between which it was sought is on another curve.
_CELLS_OUTSIDE = 1.0
#: Curves closer than this many cells are the same.
_CELLS_APART = 0.5


@dataclass(frozen=True, eq=False)
class BifurcationCurve:
    """A bifurcation curve in the plane of the two knobs of a parameter map.

    Attributes
    ----------
    kind : str
        "fold", "period_doubling" or "neimark_sacker".
    period : int
        Period, in drive periods, of the orbits on it; at a period doubling, orbits of twice this period begin.
    points : list of BifurcationPoint
        In ascending y. `x` and `y` are the knobs in SI, `multiplier` is the critical one, and `state` the orbit's
        scaled displacements and w at phase 0.
    ended_low, ended_high : str
        Why the curve ends at its least and at its largest y, one of `CURVE_ENDS`: "reached", the last requested value;
        "branch lost", as at a turning point in y; "multiplier lost"; "another curve", a jump; "" if not known.

    Examples
    --------
    >>> from granchain_core import bifurcation_curves, parameter_map, scene
    >>> found = parameter_map(scene("sec2").evolve(N=3), ("f", [1860.0, 1900.0]), ("A0", [4.5e-7, 5e-7]))
    >>> [(curve.kind, curve.period, len(curve.points)) for curve in bifurcation_curves(found)]
    [('period_doubling', 1, 2)]
    """

    kind: str
    period: int
    points: list[BifurcationPoint]
    ended_low: str = ""
    ended_high: str = ""

    def sentence(self, x: str, y: str) -> str:
        """The curve in words; `x` and `y` are the names of the knobs."""
        ends = []
        for knob, values in ((x, [point.x for point in self.points]), (y, [point.y for point in self.points])):
            unit = QUANTITIES[knob].unit
            ends.append(f"{knob} {min(values):.7g} to {max(values):.7g}{'' if unit in ('', '1') else ' ' + unit}")
        description = (f"{self.kind.replace('_', ' ')} of period {self.period}: {', '.join(ends)}, "
                       f"{len(self.points)} points")
        early = [f"ends at the {side} {y}: {END_WORDS[why]}" for side, why in
                 (("least", self.ended_low), ("largest", self.ended_high)) if why not in ("", REACHED)]
        return "; ".join([description, *early])


@dataclass(frozen=True)
class _Pair:
    """Two neighbouring cells of one row: the periodic one, the other one, and the kinds to try between them, in order.
    """

    inside: int
    outside: int
    kinds: tuple[str, ...]
    period: int


def bifurcation_curves(parameter_map: ParameterMap, rows: Iterable[int] | None = None,
                       values: Iterable[float] | None = None, stop: Stop | None = None,
                       on_curve: Callable[[BifurcationCurve], None] | None = None) -> list[BifurcationCurve]:
    """Find bifurcation curves in a parameter map: folds, period doublings, Neimark–Sacker points over its two knobs.

    Between neighbouring cells of a row that differ, the bifurcation is found and then continued in y. Curves that
    cannot be continued are left out: two neighbours from rest may be on two attractors with no bifurcation between
    them (docs/parameter-map.md, "Bifurcation curves").

    Parameters
    ----------
    parameter_map : ParameterMap
        The parameter map.
    rows : iterable of int, optional
        The rows in which neighbours are compared, counted from 0; by default the middle one.
    values : iterable of float, optional
        The values of y at which the curves have points, in SI; by default those of the map's rows.
    stop : Stop, optional
        Ends the computation when another thread sets it.
    on_curve : callable, optional
        Called with each curve when it is finished.

    Returns
    -------
    list of BifurcationCurve
        The curves, in the order in which they were found.

    Raises
    ------
    BadInput
        A row that is not in the map, or a scene that cuts tension.
    Cancelled
        `stop` was set.

    Examples
    --------
    >>> from granchain_core import bifurcation_curves, parameter_map, scene
    >>> found = parameter_map(scene("sec2").evolve(N=3), ("f", [1860.0, 1900.0]), ("A0", [4.5e-7, 5e-7]))
    >>> curve, = bifurcation_curves(found)
    >>> [f"{point.x:.1f} Hz, {point.multiplier.real:.3f}" for point in curve.points]
    ['1842.5 Hz, -1.000', '1882.4 Hz, -1.000']
    """
    grid = parameter_map.grid
    refuse_cut(grid.scene)
    chosen = [grid.shape[0] // 2] if rows is None else list(rows)
    if any(not 0 <= row < grid.shape[0] for row in chosen):
        raise BadInput(f"rows are numbers from 0 to {grid.shape[0] - 1}.")
    heights = list(grid.y.values if values is None else values)
    curves: list[BifurcationCurve] = []
    for row in chosen:
        for pair in _pairs(parameter_map, row):
            curve = _new_curve(parameter_map, pair, heights, curves, stop)
            if curve is None:
                continue
            curves.append(curve)
            if on_curve is not None:
                on_curve(curve)
    return curves


def _new_curve(parameter_map: ParameterMap, pair: _Pair, heights: list[float], known: list[BifurcationCurve],
               stop: Stop | None) -> BifurcationCurve | None:
    """The curve between two neighbouring cells; None if there is none, if it is known, or if it cannot be continued."""
    grid = parameter_map.grid
    kind, point = _between(parameter_map, pair, stop)
    if point is None or any(_lies_on(parameter_map, point, kind, pair.period, curve) for curve in known):
        return None
    scene = grid.cell(pair.inside).evolve(**{grid.x.knob: point.x})
    try:
        points = follow_curve(scene, kind, point.state, heights, pair.period, grid.x.knob, grid.y.knob, stop)
    except ComputationError:
        return None
    return BifurcationCurve(kind, pair.period, *points)


def _pairs(parameter_map: ParameterMap, row: int) -> Iterator[_Pair]:
    """Yield pairs of neighbouring cells of a row, the first periodic, the second not or with another period."""
    width = parameter_map.grid.shape[1]
    regimes, periods = parameter_map.cells["regime"], parameter_map.cells["period"]
    names = np.array(CELL_REGIMES)[regimes]
    for column in range(width - 1):
        numbers = row * width + column, row * width + column + 1
        for inside, outside in (numbers, numbers[::-1]):
            period, neighbour_period = int(periods[inside]), int(periods[outside])
            if period == 0 or neighbour_period == period or regimes[outside] < 0:
                continue
            kinds = _kinds(period, neighbour_period, str(names[outside]))
            if kinds:
                yield _Pair(inside, outside, kinds, period)


def _kinds(period: int, neighbour_period: int, regime: str) -> tuple[str, ...]:
    """Kinds to try between an orbit of `period` and a neighbour with this regime and period; 0 means no period."""
    if regime in ("unsettled", "failed") or period == 2 * neighbour_period:
        return ()
    if regime == "quasi-periodic":
        return ("neimark_sacker",)
    if neighbour_period == 0:
        return ("period_doubling", "neimark_sacker", "fold")
    if neighbour_period == 2 * period:
        return ("period_doubling",)
    return ("period_doubling", "fold") if neighbour_period % period == 0 else ("fold",)


def _between(parameter_map: ParameterMap, pair: _Pair, stop: Stop | None) -> tuple[str, BifurcationPoint | None]:
    """The first of the pair's kinds that is found between its cells, and the point; None if none is found."""
    point = None
    for kind in pair.kinds:
        point = _point_between(parameter_map, pair, kind, stop)
        if point is not None:
            return kind, point
    return pair.kinds[-1], None


def _point_between(parameter_map: ParameterMap, pair: _Pair, kind: str, stop: Stop | None) -> BifurcationPoint | None:
    """The point of this kind, sought from the orbit nearest to its condition; None if none is found."""
    grid = parameter_map.grid
    columns = [number % grid.shape[1] for number in (pair.inside, pair.outside)]
    a, b = (grid.x.values[column] for column in columns)
    best, nearest = None, np.inf
    try:
        orbit: Orbit | None = None
        for x in np.linspace(a, b, _STEPS + 1):
            scene = grid.cell(pair.inside).evolve(**{grid.x.knob: float(x)})
            orbit = periodic_orbit(scene, pair.period, None if orbit is None else orbit.state, stop=stop)
            away = _away(orbit, kind)
            if away < nearest:
                best, nearest = orbit, away
    except ComputationError:
        pass  # beyond a fold there is no orbit: the last one is the nearest
    if best is None:
        return None
    try:
        point = bifurcation_point(best.scene, kind, best.state, pair.period, grid.x.knob, grid.y.knob, stop)
    except (BadInput, ComputationError):
        return None
    low, high = min(a, b) - _CELLS_OUTSIDE * abs(b - a), max(a, b) + _CELLS_OUTSIDE * abs(b - a)
    return point if low <= point.x <= high else None


def _away(orbit: Orbit, kind: str) -> float:
    """Distance of an orbit's multipliers from the condition of this kind."""
    if kind == "neimark_sacker":
        pairs = orbit.multipliers[np.abs(orbit.multipliers.imag) > 0.0]
        return float(np.abs(np.abs(pairs) - 1.0).min()) if len(pairs) else np.inf
    return float(np.abs(orbit.multipliers - (1.0 if kind == "fold" else -1.0)).min())


def _lies_on(parameter_map: ParameterMap, point: BifurcationPoint, kind: str, period: int,
             curve: BifurcationCurve) -> bool:
    """Whether a point is on a curve found earlier; False beyond the curve's ends."""
    rows = [known.y for known in curve.points]
    if (curve.kind, curve.period) != (kind, period) or not rows[0] <= point.y <= rows[-1]:
        return False
    values = parameter_map.grid.x.values
    cell = (values[-1] - values[0]) / (len(values) - 1)
    x_on_curve = np.interp(point.y, rows, [known.x for known in curve.points])
    return bool(abs(x_on_curve - point.x) <= _CELLS_APART * cell)
