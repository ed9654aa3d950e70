"""The bifurcation diagram: a bead's states once per drive period (strobes) over a knob.

At each value of the knob, the chain settles (regime, with its evidence), and strobes are kept. For an orbit of period
n, these are its n points, refined to the scene's accuracy and repeated. For a motion that does not repeat, they are its
next points: a closed curve seen from the side, or the many points of chaos. Where sweeps up and down differ, there is
more than one attractor.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from ..errors import BadInput, ComputationError
from ..execution.stop import Stop
from ..inputs.checks import numbers_in, unknown_name, whole_number
from ..integrate import Engine
from ..results.regime import Regime
from ..results.regime_columns import evidence_columns, regime_columns
from ..scene import Scene
from ..scene.quantities import QUANTITIES
from ..scene.refusals import require_scene
from ..scene.state import State
from ..steady.batch.starts import methods_alone
from ..steady.batch.threads import on_all_cores
from ..steady.curve.order import CURVE_STARTS, coarse_first
from ..steady.orbit_errors import error_of_displacements
from ..steady.settling.advance import SettlingRun, run_until_settled
from ..steady.settling.refine_orbit import refined_orbit
from ..tables import Column, Labelled, Table, axis, bead_axis, provenance
from ..tables.provenance import Attribute, or_nan
from ..tables.words import state_columns

#: Strobes closer than this fraction of the largest count as one.
_APART = 1e-3
#: An orbit is refined to this fraction of the requested accuracy, since a safety factor enlarges its stated error.
_REFINED_FRACTION = 0.1
#: Meaning of the column with the error of the strobes at each value.
_ERROR = "largest error of a strobe over the largest displacement or velocity, NaN where none is stated"
#: Maximum number of values of the knob.
MOST_VALUES = 20_000
#: Maximum number of strobes at each value.
MOST_STROBES = 10_000


@dataclass(frozen=True, eq=False)
class StrobePoint:
    """The strobes at one value of the knob: displacement and velocity of every bead at phase 0, (P, 2, N) [m, m/s].

    `failure` is a sentence if the computation failed; there are then no strobes. `strobe_error` is the largest error of
    a displacement relative to the largest displacement, or of a velocity relative to the largest velocity; None if the
    motion is not periodic or its orbit is not known to 1e-3. `state` is where the next value starts if the state is
    carried along.
    """

    value: float
    regime: Regime
    strobes: np.ndarray
    state: State | None = None
    failure: str = ""
    strobe_error: float | None = None

    def distinct(self, bead: int) -> int:
        """Number of the bead's displacements that differ by more than a thousandth of the largest."""
        displacements = np.sort(self.strobes[:, 0, bead - 1])
        if displacements.size == 0:
            return 0
        return 1 + int((np.diff(displacements) > _APART * np.abs(displacements).max()).sum())


@dataclass(eq=False, repr=False)
class BifurcationDiagram(Labelled):
    """A bifurcation diagram: strobes over one knob.

    Attributes
    ----------
    scene : Scene
        The chain.
    knob : str
        Name of the varied knob.
    start : str
        "rest": every value from rest; "up" or "down": the state is carried along.
    points : list of StrobePoint
        In ascending order of the knob.

    Examples
    --------
    >>> from granchain_core import scene, bifurcation_diagram
    >>> found = bifurcation_diagram(scene("sec2").evolve(N=2), "f", [1900.0, 2000.0], keep=8)
    >>> [point.regime.period for point in found.points], found.cloud(1)[0].shape
    ([1, 1], (16,))
    """

    scene: Scene
    knob: str
    start: str
    points: list[StrobePoint] = field(default_factory=list)

    @property
    def varied(self) -> tuple[str, ...]:
        """The knob."""
        return (self.knob,)

    def cloud(self, bead: int, velocity: bool = False) -> tuple[np.ndarray, np.ndarray]:
        """All points (M,) of bead 1..N: the knob's values, and displacements [m] or velocities [m/s]."""
        bead = whole_number("bead", bead, 1, self.scene.N)
        kept = [point for point in self.points if not point.failure]
        values = np.concatenate([np.full(len(point.strobes), point.value) for point in kept] or [np.zeros(0)])
        states = np.concatenate([point.strobes[:, int(velocity), bead - 1] for point in kept] or [np.zeros(0)])
        return values, states

    def tables(self) -> tuple[Table, ...]:
        """`strobes`: states over knob, strobe and bead, NaN after a failure; `values`: the regime at each value."""
        quantity, most = QUANTITIES[self.knob], max((len(point.strobes) for point in self.points), default=0)
        states = np.full((len(self.points), most, 2, self.scene.N), np.nan)
        for row, point in zip(states, self.points, strict=True):
            row[: len(point.strobes)] = point.strobes
        knob = axis(self.knob, [point.value for point in self.points], quantity.unit, quantity.label)
        strobes = axis("strobe", np.arange(most), "1", "number of the strobe, one a drive period")
        failures = np.array([point.failure for point in self.points], dtype=object)
        regimes = [point.regime for point in self.points]
        errors = np.array([or_nan(point.strobe_error) for point in self.points])
        return (Table("strobes", {**knob, **strobes, **bead_axis(self.scene.N)}, {
            **state_columns(states[:, :, 0], states[:, :, 1], (self.knob, "strobe", "bead")),
            **regime_columns(regimes, self.knob)}, (self.knob, "strobe")),
            Table("values", knob, {**regime_columns(regimes, self.knob), **evidence_columns(regimes, self.knob),
                                   "strobe_error": Column(errors, (self.knob,), "1", _ERROR),
                                   "failure": Column(failures, (self.knob,), "", "why there are no strobes")}))

    def attributes(self) -> dict[str, Attribute]:
        """Knob, start and provenance; `accuracy_reached` is the largest error of a strobe."""
        method = f"{methods_alone(self.scene)} value by value"
        return {**provenance(self.scene, method, self._largest_error()), "knob": self.knob, "start": self.start}

    def _largest_error(self) -> float | None:
        """The largest stated error of a strobe; None if no error is stated."""
        return max((point.strobe_error for point in self.points if point.strobe_error is not None), default=None)

    def summary(self) -> list[str]:
        """The range of the knob, the number of values by regime, and the largest error of periodic strobes."""
        if not self.points:
            return ["no values"]
        unit, low, high = QUANTITIES[self.knob].unit, self.points[0].value, self.points[-1].value
        counts = Counter(f"period {p.regime.period}" if p.regime.period else p.regime.name for p in self.points)
        error = self._largest_error()
        return [f"{len(self.points)} values of {self.knob}, {low:g} to {high:g} {unit}, start: {self.start}",
                ", ".join(f"{count} {name}" for name, count in sorted(counts.items())),
                *([] if error is None else [f"relative error of periodic strobes: at most {error:.1e}"])]


def bifurcation_diagram(scene: Scene, knob: str, values: Sequence[float] | np.ndarray, start: str = "up",
                        keep: int = 60, stop: Stop | None = None,
                        progress: Callable[[float], None] | None = None) -> BifurcationDiagram:
    """Compute the bifurcation diagram: strobes over one knob.

    Parameters
    ----------
    scene : Scene
        The chain.
    knob : str
        A continuous knob, one of `granchain_core.orbits.CONTINUOUS`.
    values : sequence of float
        Its values in SI, at most 20,000.
    start : str
        "up" or "down": each value starts where the previous one settled; "rest": each from rest, on all cores.
    keep : int
        Number of strobes at each value, 1 to 10,000.
    stop : Stop, optional
        When set, the computation ends with the finished values.
    progress : callable, optional
        Called with the completed fraction, 0 to 1.

    Returns
    -------
    BifurcationDiagram
        Strobes and regime at each value, with the error of the strobes where the motion is periodic.

    Raises
    ------
    BadInput
        Another knob or start, or a number out of range.

    Examples
    --------
    >>> from granchain_core import scene, bifurcation_diagram
    >>> found = bifurcation_diagram(scene("sec2").evolve(N=2, f=2000.0), "A0", [4e-7, 5e-7], keep=4)
    >>> [point.distinct(bead=1) for point in found.points]
    [1, 1]
    """
    _check_names(knob, start)
    require_scene(scene)
    numbers = _checked_values(knob, values)
    keep = whole_number("keep =", keep, 1, MOST_STROBES)
    chains = [(value, scene.evolve(**{knob: value})) for value in numbers]
    diagram = BifurcationDiagram(scene, knob, start)
    for point in _points(chains, start, keep, stop):
        diagram.points.append(point)
        if progress is not None:
            progress(len(diagram.points) / len(chains))
    diagram.points.sort(key=lambda point: point.value)
    return diagram


def _check_names(knob: str, start: str) -> None:
    """Raise `BadInput` for a knob that is not continuous, and for an unknown start."""
    knobs = [name for name, quantity in QUANTITIES.items() if quantity.is_continuous]
    if knob not in knobs:
        raise unknown_name("knob of a bifurcation diagram", knob, knobs)
    if start not in CURVE_STARTS:
        raise unknown_name("start", start, CURVE_STARTS)


def _checked_values(knob: str, values: Sequence[float] | np.ndarray) -> list[float]:
    """Return the values of the knob in ascending order. Raises `BadInput` if there are none or too many."""
    numbers = sorted(numbers_in(f"The values of {knob}", values))
    if not 1 <= len(numbers) <= MOST_VALUES:
        raise BadInput(f"A bifurcation diagram has 1 to {MOST_VALUES} values of its knob, not {len(numbers)}.")
    return numbers


def _points(chains: list[tuple[float, Scene]], start: str, keep: int, stop: Stop | None) -> Iterator[StrobePoint]:
    if start == "rest":
        ended = Stop()
        yield from on_all_cores(lambda shared: (_point(value, chain, None, keep, ended) for value, chain in shared),
                                [chains[i] for i in coarse_first(len(chains))], ended, stop)
        return
    yield from _carried(chains if start == "up" else reversed(chains), keep, stop)


def _carried(chains: Iterable[tuple[float, Scene]], keep: int, stop: Stop | None) -> Iterator[StrobePoint]:
    state: State | None = None
    for value, chain in chains:
        if stop:
            return
        point = _point(value, chain, state, keep, stop)
        state = point.state
        yield point


def _point(value: float, chain: Scene, start: State | None, keep: int, stop: Stop | None) -> StrobePoint:
    try:
        settling = run_until_settled(chain, start, stop)
        engine, strobes, error = _refined(settling) or (settling.engine, settling.engine.periods(keep)[0][1:], None)
    except ComputationError as failed:
        return StrobePoint(value, regime=Regime.unsettled(0), strobes=np.zeros((0, 2, chain.N)), state=start,
                           failure=failed.sentence)
    strobes = settling.engine.scaled.scales.states(strobes)
    kept = np.resize(strobes, (keep, *strobes.shape[1:]))  # the strobes of an orbit are repeated
    return StrobePoint(value, settling.regime, kept, engine.state, strobe_error=error)


def _refined(settling: SettlingRun) -> tuple[Engine, np.ndarray, float | None] | None:
    """The engine on an orbit, its strobes (n, 2, N) to the scene's accuracy, and their error.

    The error is that of integration plus the distance from the orbit; an error e of the n-period map moves its fixed
    point by e/(1 − |μ|). None if the motion is not periodic, or its orbit is not known to `_APART`.
    """
    regime = settling.regime
    if regime.period is None:
        return None
    coarse, distance = refined_orbit(settling, _REFINED_FRACTION * settling.scene.accuracy)
    finer = Engine(settling.scene, coarse.setting.finer(), 1, stop=settling.stop)
    finer.start(coarse.state)
    before, strobes = (engine.periods(regime.period, watch=False)[0][1:] for engine in (coarse, finer))
    largest = np.abs(strobes).max(axis=(0, 2), keepdims=True)
    change = float((np.abs(strobes - before) / np.where(largest > 0.0, largest, 1.0)).max())
    error = error_of_displacements(change, finer.setting, regime.assumed_contraction) + distance
    return (finer, strobes, error) if error <= _APART else None
