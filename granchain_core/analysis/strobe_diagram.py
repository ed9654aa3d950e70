"""The bifurcation diagram: a bead's states once per drive period (strobes) over a knob.

At each value of the knob the chain settles (regime, with its evidence), and its next strobes are kept: n points of an
orbit of period n, a closed curve seen from the side, or the many points of chaos. Where sweeps up and down differ,
more than one attractor exists.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from ..errors import BadInput, NumbersFailed
from ..input_checks import numbers_in, unknown_name, whole_number
from ..integrate.methods import FIXED_STEP
from ..quantities import QUANTITIES
from ..regime import Regime
from ..scene import Scene
from ..scene.given import require_scene
from ..state import State
from ..steady.batch.threads import on_all_cores
from ..steady.curve.order import CURVE_STARTS, coarse_first
from ..steady.settling.advance import run_until_settled
from ..stop import Stop
from ..tables import Column, Labelled, Table, axis, bead_axis, provenance, regime_columns
from ..tables.provenance import Attribute
from ..tables.words import evidence_columns, state_columns

#: Strobes closer than this part of the largest are one.
_APART = 1e-3
#: Most values of the knob.
MOST_VALUES = 20_000
#: Most strobes at each.
MOST_STROBES = 10_000


@dataclass(frozen=True, eq=False)
class StrobePoint:
    """The strobes at one value of the knob: displacement and velocity of every bead at phase 0, (P, 2, N) [m, m/s].

    `failure` is a sentence where the computation failed; there are no strobes then.
    """

    value: float
    regime: Regime
    strobes: np.ndarray
    state: State | None = None
    failure: str = ""

    def distinct(self, bead: int) -> int:
        """How many of the bead's displacements differ by more than a thousandth of the largest."""
        found = np.sort(self.strobes[:, 0, bead - 1])
        if found.size == 0:
            return 0
        return 1 + int((np.diff(found) > _APART * np.abs(found).max()).sum())


@dataclass(eq=False)
class StrobeDiagram(Labelled):
    """Strobes over a knob.

    Attributes
    ----------
    scene : Scene
        The chain.
    knob : str
        Name of the knob that is varied.
    start : str
        "rest": every value from rest; "up" or "down": the state is carried along.
    points : list of StrobePoint
        In ascending order of the knob.

    Examples
    --------
    >>> from granchain_core import scene, strobe_diagram
    >>> found = strobe_diagram(scene("sec2").evolve(N=2), "f", [1900.0, 2000.0], keep=8)
    >>> [point.regime.period for point in found.points], found.cloud(1)[0].shape
    ([1, 1], (16,))
    """

    scene: Scene
    knob: str
    start: str
    points: list[StrobePoint] = field(default_factory=list)

    def cloud(self, bead: int, velocity: bool = False) -> tuple[np.ndarray, np.ndarray]:
        """All points of bead 1..N, (M,) each: the knob's values, and displacements [m] or velocities [m/s]."""
        bead = whole_number("bead", bead, 1, self.scene.N)
        kept = [point for point in self.points if not point.failure]
        values = np.concatenate([np.full(len(point.strobes), point.value) for point in kept] or [np.zeros(0)])
        states = np.concatenate([point.strobes[:, int(velocity), bead - 1] for point in kept] or [np.zeros(0)])
        return values, states

    def tables(self) -> tuple[Table, ...]:
        """`strobes`: states over knob, strobe and bead, NaN after a failure; `values`: the regime of each."""
        quantity, most = QUANTITIES[self.knob], max((len(point.strobes) for point in self.points), default=0)
        states = np.full((len(self.points), most, 2, self.scene.N), np.nan)
        for row, point in zip(states, self.points, strict=True):
            row[: len(point.strobes)] = point.strobes
        knob = axis(self.knob, [point.value for point in self.points], quantity.unit, quantity.label)
        strobes = axis("strobe", np.arange(most), "1", "number of the strobe, one a drive period")
        failures = np.array([point.failure for point in self.points], dtype=object)
        regimes = [point.regime for point in self.points]
        return (Table("strobes", {**knob, **strobes, **bead_axis(self.scene.N)}, {
            **state_columns(states[:, :, 0], states[:, :, 1], (self.knob, "strobe", "bead")),
            **regime_columns(regimes, self.knob)}, (self.knob, "strobe")),
            Table("values", knob, {**regime_columns(regimes, self.knob), **evidence_columns(regimes, self.knob),
                                   "failure": Column(failures, (self.knob,), "", "why there are no strobes")}))

    def attributes(self) -> dict[str, Attribute]:
        """Knob and start, and where it comes from."""
        return {**provenance(self.scene, FIXED_STEP, None), "knob": self.knob, "start": self.start}

    def summary(self) -> list[str]:
        """The range of the knob, and what kinds of motion there are."""
        if not self.points:
            return ["no values"]
        unit, low, high = QUANTITIES[self.knob].unit, self.points[0].value, self.points[-1].value
        counts = Counter(f"period {p.regime.period}" if p.regime.period else p.regime.name for p in self.points)
        return [f"{len(self.points)} values of {self.knob}, {low:g} to {high:g} {unit}, start: {self.start}",
                ", ".join(f"{count} {name}" for name, count in sorted(counts.items()))]


def strobe_diagram(scene: Scene, knob: str, values: Sequence[float] | np.ndarray, start: str = "up", keep: int = 60,
                   stop: Stop | None = None, progress: Callable[[float], None] | None = None) -> StrobeDiagram:
    """The strobe diagram over one knob.

    Parameters
    ----------
    scene : Scene
        The chain.
    knob : str
        A continuous knob: "f", "A0", "D", "k", "kappa", "F0", "dimer", "taper", "striker" or "impurity".
    values : sequence of float
        Its values in SI, at most 20,000.
    start : str
        "up" or "down": each value starts where the one before it settled; "rest": each from rest, on all cores.
    keep : int
        Strobes at each value, 1 to 10,000.
    stop : Stop, optional
        When set, the diagram ends with the values that are finished.
    progress : callable, optional
        Called with the fraction that is done, 0 to 1.

    Returns
    -------
    StrobeDiagram
        Strobes and regime at each value.

    Raises
    ------
    BadInput
        Another knob or start, or a number out of range.

    Examples
    --------
    >>> from granchain_core import scene, strobe_diagram
    >>> found = strobe_diagram(scene("sec2").evolve(N=2, f=2000.0), "A0", [4e-7, 5e-7], keep=4)
    >>> [point.distinct(bead=1) for point in found.points]
    [1, 1]
    """
    knobs = [name for name, quantity in QUANTITIES.items() if quantity.is_continuous]
    if knob not in knobs:
        raise unknown_name("knob of a strobe diagram", knob, knobs)
    if start not in CURVE_STARTS:
        raise unknown_name("start", start, CURVE_STARTS)
    require_scene(scene)
    numbers = sorted(numbers_in(f"The values of {knob}", values))
    if not 1 <= len(numbers) <= MOST_VALUES:
        raise BadInput(f"A strobe diagram has 1 to {MOST_VALUES} values of its knob, not {len(numbers)}.")
    keep = whole_number("keep =", keep, 1, MOST_STROBES)
    chains = [(value, scene.evolve(**{knob: value})) for value in numbers]
    found = StrobeDiagram(scene, knob, start)
    for point in _points(chains, start, keep, stop):
        found.points.append(point)
        if progress is not None:
            progress(len(found.points) / len(chains))
    found.points.sort(key=lambda point: point.value)
    return found


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
        strobes = settling.engine.periods(keep)[0][1:]
    except NumbersFailed as failed:
        return StrobePoint(value, Regime.unsettled(0), np.zeros((0, 2, chain.N)), start, failed.sentence)
    scales = settling.engine.scaled.scales
    units = np.array([scales.length, scales.velocity])[:, None]
    return StrobePoint(value, settling.regime, strobes * units, settling.engine.state)
