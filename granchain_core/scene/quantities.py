"""The table of knobs, with symbol, unit, range, LaTeX and meaning of each.

Sliders, command line, share links and HDF5 attributes read it, and a test compares the documentation with it.
"""

from __future__ import annotations

import difflib
import math
from dataclasses import dataclass

import numpy as np

from ..errors import BadInput
from ..inputs.text import number_in
from .laws import LAWS


@dataclass(frozen=True)
class Quantity:
    """One knob of a scene, in SI units.

    `low` and `high` limit the accepted values; the narrower range of a slider belongs to the scene. `scale` says how a
    slider covers its range: "linear", "log", or "cubic" for knobs that start at 0 and span decades (the value is the
    cube of the position, with fine steps near 0). `step` is the fine step of the keyboard; 0 stands for half a decade.
    `choices` is set for knobs that are words; `numeric` says whether a plain number is accepted too. `main` knobs are
    always on the page, the others under "more knobs"; those with `main_if_set` are on the page if the scene's preset
    differs from the default. `short` is the label next to a number where `label` is too long. `at_zero` says in a few
    words what 0 means if 0 switches something off. `shown_in` is the factor and unit on the page if the unit is not
    `unit`. `changes_motion` is False for a knob of the computation alone. `at_start` is True for a knob that changes
    the start of a motion, not the chain.
    """

    name: str
    symbol: str
    unit: str
    latex: str
    label: str
    meaning: str
    low: float = -math.inf
    high: float = math.inf
    scale: str = "linear"
    step: float = 0.0
    choices: tuple[str, ...] = ()
    numeric: bool = True
    whole: bool = False
    main: bool = False
    main_if_set: bool = False
    short: str = ""
    at_zero: str = ""
    shown_in: tuple[float, str] | None = None
    changes_motion: bool = True
    at_start: bool = False

    @property
    def is_axis(self) -> bool:
        """Whether the quantity can be an axis of a map: a number that changes the motion and need not be whole."""
        return self.numeric and not self.whole and self.changes_motion

    @property
    def is_continuous(self) -> bool:
        """Whether a branch can follow it: it is an axis without named values, and belongs to the chain itself."""
        return self.is_axis and not self.choices and not self.at_start

    def check(self, value: object) -> float | int | str:
        """Return `value` as this knob's type. Raises `BadInput` with the allowed range and the nearest valid value."""
        if isinstance(value, str) and value.strip() in self.choices:
            return value.strip()
        if not self.numeric:
            raise self._unknown_choice(value)
        number = self._number(value)
        if not self.low <= number <= self.high:
            nearest = min(max(number, self.low), self.high)
            raise BadInput(
                f"{self._called} = {number:g}{self._unit()} is outside "
                f"{self.low:g} to {self.high:g}{self._unit()}; the nearest valid value is {nearest:g}."
            )
        if self.whole:
            if number != int(number):
                raise BadInput(
                    f"{self._called} must be a whole number, not {number:g}; "
                    f"the nearest is {round(number)}."
                )
            return int(number)
        return number

    @property
    def _called(self) -> str:
        """Label and name of the quantity, or one of them if they are the same word."""
        return self.name if self.label == self.name else f"{self.label} {self.name}"

    def _number(self, value: object) -> float:
        if isinstance(value, (bool, np.bool_)):
            raise self._not_a_number(value)
        try:
            number = number_in(value) if isinstance(value, str) else float(value)  # type: ignore[arg-type]
        except (TypeError, ValueError, OverflowError):
            raise self._not_a_number(value) from None
        if number is None or not math.isfinite(number):
            raise self._not_a_number(value)
        return number

    def _not_a_number(self, value: object) -> BadInput:
        if self.choices and isinstance(value, str):
            return self._unknown_choice(value)
        return BadInput(
            f"{self._called} must be a number from {self.low:g} to {self.high:g}{self._unit()}, "
            f"not {str(value)[:40]!r}."
        )

    def _unknown_choice(self, value: object) -> BadInput:
        near = difflib.get_close_matches(str(value), self.choices, n=1, cutoff=0.0)[0]
        number = f", or a number from {self.low:g} to {self.high:g}" if self.numeric else ""
        return BadInput(
            f"{self._called} = {str(value)[:40]!r} is not one of {', '.join(self.choices)}{number}; "
            f"the nearest is {near!r}."
        )

    def _unit(self) -> str:
        return f" {self.unit}" if self.unit not in ("", "1") else ""


WALL_FACTORS = {"bead": 1.0, "same-material": math.sqrt(2.0), "rigid": 2.0 * math.sqrt(2.0)}
DISSIPATION_LAWS = (*LAWS, "none")
TENSION = ("allowed", "cut")
DRIVES = ("harmonic", "rest")
ENDS = ("first", "last")

_TABLE = (
    Quantity("f", "f", "Hz", "f", "drive frequency", "Oscillations of the driver per second.",
             0.1, 1e6, "log", 0.1, main=True),
    Quantity("A0", "A₀", "m", "A_0", "drive amplitude", "How far the driver moves from its middle position.",
             1e-12, 1e-4, "log", 1e-9, main=True, shown_in=(1e-6, "µm")),
    Quantity("D", "D", "N s/m", "D", "contact damping",
             "Force of the contact's dashpot per speed of approach; for a law in which it grows with the overlap, its "
             "value at the scene's reference overlap.", 0.0, 1e6, "linear", 0.1, main=True, short="damping",
             at_zero="contacts lose no energy"),
    Quantity("k", "k", "N/m", "k", "foundation stiffness", "Spring from every bead to the ground (the flexures).",
             0.0, 1e10, "cubic", 10.0, main=True, short="foundation",
             at_zero="no springs to the ground"),
    Quantity("kappa", "κ", "1", r"\kappa", "foundation stiffness, dimensionless",
             "k divided by K·√A₀, the secant stiffness F/δ of a contact of two beads at an overlap of one drive "
             "amplitude.", 0.0, 100.0, "cubic", 1e-5, main=True, short="k / (K√A₀)"),
    Quantity("N", "N", "1", "N", "number of beads", "Beads between the driver and the wall.",
             1, 10_000, "linear", 1, whole=True, short="beads"),
    Quantity("F0", "F₀", "N", "F_0", "preload",
             "Force at rest in every contact; the wall stays in place. 0 is the sonic vacuum.",
             0.0, 1e4, "linear", 0.1, at_zero="nothing presses the beads"),
    Quantity("dimer", "m₂/m₁", "1", "m_2/m_1", "mass of every second bead",
             "Mass of beads 2, 4, … over the mass of the others. All are of one material, so the radius scales with "
             "its cube root. 1 is a chain of equal beads.", 1e-3, 1e3, "log", short="dimer", main_if_set=True),
    Quantity("taper", "R_N/R₁", "1", "R_N/R_1", "taper",
             "Radius of the last bead over the radius of the first; the radii form a geometric sequence.",
             0.01, 100.0, "log", main_if_set=True),
    Quantity("striker", "mₛ/m", "1", "m_s/m", "mass of bead 1",
             "Mass of bead 1 (the striker) relative to a regular bead at its place.",
             1e-3, 1e3, "log", short="striker", main_if_set=True),
    Quantity("site", "j", "1", "j", "place of the impurity", "Index j of the impurity bead.",
             1, 10_000, "linear", 1, whole=True, short="impurity’s place", main_if_set=True),
    Quantity("impurity", "mⱼ/m", "1", "m_j/m", "mass of the impurity",
             "Mass of bead j relative to a regular bead at its place; 1 means no impurity.", 1e-3, 1e3, "log",
             short="impurity", main_if_set=True),
    Quantity("drive", "", "", "", "drive", "Whether the driver moves: harmonic, or at rest as a fixed bead. Without a "
             "drive, 1/f is only the time that is shown.", choices=DRIVES, numeric=False, main_if_set=True),
    Quantity("strike", "v₁", "m/s", "v_1", "initial velocity of bead 1",
             "Speed at which bead 1 moves towards the wall at time 0.", 0.0, 100.0, "cubic", 0.001, short="strike",
             at_zero="bead 1 starts at rest", at_start=True, main_if_set=True),
    Quantity("end", "", "", "", "driven end", "The end that the driver touches; the wall is at the other. "
             "“last” drives a chain of unequal beads from its other end.", choices=ENDS, numeric=False,
             main_if_set=True),
    Quantity("wall", "W", "1", "W", "right wall",
             "Stiffness of the last contact over that of two beads like the last: 1 for a fixed bead, √2 for a flat "
             "wall of the same material, 2√2 for a rigid flat wall, or a number.",
             1e-6, 1e6, choices=tuple(WALL_FACTORS), short="wall"),
    Quantity("dissipation", "", "", "", "damping law", "How a contact loses energy.",
             choices=DISSIPATION_LAWS, numeric=False, short="law"),
    Quantity("tension", "", "", "", "tension", "Whether the dashpot may pull while a contact opens "
             "(the paper's law) or the contact force is cut at zero.", choices=TENSION, numeric=False),
    Quantity("accuracy", "ε", "1", r"\varepsilon", "accuracy", "Requested relative error of the displacements.",
             1e-12, 0.1, "log", 0.0, main=True, changes_motion=False),
)

QUANTITIES: dict[str, Quantity] = {q.name: q for q in _TABLE}
