"""The damping laws, with the name of each in scenes and in words, its slot class, and the publication to cite.

Exponents are in kernels/effects/dissipation.py, with the compiled code. This table is the source of the knob's choices,
the scale of D, the displayed equation, the names of effects, `granchain cite` and the reference solutions.
"""

from __future__ import annotations

import importlib
from dataclasses import dataclass
from fractions import Fraction
from typing import Any


@dataclass(frozen=True)
class Law:
    """The damping force D (δ/δ_r)^a δ̇ of a closed contact.

    `name` is its name in scenes, `title` its name in words, and `slot_class` the name of its slot class. `source` is
    the publication to cite, or "" if there is none.
    """

    name: str
    slot_class: str
    title: str
    source: str

    @property
    def slot(self) -> Any:
        """The law's slot class, loaded at first use because it imports the compiler."""
        slots = {law.__name__: law for law in _dissipation().LAWS}
        if self.slot_class not in slots:
            raise TypeError(f"damping law {self.name!r}: {self.slot_class} has no `exponent` and no `power` in "
                            "kernels/effects/dissipation.py.")
        return slots[self.slot_class]

    @property
    def exponent(self) -> float:
        """The damping exponent a."""
        return float(_dissipation().exponent(self.slot(1.0)))

    @property
    def jumps(self) -> bool:
        """Whether the force jumps when a contact closes in motion, which is the case for a = 0."""
        return self.exponent == 0.0

    @property
    def latex(self) -> str:
        """The force in LaTeX, in SI units."""
        if self.jumps:
            return r"D\,\dot\delta_c\,H(\delta_c)"
        return r"D\,(\delta_c/\delta_r)_+^{" + str(Fraction(self.exponent)) + r"}\,\dot\delta_c"


LAWS: dict[str, Law] = {law.name: law for law in (
    Law("linear", "LinearDashpot", "dashpot", source=""),
    Law("tsuji", "Tsuji", "Tsuji damping",
        "Y. Tsuji, T. Tanaka, T. Ishida. Lagrangian numerical simulation of plug flow of cohesionless particles in a "
        "horizontal pipe. Powder Technology 71, 239–250 (1992)."),
    Law("kuwabara-kono", "KuwabaraKono", "Kuwabara–Kono damping",
        "G. Kuwabara, K. Kono. Restitution coefficient in a collision between two spheres. Jpn. J. Appl. Phys. 26, "
        "1230–1233 (1987)."),
)}


def require_complete() -> None:
    """Check that the table and the compiled laws agree. Raises `TypeError` naming a law that is missing."""
    named = [law.slot for law in LAWS.values()]
    for slot in _dissipation().LAWS:
        if slot not in named:
            raise TypeError(f"damping law {slot.__name__} has no line in laws.py: no scene can name it.")


def _dissipation() -> Any:
    return importlib.import_module("granchain_core.kernels.effects.dissipation")
