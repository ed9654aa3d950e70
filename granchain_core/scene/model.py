"""`Scene`: a chain's description with its effects, equation and identity, and `evolve` to change knobs."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass
from typing import Any

from ..errors import BadInput
from ..inputs.checks import unknown_name
from .checked import checked_fields, checked_values
from .description import Description
from .docstring import with_knobs
from .effects import effects_of, latex
from .hertz import EXPONENT, RATE_POWER
from .laws import LAWS
from .quantities import QUANTITIES
from .validity import warnings


@dataclass(frozen=True)
class Scene(Description):
    """A driven chain, immutable and hashable; `evolve` returns one with other knobs.

    Impossible values are refused with `BadInput`, however the scene is created.

    Attributes
    ----------
    name, title, look_at, paper : str
        Name and title of the scene, what to observe in it, and the section of the paper.
    pattern : tuple of Bead
        Beads that are repeated up to N beads: two entries make a dimer.
    reference_overlap : float
        Overlap at which D is stated for the laws of Tsuji and of Kuwabara and Kono [m].
    impurities : tuple of (int, Bead)
        Beads that replace the pattern's, by number from the chain's own first bead.
    start_velocity : tuple of (int, float)
        Beads that move at t = 0, by number from the driver, with their velocities [m/s], > 0 towards the wall.
    ranges : tuple of (str, float, float)
        Ranges of the sliders.
    preset : tuple
        The knobs of the preset from which it is derived.

    Notes
    -----
    Every knob of `QUANTITIES` is an attribute too, in SI units; `help(Scene)` lists them. Knobs of masses count beads
    from the chain's own first bead. `end="last"` reverses the order of the beads, including `pattern`, `impurities`,
    `dimer`, `taper`, `striker` and `site`; `strike`, `start_velocity` and results count from the driver.

    Examples
    --------
    >>> from granchain_core import scene
    >>> chain = scene("sec2").evolve(N=2, f=2000.0, dissipation="tsuji")
    >>> chain.effects
    ['contact', 'driver', 'wall', 'Tsuji damping']
    >>> chain.masses().shape, chain.contact_stiffness().shape
    ((2,), (3,))
    >>> chain.evolve(f=-1.0)
    Traceback (most recent call last):
    ...
    granchain_core.errors.BadInput: drive frequency f = -1 Hz is outside 0.1 to 1e+06 Hz; ...
    """

    def __post_init__(self) -> None:
        for name, value in checked_values(self).items():
            object.__setattr__(self, name, value)

    @property
    def effects(self) -> list[str]:
        """Names of the effects in this scene, and therefore in its kernel."""
        driver = "driver" if self.is_driven else "driver at rest"
        return ["contact", driver, "wall", *(effect.label(self) for effect in effects_of(self))]

    def equation_latex(self) -> str:
        """Return the equation of motion in LaTeX, with only the terms that are computed."""
        return latex(self)

    def validity(self) -> list[str]:
        """Return sentences on where the model is not valid for this scene; empty if it is."""
        return warnings(self)

    # --- identity and change -------------------------------------------------------------------------------

    def to_json(self) -> dict[str, Any]:
        """Return the whole scene as plain data, from which it can be rebuilt."""
        return asdict(self)

    @classmethod
    def from_json(cls, data: dict[str, Any]) -> Scene:
        """Return the scene that `to_json` described. Raises `BadInput` for a value that no scene can have."""
        return cls(**checked_fields(data))

    @property
    def digest(self) -> str:
        """Return the hash of everything that affects the result, the key of caches."""
        physics = {k: v for k, v in self.to_json().items()
                   if k not in ("name", "title", "look_at", "paper", "ranges", "preset")}
        return hashlib.sha256(json.dumps(physics, sort_keys=True).encode()).hexdigest()[:16]

    def evolve(self, /, **changes: Any) -> Scene:
        """Return this scene with other knobs; `kappa` sets k = κ·K·√A0 with the A0 of the resulting scene.

        Raises `BadInput` for unknown knobs, values outside their range, and k together with kappa.
        """
        for name in changes:
            if name not in QUANTITIES:
                raise unknown_name("knob", name, QUANTITIES)
        if "k" in changes and "kappa" in changes:
            raise BadInput("k and kappa are the same quantity: give one of them, not both.")
        checked = {name: QUANTITIES[name].check(value) for name, value in changes.items()}
        kappa = checked.pop("kappa", None)
        special = (*self.impurities, *self.start_velocity)
        if special and max(i for i, _ in special) > checked.get("N", self.N):  # type: ignore[operator]  # N is a number
            place = max(i for i, _ in special)
            raise BadInput(f"number of beads N = {checked['N']} leaves no bead {place}, which is special in scene "
                           f"{self.name!r}; the nearest valid value is {place}.")
        new = _with_values(self, checked)
        if kappa is not None:
            k = float(kappa) * new.K * new.A0 ** (EXPONENT - 1.0)
            new = _with_values(new, {"k": QUANTITIES["k"].check(k)})
        return new

    def scaled(self, s: float) -> Scene:
        """Return the chain with s times the amplitude and the same scaled motion (docs/model.md, "Scaled variables").

        (A0, f, D, F0) → (s A0, s^{1/4} f, s^{1/4 − a} D, s^{3/2} F0) at fixed κ, with the exponent a of the damping
        law. Displacements are multiplied by s, velocities by s^{5/4}, and forces by s^{3/2}; multipliers are the same.
        Raises `BadInput` if a value leaves its range.

        Examples
        --------
        >>> from granchain_core import scene
        >>> round(scene("sec2").scaled(2.0).f, 5)
        404.33042
        """
        a = LAWS[self.dissipation].exponent if self.dissipation in LAWS else 0.0
        speed = s ** (1.0 + RATE_POWER)
        new = self.evolve(A0=s * self.A0, f=s**RATE_POWER * self.f, D=s ** (RATE_POWER - a) * self.D,
                          F0=s**EXPONENT * self.F0, strike=speed * self.strike, kappa=self.kappa)
        thrown = tuple((bead, speed * velocity) for bead, velocity in self.start_velocity)
        return _with_values(new, {"start_velocity": thrown})


def _with_values(scene: Scene, values: dict[str, Any]) -> Scene:
    """Like `dataclasses.replace`, in a third of the time: curves create a scene per point, maps one per cell."""
    new = object.__new__(type(scene))
    vars(new).update(vars(scene) | values)
    new.__post_init__()
    return new


Scene.__doc__ = with_knobs(Scene.__doc__)
