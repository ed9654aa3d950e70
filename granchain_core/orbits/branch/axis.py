"""The knob of a branch: which knobs are continuous, and the coordinate used for continuation.

A branch is a curve of points z = (x/√(2N), ζ). x is the scaled state (u, w) at drive phase 0 in the scales of its own
scene, so that x remains of order one when the amplitude A0, and with it the scales, change. ζ is a coordinate of the
knob: its logarithm, the knob itself or, for F0, the static overlap. Arclength is measured in z.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from ...errors import BadInput
from ...inputs.checks import unknown_name
from ...scene import Amplitude, Scene
from ...scene.hertz import EXPONENT, OVERLAP_POWER
from ...scene.quantities import QUANTITIES

#: Knobs that change a chain continuously; N and the laws are discrete, `accuracy` does not change the chain.
CONTINUOUS = tuple(name for name, quantity in QUANTITIES.items() if quantity.is_continuous)
#: [branch] Length of a factor e in a logarithmic knob. The state changes by about its own size when f changes by a
#: tenth.
_LENGTH_OF_FACTOR_E = 10.0
#: [branch] Length of the whole range of every other knob.
_LENGTH_OF_RANGE = 20.0
#: Value of the attribute `coordinate` in the file of a branch over F0.
STATIC_OVERLAP = "static overlap"


@dataclass(frozen=True)
class KnobAxis:
    """One knob of a scene from `start` to `end`, with its coordinate ζ (0 at the smaller end).

    With `amplitude`, A0 follows the knob, which is f. With `by_overlap`, ζ is linear in F0^{2/3}, not in F0.
    """

    scene: Scene
    knob: str
    start: float
    end: float
    amplitude: Amplitude | None = None
    by_overlap: bool = False

    @classmethod
    def of(cls, scene: Scene, knob: str, start: object, end: object, amplitude: Amplitude | None = None) -> KnobAxis:
        """Check the arguments and return the axis; over F0 it has `by_overlap`.

        Raises `BadInput` for a knob that is unknown or discrete, and for values that it cannot take.
        """
        if knob not in QUANTITIES:
            raise unknown_name("knob", knob, CONTINUOUS)
        quantity = QUANTITIES[knob]
        if knob not in CONTINUOUS:
            raise BadInput(f"{quantity.label} {knob} cannot be moved continuously along a branch; those that can are "
                           f"{', '.join(CONTINUOUS)}.")
        first, last = float(quantity.check(start)), float(quantity.check(end))
        if first == last:
            raise BadInput(f"The branch would go from {knob} = {first:g} to the same value; give two different ones.")
        if amplitude is not None:
            amplitude.check_knobs(knob)
            for value in (first, last):
                amplitude.at(value)
        return cls(scene, knob, first, last, amplitude, by_overlap=knob == "F0")

    @property
    def logarithmic(self) -> bool:
        """Whether ζ is proportional to the knob's logarithm."""
        return QUANTITIES[self.knob].scale == "log"

    @property
    def direction(self) -> int:
        """+1 where the knob grows from start to end, −1 where it falls."""
        return 1 if self.end > self.start else -1

    @property
    def low(self) -> float:
        """The smaller end."""
        return min(self.start, self.end)

    @property
    def high(self) -> float:
        """The larger end."""
        return max(self.start, self.end)

    @property
    def _power(self) -> float:
        """The power of the knob in which ζ is linear, unless it is logarithmic.

        The chain depends on F0 only through its static overlaps (F0/K)^{2/3}, and smoothly. As functions of F0 itself,
        orbits have an infinite slope at F0 = 0.
        """
        return OVERLAP_POWER if self.by_overlap else 1.0

    @property
    def _range(self) -> tuple[float, float]:
        """The smaller end to that power, and the change per unit of ζ."""
        low, high = (end**self._power for end in (self.low, self.high))
        return low, (high - low) / _LENGTH_OF_RANGE

    def coordinate(self, value: float) -> float:
        """ζ of a knob value."""
        if self.logarithmic:
            return _LENGTH_OF_FACTOR_E * math.log(value / self.low)
        low, unit = self._range
        return (value**self._power - low) / unit

    def value(self, zeta: float) -> float:
        """Knob value at ζ, limited to the knob's allowed range."""
        if self.logarithmic:
            value = self.low * math.exp(zeta / _LENGTH_OF_FACTOR_E)
        else:
            low, unit = self._range
            value = low + zeta * unit
            if self.by_overlap:
                value = max(value, 0.0) ** EXPONENT
        quantity = QUANTITIES[self.knob]
        return min(max(value, quantity.low), quantity.high)

    def slope(self, value: float) -> float:
        """Derivative of the knob with respect to ζ."""
        if self.logarithmic:
            return value / _LENGTH_OF_FACTOR_E
        return self._range[1] * value ** (1.0 - self._power) / self._power

    def scene_at(self, value: float) -> Scene:
        """The scene with the knob at `value`."""
        if self.amplitude is None:
            return self.scene.evolve(**{self.knob: value})
        return self.scene.evolve(f=value, A0=self.amplitude.held(value))

    def damped_at(self, value: float) -> bool:
        """Whether the chain loses energy with the knob at `value`."""
        return self.scene_at(value).has_dissipation

    def text(self, value: float) -> str:
        """A knob value in words."""
        unit = QUANTITIES[self.knob].unit
        return f"{self.knob} = {value:.8g}{'' if unit in ('', '1') else ' ' + unit}"

    def contains(self, value: float) -> bool:
        """Whether a value is between the ends, or at one."""
        return self.low <= value <= self.high
