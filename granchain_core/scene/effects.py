"""The table of effects, with the knobs, presence, term in the equation, and names of each.

The table is the source of `Scene.effects`, the displayed equation, the slots that are filled (scaling.py), the names of
compiled kernels (warm.py), `--explain`, `granchain cite`, the page's switches and the kernels whose cost is measured.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from .description import Description
from .laws import LAWS
from .quantities import QUANTITIES


@dataclass(frozen=True)
class Equation:
    """Parts of the equation of motion in LaTeX: right-hand side, force and overlap of contact j, stiffness symbol."""

    motion: str
    force: str
    overlap: str
    stiffness: str


@dataclass(frozen=True)
class Effect:
    """One effect.

    `slot` is its field of the kernels' `Slots`. `off` has the knob values that switch it off. `knobs` are restored when
    it is switched on, and `usual` has their values if neither the visitor nor the scene has set them. `latex` adds its
    term to the equation. `label` names it in a scene, `key` in the name of a compiled kernel, which includes the law.
    `source` is the publication to cite for it. If it is not `possible`, `refusal` says why. `dissipates` is False for
    an effect that only stores energy, or acts on a force by which another effect dissipates energy.
    """

    name: str
    slot: str
    title: str
    meaning: str
    present: Callable[[Description], bool]
    latex: Callable[[Equation, Description], Equation] = lambda equation, scene: equation
    knobs: tuple[str, ...] = ()
    off: Mapping[str, Any] = field(default_factory=dict)
    usual: Mapping[str, Any] = field(default_factory=dict)
    label_of: Callable[[Description], str] | None = None
    key_of: Callable[[Description], str] | None = None
    possible: Callable[[Description], bool] = lambda scene: True
    refusal: str = ""
    source: str = ""
    dissipates: bool = True

    def __post_init__(self) -> None:
        for knob in (*self.knobs, *self.off, *self.usual):
            if knob not in QUANTITIES:
                raise TypeError(f"effect {self.name!r}: its knob {knob!r} is not among QUANTITIES of quantities.py.")
        if self.knobs and not (set(self.off) <= set(self.knobs) and self.off and self.usual):
            raise TypeError(f"effect {self.name!r} has knobs; it needs `off`, the values of some of them without it, "
                            "and `usual`, their values with it.")

    def label(self, scene: Description) -> str:
        """Return the name of the effect in a scene."""
        return self.title if self.label_of is None else self.label_of(scene)

    def key(self, scene: Description) -> str:
        """Return the name of the effect within the name of a compiled kernel."""
        return self.name if self.key_of is None else self.key_of(scene)


def _damped(equation: Equation, scene: Description) -> Equation:
    return replace(equation, force=equation.force + " + " + LAWS[scene.dissipation].latex)


def _cut(equation: Equation, scene: Description) -> Equation:
    return replace(equation, force=r"\max\left(0,\; " + equation.force + r"\right)")


def _founded(equation: Equation, scene: Description) -> Equation:
    return replace(equation, motion=equation.motion + r" - k\,u_i")


def _pressed(equation: Equation, scene: Description) -> Equation:
    return replace(equation, overlap=equation.overlap + r" + (F_0/" + equation.stiffness + ")^{2/3}")


#: All effects, in the order in which their terms enter the equation: the cut acts on the damped force.
EFFECTS = (
    Effect("dashpot", "dissipation", "contact damping", "A contact loses energy while it is pressed.",
           lambda scene: scene.has_dissipation, _damped, ("dissipation", "D"), {"dissipation": "none"},
           {"dissipation": "linear", "D": 100.0}, label_of=lambda scene: LAWS[scene.dissipation].title,
           key_of=lambda scene: scene.dissipation),
    Effect("tension", "tension", "tension cut", "A damped contact may not pull while it opens.",
           lambda scene: scene.cuts_tension, _cut, ("tension",), {"tension": "allowed"}, {"tension": "cut"},
           key_of=lambda scene: "cut", possible=lambda scene: scene.has_dissipation,
           refusal="Without contact damping no contact can pull: switch that on first.", dissipates=False),
    Effect("foundation", "foundation", "foundation", "A spring from every bead to the ground.",
           lambda scene: scene.k > 0.0, _founded, ("k",), {"k": 0.0}, {"kappa": 0.001}, dissipates=False),
    Effect("preload", "preload", "preload",
           "A static force presses the chain together; without it: sonic vacuum.",
           lambda scene: scene.F0 > 0.0, _pressed, ("F0",), {"F0": 0.0}, {"F0": 1.0}, dissipates=False),
)
#: The one effect that is not a knob of a scene: it does not change the motion.
ACCOUNT = Effect("account", "account", "energy account",
                 "Work, loss and stored energy are integrated alongside; the status line shows how well they balance.",
                 lambda scene: False, dissipates=False)
#: Slots that every scene fills, with the name of each one's content.
ALWAYS = {"chain": "Hertz contact", "driver": "driver"}


def effects_of(scene: Description) -> list[Effect]:
    """Return the effects in a scene."""
    return [effect for effect in EFFECTS if effect.present(scene)]


def latex(scene: Description) -> str:
    """Return motion, contact force, overlap and driver (Zhang et al. 2016, eqs. 1, 3 and 5), active terms only."""
    masses = not scene.is_uniform
    stiffness = "K_c" if masses or scene.wall_factor != 1.0 else "K"
    equation = Equation(("m_i" if masses else "m") + r"\,\ddot u_i = F_{i-1} - F_i",
                        stiffness + r"\,[\delta_c]_+^{3/2}", r"u_c - u_{c+1}", stiffness)
    for effect in effects_of(scene):
        equation = effect.latex(equation, scene)
    driver = r"A_0\sin 2\pi f t" if scene.is_driven else "0"
    start = r",\quad \dot u_1(0) = v_1" if scene.strike > 0.0 else ""
    return (equation.motion + r",\qquad F_c = " + equation.force + r",\qquad \delta_c = " + equation.overlap
            + r",\qquad u_0 = " + driver + r",\quad u_{N+1} = 0" + start)
