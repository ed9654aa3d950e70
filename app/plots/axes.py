"""Axes with a readable SI prefix."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from granchain_core.scene.quantities import QUANTITIES

from ..format import prefixed


@dataclass(frozen=True)
class Scale:
    """An axis in SI divided by `factor`, in `unit`."""

    title: str
    factor: float
    unit: str

    @property
    def label(self) -> str:
        """The title of the axis."""
        return f"{self.title} ({self.unit})" if self.unit else self.title


def knob_scale(knob: str, values: Sequence[float] = ()) -> Scale:
    """The axis of a knob. Metres and newtons get a prefix by the largest value, hertz and combined units none."""
    quantity = QUANTITIES[knob]
    title = f"{quantity.label} {quantity.symbol}"
    if quantity.unit in ("m", "N") and max(values, default=0.0) > 0.0:
        factor, letter = prefixed(max(values))
        return Scale(title, factor, letter + quantity.unit)
    return Scale(title, 1.0, "" if quantity.unit == "1" else quantity.unit)


def force_scale(title: str, largest: float) -> Scale:
    """The axis of a force whose largest value [N] is known."""
    factor, letter = prefixed(largest)
    return Scale(title, factor, f"{letter}N")
