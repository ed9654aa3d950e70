"""The grid of a parameter map: two knobs with their values, and the order in which its cells are computed."""

from __future__ import annotations

import hashlib
import itertools
import json
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import BadInput
from ..inputs.checks import series_in, unknown_name
from ..integrate.scaling import scale_chain
from ..scene import Amplitude, Scene
from ..scene.hertz import RATE_POWER
from ..scene.quantities import QUANTITIES
from ..scene.refusals import refuse_undriven

#: Knobs that may be an axis: the continuous ones that change the motion.
KNOBS = tuple(name for name, quantity in QUANTITIES.items() if quantity.is_axis)
#: Maximum number of cells of one parameter map.
MOST_CELLS = 4_000_000


@dataclass(frozen=True)
class Axis:
    """One knob and its ascending values in SI."""

    knob: str
    values: tuple[float, ...]

    def __post_init__(self) -> None:
        if self.knob not in KNOBS:
            raise unknown_name("knob for an axis", self.knob, KNOBS)
        for value in self.values:
            QUANTITIES[self.knob].check(value)
        if not self.values:
            raise BadInput(f"The axis {self.knob} has no values; give at least one.")
        if any(b <= a for a, b in itertools.pairwise(self.values)):
            raise BadInput(f"The values of the axis {self.knob} must ascend without repetition.")

    @classmethod
    def of(cls, knob: str, values: Iterable[Any]) -> Axis:
        """Make an axis from any numbers; raise `BadInput` for words, repetitions, wrong order or numbers out of range.
        """
        if knob not in KNOBS:
            raise unknown_name("knob for an axis", knob, KNOBS)
        listed = series_in(f"The values of the axis {knob}", values)
        checked = [QUANTITIES[knob].check(value) for value in listed]
        if any(isinstance(value, str) for value in checked):
            raise BadInput(f"The axis {knob} takes numbers, not words.")
        return cls(knob, tuple(float(value) for value in checked))

    @property
    def array(self) -> np.ndarray:
        """The values (n,)."""
        return np.array(self.values)


@dataclass(frozen=True)
class Grid:
    """A scene and two axes; cell (i, j) has y value i and x value j, and its number is i · len(x) + j.

    With `amplitude`, A0 follows f, which is one of the axes.
    """

    scene: Scene
    x: Axis
    y: Axis
    amplitude: Amplitude | None = None

    def __post_init__(self) -> None:
        refuse_undriven(self.scene)
        names = {self.x.knob, self.y.knob}
        if self.amplitude is not None:
            self.amplitude.check_knobs(*names)
        if len(names) == 1:
            raise BadInput(f"Both axes are {self.x.knob}; give two different knobs.")
        if names == {"k", "kappa"}:
            raise BadInput("k and kappa are the same quantity: use only one of them as an axis.")
        if self.size > MOST_CELLS:
            raise BadInput(f"{len(self.x.values)} × {len(self.y.values)} = {self.size} cells are more than "
                           f"{MOST_CELLS}; use fewer values on an axis.")
        for i in (0, self.shape[0] - 1):  # steps per period are monotonic along an axis: its ends suffice
            for j in (0, self.shape[1] - 1):
                scale_chain(self.cell(i * self.shape[1] + j)).steps_per_period()

    @property
    def shape(self) -> tuple[int, int]:
        """Number of cells along y and x."""
        return len(self.y.values), len(self.x.values)

    @property
    def size(self) -> int:
        """Number of cells."""
        return len(self.y.values) * len(self.x.values)

    def cell(self, number: int) -> Scene:
        """The scene of one cell."""
        i, j = divmod(number, self.shape[1])
        knobs = {self.x.knob: self.x.values[j], self.y.knob: self.y.values[i]}
        if self.amplitude is not None:
            knobs["A0"] = self.amplitude.at(knobs["f"])
        return self.scene.evolve(**knobs)

    @property
    def digest(self) -> str:
        """Hash of the scene and both axes, without the scene's accuracy, which a batch does not use."""
        described = {"scene": self.scene.evolve(accuracy=1e-6).digest, "x": [self.x.knob, self.x.values],
                     "y": [self.y.knob, self.y.values],
                     **({} if self.amplitude is None else {"amplitude": self.amplitude.to_json()})}
        return hashlib.sha256(json.dumps(described, sort_keys=True).encode()).hexdigest()[:16]

    def spacing(self) -> np.ndarray:
        """Step (cells,) of the coarsest net that contains each cell, which represents that many cells both ways."""
        i, j = np.divmod(np.arange(self.size), self.shape[1])
        return np.asarray(1 << np.minimum(_level(i), _level(j)))

    def coarse_first(self) -> np.ndarray:
        """Numbers of all cells, the coarsest net first, then each twice as fine, so that the map's shape shows early.

        In each net, the cells with the longest drive period in the chain's own time, A0^{1/4}/f, come first: they cost
        most, and one of them started last would keep the other cores waiting.
        """
        i, j = np.divmod(np.arange(self.size), self.shape[1])
        knob = {self.y.knob: self.y.array[i], self.x.knob: self.x.array[j]}
        length = knob.get("A0", self.scene.A0) ** RATE_POWER / knob.get("f", self.scene.f)
        return np.lexsort((-np.broadcast_to(length, i.shape), -self.spacing()))


def _level(index: np.ndarray) -> np.ndarray:
    """How often each index is divisible by two; for 0, the largest value needed."""
    most = 1
    while 1 << most <= int(index.max(initial=1)):
        most += 1
    level = np.zeros_like(index)
    for power in range(1, most + 1):
        level[index % (1 << power) == 0] = power
    return level
