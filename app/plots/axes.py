"""Axes with a readable SI prefix."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from granchain_core.scene.quantities import QUANTITIES

from ..format import prefixed


@dataclass(frozen=True)
class Scale:
    """The scale of an axis: values in SI, divided by `factor`, are in `unit`."""

    title: str
    factor: float
    unit: str

    @property
    def label(self) -> str:
        """The title of the axis."""
        return f"{self.title} ({self.unit})" if self.unit else self.title


def knob_scale(knob: str, values: Sequence[float] = ()) -> Scale:
    """Return the scale of a knob: metres and newtons get a prefix by the largest value, other units do not."""
    quantity = QUANTITIES[knob]
    title = f"{quantity.label} {quantity.symbol}"
    if quantity.unit in ("m", "N") and max(values, default=0.0) > 0.0:
        factor, letter = prefixed(max(values))
        return Scale(title, factor, letter + quantity.unit)
    return Scale(title, 1.0, "" if quantity.unit == "1" else quantity.unit)


def force_scale(title: str, largest: float) -> Scale:
    """Return the scale of a force from its largest value [N]."""
    factor, letter = prefixed(largest)
    return Scale(title, factor, f"{letter}N")
