"""The damping laws a scene can name, each once: the slot that is compiled, and its name in words.

Exponents stand beside the compiled code (kernels/effects/dissipation.py); the list of choices, the scale of D, the
equation on screen, the names of effects and the reference solutions read this table.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from .kernels.effects.dissipation import LAWS as SLOTS
from .kernels.effects.dissipation import KuwabaraKono, LinearDashpot, Tsuji, exponent


@dataclass(frozen=True)
class Law:
    """The damping force D (δ/δ_r)^a δ̇ of a closed contact: its name, its slot class, and its title."""

    name: str
    slot: Any
    title: str

    def __post_init__(self) -> None:
        if self.slot not in SLOTS:
            raise TypeError(f"damping law {self.name!r}: {self.slot.__name__} has no `exponent` and no `power` in "
                            "kernels/effects/dissipation.py.")

    @property
    def exponent(self) -> float:
        """a."""
        return float(exponent(self.slot(1.0)))

    @property
    def jumps(self) -> bool:
        """Whether the force jumps when a contact closes in motion, which it does for a = 0."""
        return self.exponent == 0.0

    @property
    def latex(self) -> str:
        """The force in SI."""
        if self.jumps:
            return r"D\,\dot\delta_j\,H(\delta_j)"
        return r"D\,(\delta_j/\delta_r)_+^{" + str(Fraction(self.exponent)) + r"}\,\dot\delta_j"


_TABLE = (
    Law("linear", LinearDashpot, "dashpot"),
    Law("tsuji", Tsuji, "Tsuji damping"),
    Law("kuwabara-kono", KuwabaraKono, "Kuwabara–Kono damping"),
)

LAWS: dict[str, Law] = {law.name: law for law in _TABLE}

for _slot in SLOTS:
    if _slot not in [law.slot for law in _TABLE]:
        raise TypeError(f"damping law {_slot.__name__} has no line in laws.py: no scene can name it.")
