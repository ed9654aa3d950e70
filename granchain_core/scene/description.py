"""Frozen descriptions of a chain in SI units: its physics, not how it is computed."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..errors import BadInput
from .hertz import EXPONENT, OVERLAP_POWER
from .laws import LAWS
from .quantities import QUANTITIES, WALL_FACTORS


def is_number(value: object) -> bool:
    """Return whether a value is a real number (Python's or NumPy's) and not a boolean."""
    return isinstance(value, (float, int, np.floating, np.integer)) and not isinstance(value, bool)


#: Limits of a bead's values: above the first, at most the second. A stable material's Poisson ratio is from −1 to 0.5.
BEAD_LIMITS = {"mass": (0.0, math.inf), "radius": (0.0, math.inf), "young": (0.0, math.inf), "poisson": (-1.0, 0.5)}


@dataclass(frozen=True)
class Bead:
    """One elastic sphere. Raises `BadInput` for impossible values.

    Attributes
    ----------
    mass : float
        Mass [kg].
    radius : float
        Radius [m].
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

    def __post_init__(self) -> None:
        for name, (above, most) in BEAD_LIMITS.items():
            value = getattr(self, name)
            if not is_number(value) or not above < value <= most or value == math.inf:
                limits = f"above {above:g}" + (f", at most {most:g}" if most < math.inf else "")
                raise BadInput(f"A bead's {name} must be a finite number {limits}, not {str(value)[:40]!r}.")
            if type(value) is not float:
                object.__setattr__(self, name, float(value))


def reduced(left: Bead, right: Bead) -> tuple[float, float]:
    """Return E* [Pa] and R* [m] of two spheres in contact: 1/E* = Σ(1−ν²)/E, 1/R* = Σ1/R."""
    modulus = 1.0 / ((1 - left.poisson**2) / left.young + (1 - right.poisson**2) / right.young)
    return modulus, 1.0 / (1.0 / left.radius + 1.0 / right.radius)


def hertz_stiffness(left: Bead, right: Bead) -> float:
    """Return the stiffness K of F = K δ^{3/2} between two spheres [N/m^{3/2}].

    K = (4/3) E* √R*; equal spheres give E√(2R)/(3(1−ν²)), Zhang et al. 2016, eq. (1).
    """
    modulus, radius = reduced(left, right)
    return 4.0 / 3.0 * modulus * math.sqrt(radius)


@dataclass(frozen=True)
class Description:
    """The values of a driven chain, immutable and hashable, and the quantities derived from them.

    The model is eq. (1) of Zhang et al. 2016: N spheres in Hertz contact between a harmonic driver and a wall
    (docs/model.md). Contact 0 joins driver and bead 1, contact N joins bead N and the wall. `Scene` documents each
    field.
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
    dimer: float = 1.0
    taper: float = 1.0
    striker: float = 1.0
    site: int = 1
    impurity: float = 1.0
    drive: str = "harmonic"
    strike: float = 0.0
    end: str = "first"

    # --- derived quantities -------------------------------------------------------------------------------

    def bead(self, number: int) -> Bead:
        """Return bead `number`, counted from the driver, 1 to N, as in results.

        `pattern`, `impurities` and the knobs of the masses count from the chain's own first bead: with `end = "last"`,
        bead `number` is their entry N + 1 − `number`. An impurity replaces the pattern's bead.
        """
        if self.end == "last":
            number = self.N + 1 - number
        for place, bead in self.impurities:
            if place == number:
                return bead
        bead, part = self.pattern[(number - 1) % len(self.pattern)], self.mass_part(number)
        if part == 1.0:
            return bead
        return replace(bead, mass=part * bead.mass, radius=math.cbrt(part) * bead.radius)

    def mass_part(self, number: int) -> float:
        """Return the mass of bead `number`, in the chain's own numbering, over that of the pattern's bead.

        It follows from dimer, taper, striker and impurity, all of the same material.
        """
        part = 1.0 if self.N == 1 else self.taper ** (3.0 * (number - 1) / (self.N - 1))
        if number % 2 == 0:
            part *= self.dimer
        if number == 1:
            part *= self.striker
        if number == self.site:
            part *= self.impurity
        return part

    @property
    def is_uniform(self) -> bool:
        """Whether all beads are alike."""
        return len(set(self.beads)) == 1

    @property
    def beads(self) -> tuple[Bead, ...]:
        """Return all beads, from the driver to the wall."""
        return tuple(self.bead(i) for i in range(1, self.N + 1))

    def masses(self) -> np.ndarray:
        """Return the bead masses (N,) [kg]."""
        return np.array([b.mass for b in self.beads])

    @property
    def wall_factor(self) -> float:
        """Stiffness of the wall contact over that of two beads like the last one."""
        return WALL_FACTORS[self.wall] if isinstance(self.wall, str) else float(self.wall)

    def contact_stiffness(self) -> np.ndarray:
        """Return the Hertz stiffness of contacts 0..N (N+1,) [N/m^{3/2}]; the driver is a bead like bead 1."""
        beads = self.beads
        bodies = (beads[0], *beads)
        between = [hertz_stiffness(a, b) for a, b in itertools.pairwise(bodies)]
        return np.array([*between, self.wall_factor * hertz_stiffness(beads[-1], beads[-1])])

    def static_overlap(self) -> np.ndarray:
        """Return the overlap of every contact under the preload alone (N+1,) [m]: (F0/K)^{2/3}."""
        return (self.F0 / self.contact_stiffness()) ** OVERLAP_POWER

    @property
    def K(self) -> float:
        """Stiffness between two beads like bead 1 [N/m^{3/2}], the K of the paper's scales."""
        return hertz_stiffness(self.bead(1), self.bead(1))

    @property
    def kappa(self) -> float:
        """Dimensionless foundation stiffness κ = k/(K√A0)."""
        return self.k / (self.K * self.A0 ** (EXPONENT - 1.0))

    @property
    def period(self) -> float:
        """Drive period 1/f [s]."""
        return 1.0 / self.f

    @property
    def is_driven(self) -> bool:
        """Whether the driver moves."""
        return self.drive != "rest"

    @property
    def drive_amplitude(self) -> float:
        """Largest distance of the driver from its middle position [m]: A0, or 0 for a driver at rest."""
        return self.A0 if self.is_driven else 0.0

    @property
    def moves_at_start(self) -> bool:
        """Whether any bead has a velocity at time 0."""
        return bool(self.start_velocity) or self.strike > 0.0

    def velocities_at_start(self) -> np.ndarray:
        """Return the velocities of the beads at time 0 (N,) [m/s]: the strike, or those of `start_velocity` instead.

        Like the driver, both set the chain in motion, and so count from the driver for either `end`.
        """
        velocity = np.zeros(self.N)
        velocity[0] = self.strike
        for bead, speed in self.start_velocity:
            velocity[bead - 1] = speed
        return velocity

    @property
    def foundation_frequency(self) -> float:
        """Frequency of one bead on its foundation spring alone [Hz], √(k/m)/2π."""
        return math.sqrt(self.k / self.bead(1).mass) / (2 * math.pi)

    @property
    def knobs(self) -> dict[str, Any]:
        """Return every knob with its value in SI units, in the order of `QUANTITIES`."""
        return {name: getattr(self, name) for name in QUANTITIES}

    def differences(self) -> dict[str, Any]:
        """Return the knobs that differ from the preset (without kappa, which follows from k)."""
        base = dict(self.preset)
        return {n: v for n, v in self.knobs.items() if n != "kappa" and n in base and base[n] != v}

    @property
    def has_dissipation(self) -> bool:
        """Whether contacts dissipate energy."""
        return self.dissipation != "none" and self.D > 0

    @property
    def forces_jump(self) -> bool:
        """Whether contact forces jump when contacts close in motion, as with a linear dashpot, for which g(0) > 0."""
        return self.has_dissipation and LAWS[self.dissipation].jumps

    @property
    def cuts_tension(self) -> bool:
        """Whether contact forces are cut at zero; without damping, they are never negative."""
        return self.tension == "cut" and self.has_dissipation
