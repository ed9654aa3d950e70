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
#: Most cells of one parameter map.
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
        """An axis from any numbers; `BadInput` for words, repetitions, wrong order and what is out of range."""
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
    """A scene and two axes; cell (i, j) has y value i and x value j, its number is i · len(x) + j.

    With `amplitude` A0 follows f, which is one of the axes.
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
            raise BadInput(f"Both axes are {self.x.knob}; give two distinct knobs.")
        if names == {"k", "kappa"}:
            raise BadInput("k and kappa are the same quantity: give one of them an axis, not both.")
        if self.size > MOST_CELLS:
            raise BadInput(f"{len(self.x.values)} × {len(self.y.values)} = {self.size} cells are more than "
                           f"{MOST_CELLS}; take fewer points on an axis.")
        for i in (0, self.shape[0] - 1):  # steps a period are monotone along an axis: its ends suffice
            for j in (0, self.shape[1] - 1):
                scale_chain(self.cell(i * self.shape[1] + j)).steps_per_period()

    @property
    def shape(self) -> tuple[int, int]:
        """Cells along y and x."""
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
        """Hash of what the cells are: the scene and both axes. Its accuracy is left out: a batch does not use it."""
        described = {"scene": self.scene.evolve(accuracy=1e-6).digest, "x": [self.x.knob, self.x.values],
                     "y": [self.y.knob, self.y.values],
                     **({} if self.amplitude is None else {"amplitude": self.amplitude.to_json()})}
        return hashlib.sha256(json.dumps(described, sort_keys=True).encode()).hexdigest()[:16]

    def spacing(self) -> np.ndarray:
        """Step of the coarsest net each cell belongs to, (cells,): it stands for that many cells in both directions."""
        i, j = np.divmod(np.arange(self.size), self.shape[1])
        return np.asarray(1 << np.minimum(_level(i), _level(j)))

    def coarse_first(self) -> np.ndarray:
        """Numbers of all cells, the coarsest net first, so that the picture is there early; the next is twice as fine.

        In each net the cells with the longest drive period in the chain's own time, f/A0^{1/4}, come first: they cost
        most, and one of them begun last would leave the other cores waiting.
        """
        i, j = np.divmod(np.arange(self.size), self.shape[1])
        knob = {self.y.knob: self.y.array[i], self.x.knob: self.x.array[j]}
        length = knob.get("A0", self.scene.A0) ** RATE_POWER / knob.get("f", self.scene.f)
        return np.lexsort((-np.broadcast_to(length, i.shape), -self.spacing()))


def _level(index: np.ndarray) -> np.ndarray:
    """Number of times that an index is divisible by two; for 0 the largest number that counts."""
    most = 1
    while 1 << most <= int(index.max(initial=1)):
        most += 1
    level = np.zeros_like(index)
    for power in range(1, most + 1):
        level[index % (1 << power) == 0] = power
    return level
