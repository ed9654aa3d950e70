"""Frozen descriptions of a chain in SI: what there is, not how it is computed."""

from __future__ import annotations

import hashlib
import itertools
import json
import math
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from ..errors import BadInput, unknown_name
from ..quantities import QUANTITIES, WALL_FACTORS


@dataclass(frozen=True)
class Bead:
    """One elastic sphere.

    Attributes
    ----------
    mass : float
        [kg]
    radius : float
        [m]
    young : float
        Young's modulus [Pa].
    poisson : float
        Poisson's ratio [1].

    Examples
    --------
    >>> from granchain_core import Bead
    >>> Bead(mass=2.8e-2, radius=9.5e-3, young=193e9, poisson=0.3).radius
    0.0095
    """

    mass: float
    radius: float
    young: float
    poisson: float


def hertz_stiffness(left: Bead, right: Bead) -> float:
    """Stiffness K of F = K δ^{3/2} between two spheres [N/m^{3/2}].

    K = (4/3) E* √R*, 1/E* = Σ(1−ν²)/E, 1/R* = Σ1/R; equal spheres give E√(2R)/(3(1−ν²)), Zhang et al. 2016, eq. (1).
    """
    modulus = 1.0 / ((1 - left.poisson**2) / left.young + (1 - right.poisson**2) / right.young)
    radius = 1.0 / (1.0 / left.radius + 1.0 / right.radius)
    return 4.0 / 3.0 * modulus * math.sqrt(radius)


@dataclass(frozen=True)
class Scene:
    """A driven chain, immutable and hashable; `evolve` gives one with other knobs.

    The model is eq. (1) of Zhang et al. 2016: N spheres in Hertz contact between a harmonic driver and a wall
    (docs/model.md). Contact 0 joins driver and bead 1, contact N joins bead N and the wall.

    Attributes
    ----------
    name, title, look_at, paper : str
        What it is called, what to look at, and where in the paper it stands.
    pattern : tuple of Bead
        Repeated to N beads: two entries make a dimer.
    N : int
        Number of beads.
    f : float
        Drive frequency [Hz].
    A0 : float
        Drive amplitude [m]: the driver is at A0 sin 2πft.
    D : float
        Damping coefficient of a contact [N s/m].
    k : float
        Stiffness of each bead's foundation spring [N/m].
    F0 : float
        Static preload [N].
    wall : str or float
        "bead", "same-material", "rigid", or the wall contact's stiffness over that of two beads.
    dissipation : str
        "linear", "tsuji", "kuwabara-kono" or "none".
    tension : str
        "allowed", or "cut" where a contact must not pull.
    accuracy : float
        Relative error of the displacements that is asked for.
    reference_overlap : float
        Overlap at which D of a law that depends on it is stated [m].
    impurities : tuple of (int, Bead)
        Beads in place of the pattern's, by number from 1.
    start_velocity : tuple of (int, float)
        Beads that move at t = 0, by number, with their velocities [m/s].
    ranges : tuple of (str, float, float)
        Ranges of the sliders.
    preset : tuple
        The knobs of the preset it comes from.

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

    name: str
    title: str
    look_at: str
    paper: str
    pattern: tuple[Bead, ...]
    N: int
    f: float
    A0: float
    D: float
    k: float
    F0: float
    wall: str | float
    dissipation: str
    tension: str
    accuracy: float
    reference_overlap: float
    impurities: tuple[tuple[int, Bead], ...] = ()
    start_velocity: tuple[tuple[int, float], ...] = ()
    ranges: tuple[tuple[str, float, float], ...] = ()
    preset: tuple[tuple[str, Any], ...] = ()

    # --- derived quantities -------------------------------------------------------------------------------

    def bead(self, number: int) -> Bead:
        """The bead with this number, 1 to N."""
        for place, bead in self.impurities:
            if place == number:
                return bead
        return self.pattern[(number - 1) % len(self.pattern)]

    @property
    def beads(self) -> tuple[Bead, ...]:
        """All beads from left to right."""
        return tuple(self.bead(i) for i in range(1, self.N + 1))

    def masses(self) -> np.ndarray:
        """Bead masses (N,) [kg]."""
        return np.array([b.mass for b in self.beads])

    @property
    def wall_factor(self) -> float:
        """Stiffness of the wall contact over that of two beads like the last one."""
        return WALL_FACTORS[self.wall] if isinstance(self.wall, str) else float(self.wall)

    def contact_stiffness(self) -> np.ndarray:
        """Hertz stiffness of contacts 0..N (N+1,) [N/m^{3/2}]; the driver is a bead like bead 1."""
        beads = self.beads
        bodies = (beads[0], *beads)
        between = [hertz_stiffness(a, b) for a, b in itertools.pairwise(bodies)]
        return np.array([*between, self.wall_factor * hertz_stiffness(beads[-1], beads[-1])])

    def static_overlap(self) -> np.ndarray:
        """Overlap of every contact under the preload alone (N+1,) [m]: (F0/K)^{2/3}."""
        return (self.F0 / self.contact_stiffness()) ** (2.0 / 3.0)

    @property
    def K(self) -> float:
        """Stiffness between two beads like bead 1 [N/m^{3/2}], the K of the paper's scales."""
        return hertz_stiffness(self.bead(1), self.bead(1))

    @property
    def kappa(self) -> float:
        """Dimensionless foundation stiffness κ = k/(K√A0)."""
        return self.k / (self.K * math.sqrt(self.A0))

    @property
    def period(self) -> float:
        """Drive period 1/f [s]."""
        return 1.0 / self.f

    @property
    def foundation_frequency(self) -> float:
        """Frequency of one bead on its foundation spring alone, √(k/m)/2π [Hz]."""
        return math.sqrt(self.k / self.bead(1).mass) / (2 * math.pi)

    @property
    def knobs(self) -> dict[str, Any]:
        """Every knob with its value in SI, in the order of `QUANTITIES`."""
        return {name: getattr(self, name) for name in QUANTITIES}

    def differences(self) -> dict[str, Any]:
        """Knobs that differ from the preset (kappa left out: k says it)."""
        base = dict(self.preset)
        return {n: v for n, v in self.knobs.items() if n != "kappa" and n in base and base[n] != v}

    @property
    def effects(self) -> list[str]:
        """Names of the effects that are in this scene, and therefore in its kernel."""
        found = ["contact", "driver", "wall"]
        if self.has_dissipation:
            found.append({"linear": "dashpot", "tsuji": "Tsuji damping",
                          "kuwabara-kono": "Kuwabara–Kono damping"}[self.dissipation])
            if self.tension == "cut":
                found.append("tension cut")
        if self.k > 0:
            found.append("foundation")
        if self.F0 > 0:
            found.append("preload")
        return found

    @property
    def has_dissipation(self) -> bool:
        """Whether contacts lose energy at all."""
        return self.dissipation != "none" and self.D > 0

    @property
    def forces_jump(self) -> bool:
        """Whether a contact's force jumps when it closes in motion: a linear dashpot's does, as g(0) > 0."""
        return self.has_dissipation and self.dissipation == "linear"

    @property
    def cuts_tension(self) -> bool:
        """Whether contact forces are cut at zero: there has to be damping for them to be below."""
        return self.tension == "cut" and self.has_dissipation

    def equation_latex(self) -> str:
        """The equation of motion with the terms that are computed, and no others."""
        from .equation import latex

        return latex(self)

    def validity(self) -> list[str]:
        """Sentences on where the model itself stops being valid for this scene (none, when it is fine)."""
        from .validity import warnings

        return warnings(self)

    # --- identity and change -------------------------------------------------------------------------------

    def to_json(self) -> dict[str, Any]:
        """The whole scene as plain data, enough to build it again."""
        return asdict(self)

    @classmethod
    def from_json(cls, data: dict[str, Any]) -> Scene:
        """The scene that `to_json` described."""
        pairs = ("ranges", "start_velocity", "preset")
        return cls(**{**data, "pattern": tuple(Bead(**b) for b in data["pattern"]),
                      "impurities": tuple((int(i), Bead(**b)) for i, b in data["impurities"]),
                      **{p: tuple(tuple(x) for x in data[p]) for p in pairs}})

    @property
    def digest(self) -> str:
        """Hash of everything that changes the answer: the key of caches and the identity of a share link."""
        physics = {k: v for k, v in self.to_json().items()
                   if k not in ("name", "title", "look_at", "paper", "ranges", "preset")}
        return hashlib.sha256(json.dumps(physics, sort_keys=True).encode()).hexdigest()[:16]

    def evolve(self, **changes: Any) -> Scene:
        """This scene with other knobs; `kappa` sets k = κ·K·√A0 with the resulting scene's own A0.

        Raises `BadInput` for unknown knobs, values outside their range, and k together with kappa.
        """
        for name in changes:
            if name not in QUANTITIES:
                raise unknown_name("knob", name, QUANTITIES)
        if "k" in changes and "kappa" in changes:
            raise BadInput("k and kappa say the same thing: give one of them, not both.")
        checked = {name: QUANTITIES[name].check(value) for name, value in changes.items()}
        kappa = checked.pop("kappa", None)
        new = replace(self, **checked)  # type: ignore[arg-type]  # checked above against the table
        special = (*new.impurities, *new.start_velocity)
        if special and max(i for i, _ in special) > new.N:
            place = max(i for i, _ in special)
            raise BadInput(f"number of beads N = {new.N} leaves no bead {place}, which is special in scene "
                           f"{self.name!r}; the nearest valid value is {place}.")
        if kappa is not None:
            k = float(kappa) * new.K * math.sqrt(new.A0)
            new = replace(new, k=QUANTITIES["k"].check(k))  # type: ignore[arg-type]
        return new
