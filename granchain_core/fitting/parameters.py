"""Free parameters of a fit: knobs with bounds and priors, and the scene for given values."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..errors import BadInput
from ..inputs.checks import unknown_name
from ..inputs.text import number_in
from ..scene import Amplitude, Bead, Scene
from ..scene.quantities import QUANTITIES

#: Parameters that can be fitted, with their units. K is the contact stiffness; it is varied through the Young's modulus
#: of all beads.
UNITS = {name: "N/m^{3/2}" if name == "K" else QUANTITIES[name].unit
         for name in ("A0", "k", "kappa", "D", "K", "F0", "wall")}


@dataclass(frozen=True)
class Free:
    """A parameter to be fitted.

    `name` is one of `UNITS`, or A0@f for the drive amplitude at one measured frequency [Hz]. It is searched between
    `low` and `high`, on a logarithmic scale if both are above 0. `prior` is the mean and standard deviation known from
    sources other than the data.
    """

    name: str
    low: float
    high: float
    prior: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        if self.knob not in UNITS or (self.at is None) != ("@" not in self.name) or (self.at and self.knob != "A0"):
            raise unknown_name("parameter", self.name, [*UNITS, "A0@60"])
        if not (math.isfinite(self.low) and math.isfinite(self.high) and self.low < self.high):
            raise BadInput(f"The bounds of {self.name} are {self.low:g} and {self.high:g}; the first must be below the "
                           "second.")
        if self.knob in QUANTITIES:
            for value in (self.low, self.high):
                QUANTITIES[self.knob].check(value)
        elif self.low <= 0.0:
            raise BadInput(f"{self.name} must be above 0, so its lower bound cannot be {self.low:g}.")
        if self.prior is not None and not self.prior[1] > 0.0:
            raise BadInput(f"The standard deviation {self.prior[1]:g} of {self.name}'s prior must be above 0.")

    @property
    def knob(self) -> str:
        """The name of the knob, without the frequency."""
        return self.name.partition("@")[0]

    @property
    def at(self) -> float | None:
        """The frequency [Hz] of an amplitude that applies at one frequency only; otherwise None."""
        return number_in(self.name.partition("@")[2])

    @property
    def unit(self) -> str:
        """The unit of the parameter."""
        return UNITS[self.knob]

    def value(self, part: float) -> float:
        """The parameter at a fraction `part` of its range, from 0 (low) to 1 (high)."""
        if self.low > 0.0:
            return float(self.low * (self.high / self.low) ** part)
        return float(self.low + (self.high - self.low) * part)


def free_of(text: str, prior: str | None = None) -> Free:
    """A parameter from the text NAME=low:high, with its prior from NAME=mean:sd. Raises `BadInput`."""
    name, _, bounds = text.partition("=")
    return Free(name, *_two(f"--free {text!r}", bounds, "NAME=low:high"),
                None if prior is None else _two(f"--prior {prior!r}", prior.partition("=")[2], "NAME=mean:sd"))


def _two(what: str, text: str, form: str) -> tuple[float, float]:
    numbers = [number_in(part) for part in text.split(":")]
    if len(numbers) != 2 or numbers[0] is None or numbers[1] is None:
        raise BadInput(f"{what} must have the form {form}.")
    return numbers[0], numbers[1]


def per_frequency(free: Sequence[Free], frequencies: Sequence[float] | np.ndarray) -> list[Free]:
    """The free parameters with one A0 for each frequency instead of the constant one."""
    listed: list[Free] = []
    for parameter in free:
        if parameter.name == "A0":
            listed += [replace(parameter, name=f"A0@{f:.10g}") for f in frequencies]
        else:
            listed.append(parameter)
    return listed


def with_values(scene: Scene, free: Sequence[Free],
                values: Sequence[float] | np.ndarray) -> tuple[Scene, Amplitude | None]:
    """The scene with these values, and the drive amplitude over the frequency if each frequency has its own."""
    given = list(zip(free, values, strict=True))
    changes = {parameter.knob: float(value) for parameter, value in given if parameter.at is None}
    stiffness = changes.pop("K", None)
    amplitudes = sorted((parameter.at, float(value)) for parameter, value in given if parameter.at is not None)
    if stiffness is not None:
        scene = stiffened(scene, stiffness / scene.K)
    scene = scene.evolve(**changes)
    table = np.array(amplitudes).reshape(-1, 2)
    return scene, Amplitude.table(table[:, 0], table[:, 1]) if amplitudes else None


def stiffened(scene: Scene, factor: float) -> Scene:
    """The scene with contacts `factor` times as stiff; springs to the ground [N/m] are unchanged."""
    def harder(bead: Bead) -> Bead:
        return replace(bead, young=bead.young * factor)

    return replace(scene, pattern=tuple(map(harder, scene.pattern)),
                   impurities=tuple((place, harder(bead)) for place, bead in scene.impurities))
