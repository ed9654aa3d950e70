"""Conversion of a scene in SI to scaled arrays and one slot per effect; all scales are defined here.

Scales (Zhang et al. 2016, section 2): length A0, time 1/φ with φ² = K√A0/m, force K A0^{3/2}, with m and K of bead 1.
The state consists of displacements, never positions, and the drive phase is never computed as 2πf times a large time.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple, TypeVar

import numpy as np

from ..errors import BadInput
from ..kernels.compiling.entry import Entries, types_of
from ..kernels.effects.contact import Chain
from ..kernels.effects.dissipation import exponent
from ..kernels.effects.driver import Harmonic
from ..kernels.effects.energy_account import EnergyAccount
from ..kernels.effects.foundation import Foundation
from ..kernels.effects.preload import Preload
from ..kernels.effects.tension import new_tension_cut
from ..kernels.equations.body_forces import add_force_slope
from ..kernels.equations.motion import Forces, Slots, evaluate_at_phase
from ..scene import Scene
from ..scene.effects import ACCOUNT, ALWAYS, EFFECTS, effects_of
from ..scene.hertz import EXPONENT, RATE_POWER
from ..scene.laws import LAWS, require_complete
from ..scene.state import State

#: [step size] Fixed steps: longest step in scaled time where overlaps are about one drive amplitude. A third of it, as
#: in the fine run of a curve, must have an error below 1e-6 of the motion, and a picture must not need half of it. The
#: error of displacements of section 2 after four periods from rest is 1.2e-5 (median of 40 frequencies from 100 to 2500
#: Hz; at most 1.9e-4). For a step of 0.4 it is 1.7e-4, for 0.1 it is 9e-7, and for a third of 0.2 it is 2e-7. Other
#: scenes: `_FIXED_STEP_ERROR` in integrate/methods.py.
_STEP = 0.2
#: [step size] Fixed steps: longest step for the oscillation of a bead on its foundation, in radians of phase.
_FOUNDATION_STEP = 0.1
#: [step size] Fixed steps: largest product of the step and the rate of the fastest damped mode. It is half of RK4's
#: stability limit on the negative real axis, 2.78. The rate is 4λ/m for the dashpots plus −∂P/∂v/m for forces from
#: outside the chain.
_DAMPING_LIMIT = 1.39
#: [step size] Fixed steps: largest speed of a bead over the speed of the body that pushes it. A light bead leaves a
#: heavy one twice as fast.
_FASTEST = 2.0
_Numbers = TypeVar("_Numbers", float, np.ndarray)
#: Called for every point of a curve.
_EVALUATE_AT_PHASE = Entries(evaluate_at_phase)
#: [step size] Fixed steps: fewest steps per drive period, however slowly the chain moves.
_FEWEST_STEPS_PER_PERIOD = 16
#: [step size] Fixed steps: most steps per drive period; more are refused. One period would take most of a minute.
MOST_STEPS_PER_PERIOD = 50_000_000


@dataclass(frozen=True)
class Scales:
    """Units of the scaled equations in SI: length [m], rate φ [1/s], force [N].

    The methods below, and `ScaledChain.from_si` and `to_si`, convert the kernels' numbers to SI and back.
    """

    length: float
    phi: float
    force: float

    def displacements(self, scaled: _Numbers) -> _Numbers:
        """Convert scaled displacements to m."""
        return scaled * self.length

    def velocities(self, scaled: _Numbers) -> _Numbers:
        """Convert scaled velocities to m/s."""
        return scaled * self.velocity

    def forces(self, scaled: _Numbers) -> _Numbers:
        """Convert scaled forces to N."""
        return scaled * self.force

    def states(self, scaled: np.ndarray) -> np.ndarray:
        """Convert scaled displacements and velocities (…, 2, N) to m and m/s."""
        return scaled * np.array([self.length, self.velocity])[:, None]

    def convert_in_place(self, displacement: np.ndarray, velocity: np.ndarray, force: np.ndarray) -> None:
        """Convert the scaled numbers of a long record to SI in place."""
        displacement[:] *= self.length
        velocity[:] *= self.velocity
        force[:] *= self.force

    def scaled_displacements(self, displacements: _Numbers) -> _Numbers:
        """Convert displacements [m] to scaled units."""
        return displacements / self.length

    def scaled_velocities(self, velocities: _Numbers) -> _Numbers:
        """Convert velocities [m/s] to scaled units."""
        return velocities / self.velocity

    def scaled_forces(self, forces: _Numbers) -> _Numbers:
        """Convert forces [N] to scaled units."""
        return forces / self.force

    @property
    def velocity(self) -> float:
        """Unit of velocity [m/s]."""
        return self.length * self.phi

    @property
    def energy(self) -> float:
        """Unit of energy [J]."""
        return self.force * self.length


class StepLimits(NamedTuple):
    """The limits of the fixed-step method's step at any drive frequency, in scaled units.

    `contacts` is the longest step for the contacts' springs, `damping` the fastest damped rate of their dashpots,
    `struck` the speed of the fastest bead at the start.
    """

    contacts: float
    damping: float
    struck: float


@dataclass(frozen=True)
class ScaledChain:
    """A scene ready for the kernels."""

    scene: Scene
    scales: Scales
    slots: Slots
    beta: float
    step_limits: StepLimits

    @property
    def beads(self) -> int:
        """Number of moving bodies: N; for a chain with its observer, the beads of both and the wall between them."""
        return self.bodies - 2

    @property
    def period(self) -> float:
        """Drive period in scaled time."""
        return 2 * math.pi / self.beta

    @property
    def bodies(self) -> int:
        """Number of bodies, N + 2 for one chain: beads, driver and wall."""
        return len(self.slots.chain.inverse_mass)

    @property
    def size(self) -> int:
        """Length of the whole state array."""
        return 2 * self.bodies + (2 if self.slots.account is not None else 0)

    @property
    def static_energy(self) -> float:
        """Energy of the contacts at rest under preload, which is not available to the motion; 0 without preload."""
        if self.slots.preload is None:
            return 0.0
        elastic = self.slots.chain.stiffness * self.slots.preload.static ** (EXPONENT + 1.0)
        return float(elastic.sum()) / (EXPONENT + 1.0)

    def with_own_tension(self) -> ScaledChain:
        """Return a copy with its own flags of force-free contacts, if there are any: an engine writes into them."""
        if self.slots.tension is None:
            return self
        return replace(self, slots=self.slots._replace(tension=new_tension_cut(self.bodies - 1)))

    def forces(self) -> Forces:
        """Return a workspace for one evaluation."""
        contacts = self.bodies - 1
        return Forces(np.zeros(contacts), np.zeros(contacts) if self.slots.dissipation is not None else None)

    def rows(self, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the beads' displacements and w (N,), as views into a state array y."""
        row = self.bodies
        return y[1 : row - 1], y[row + 1 : 2 * row - 1]

    def beads_of(self, y: np.ndarray) -> np.ndarray:
        """Return the beads' displacements and w in one array x (2N,), copied from a state array y."""
        return np.concatenate(self.rows(y))

    def embed(self, x: np.ndarray) -> np.ndarray:
        """Return the state array (2(N + 2),) of x (2N,), with driver and wall at zero."""
        y = np.zeros(2 * self.bodies)
        for row, values in zip(self.rows(y), (x[: self.beads], x[self.beads :]), strict=True):
            row[:] = values
        return y

    def from_si(self, state: State) -> np.ndarray:
        """Return the scaled (u, w) array (2(N + 2),) of a state at phase 0."""
        y = np.zeros(2 * self.bodies)
        displacement, velocity = self.rows(y)
        displacement[:] = self.scales.scaled_displacements(state.displacement)
        velocity[:] = self.scales.scaled_velocities(state.velocity)
        _EVALUATE_AT_PHASE(self.slot_types, self.slots, 0.0, y, np.zeros_like(y), self.forces(), True)
        y[0] = 0.0
        return y

    def to_si(self, y: np.ndarray) -> State:
        """Return the state in SI of a scaled (u, w) array at phase 0.

        The second half of y is w, not velocity; v is recovered from w and the overlaps.
        """
        slope = np.zeros_like(y)
        _EVALUATE_AT_PHASE(self.slot_types, self.slots, 0.0, y.copy(), slope, self.forces(), False)
        return State(self.scales.displacements(self.rows(y)[0]), self.scales.velocities(self.rows(slope)[0]))

    @cached_property
    def slot_types(self) -> Any:
        """The types of the slots, by which the kernels' specializations for them are found."""
        return types_of(self.slots)

    @cached_property
    def step(self) -> float:
        """The fixed-step method's step in scaled time: the shortest of the limits of contacts, damping and foundation.

        Damping rates are added. The frequencies ω of a bead between its contacts and on its foundation are not: where
        both are equal, the bead's own frequency, the root of the sum of both squares, is √2 times as high. The step in
        radians is then up to √2 times as long as each limit alone allows: 0.28 instead of 0.2, far below RK4's
        stability limit of 2.83. In the scenes with a foundation, ω of the contacts is nine times that of the
        foundation, and adding them would shorten the step by 0.14 %.
        """
        limits = self.step_limits
        step, (stiffness, damping) = limits.contacts, self._body_rates
        damping += limits.damping
        if damping > 0.0:
            step = min(step, _DAMPING_LIMIT / damping)
        if stiffness > 0.0:
            step = min(step, _FOUNDATION_STEP / math.sqrt(stiffness))
        return step

    @property
    def holds_beads(self) -> bool:
        """Whether a force from outside the chain, such as a foundation's, pulls every bead back to its place."""
        return self._body_rates[0] > 0.0

    @property
    def _body_rates(self) -> tuple[float, float]:
        """Return the largest −∂P/∂u / m and −∂P/∂v / m of the forces P from outside the chain on any bead.

        They are evaluated at one drive amplitude and the largest speed, from the same linearisation as the tangents, so
        a new force needs no entry here.
        """
        speed = _FASTEST * max(self.step_limits.struck, self.beta if self.scene.is_driven else 0.0)
        beads = np.arange(1, self.beads + 1)
        slopes = [add_force_slope(self.slots, beads, 0.0, 1.0, speed, *direction, 1.0)
                  for direction in ((1.0, 0.0), (0.0, 1.0))]
        # a number if there is no such force; np.min would take longer than all the rest
        stiffness, damping = (-float(slope if isinstance(slope, float) else slope.min()) for slope in slopes)
        return stiffness, damping

    def steps_per_period(self, multiple_of: int = 1) -> int:
        """Return the fixed-step method's steps per period, a multiple of `multiple_of`."""
        steps = math.ceil(max(self.period / self.step, _FEWEST_STEPS_PER_PERIOD) / multiple_of) * multiple_of
        if steps > MOST_STEPS_PER_PERIOD:
            raise BadInput(
                f"drive frequency f = {self.scene.f:g} Hz is so far below the chain's frequency scale φ that one "
                f"period takes {steps:.1e} steps; at most {MOST_STEPS_PER_PERIOD:.0e} are allowed: the nearest valid "
                f"frequency is about {self.scene.f * steps / MOST_STEPS_PER_PERIOD:.3g} Hz."
            )
        return steps


def scales_of(scene: Scene) -> Scales:
    """Return the scene's scales."""
    phi = math.sqrt(scene.K * scene.A0 ** (EXPONENT - 1.0) / scene.bead(1).mass)
    return Scales(scene.A0, phi, scene.K * scene.A0**EXPONENT)


def scaled_damping(scene: Scene, scales: Scales | None = None) -> float:
    """Return λ = D (A₀/δ_r)^a/(mφ), the scaled damping at an overlap of one length unit."""
    scales, law = scales_of(scene) if scales is None else scales, LAWS[scene.dissipation]
    strength = scene.D / (scene.bead(1).mass * scales.phi)
    return float(strength * (scales.length / scene.reference_overlap) ** law.exponent)


def _dissipation(scene: Scene, scales: Scales) -> Any:
    """Return the slot of the contacts' damping."""
    return LAWS[scene.dissipation].slot(scaled_damping(scene, scales))


#: Functions that fill each effect's slot with values in scaled units.
_FILLED: dict[str, Callable[[Scene, Scales], Any]] = {
    "dissipation": _dissipation,
    "tension": lambda scene, scales: new_tension_cut(scene.N + 1),
    "foundation": lambda scene, scales: Foundation(scene.kappa),
    "preload": lambda scene, scales: Preload(scene.static_overlap() / scales.length),
}

require_complete()
for _effect in EFFECTS:
    if _effect.slot not in _FILLED:
        raise TypeError(f"effect {_effect.name!r}: scaling.py does not say how its slot {_effect.slot!r} is filled.")
    if _effect.slot not in Slots._fields:
        raise TypeError(f"effect {_effect.name!r}: Slots (kernels/equations/motion.py) has no field {_effect.slot!r}.")


def _step_limits(scene: Scene, scales: Scales, slots: Slots) -> StepLimits:
    """Return the limits of the step for the overlaps that the drive, the preload or a struck bead cause."""
    largest_inverse_mass = float(slots.chain.inverse_mass.max())
    stiffness, struck = slots.chain.stiffness, np.abs(scene.velocities_at_start()) / scales.velocity
    overlap = max(1.0, float(slots.preload.static.max()) if slots.preload is not None else 0.0)
    if struck.any():  # all of a bead's energy in one contact: K δ^{p+1}/(p + 1) = m v²/2
        energy = 0.5 * float((struck**2 / slots.chain.inverse_mass[1 : scene.N + 1]).max())
        overlap = max(overlap, ((EXPONENT + 1.0) * energy / float(stiffness.min())) ** (1.0 / (EXPONENT + 1.0)))
    step, damping = _STEP / math.sqrt(largest_inverse_mass * float(stiffness.max())) / overlap**RATE_POWER, 0.0
    if slots.dissipation is not None:
        strength = slots.dissipation.coefficient * overlap ** exponent(slots.dissipation)
        damping = 4.0 * strength * largest_inverse_mass
    return StepLimits(step, damping, float(struck.max()))


def scale_chain(scene: Scene, account: bool = False) -> ScaledChain:
    """Return the scaled arrays and slots of `scene`; `account` adds the energy account to the equations."""
    scales = scales_of(scene)
    beta = 2 * math.pi * scene.f / scales.phi
    inverse_mass = np.zeros(scene.N + 2)
    inverse_mass[1:-1] = scene.bead(1).mass / scene.masses()
    filled = {effect.slot: _FILLED[effect.slot](scene, scales) for effect in effects_of(scene)}
    slots = Slots(
        chain=Chain(inverse_mass, scene.contact_stiffness() / scene.K),
        driver=Harmonic(1.0 if scene.is_driven else 0.0, beta),
        account=EnergyAccount(1) if account else None,
        **filled,
    )
    return ScaledChain(scene, scales, slots, beta, _step_limits(scene, scales, slots))


def scale_like(known: ScaledChain, scene: Scene) -> ScaledChain:
    """Return `scale_chain(scene)`; if it differs from `known` only by its frequency, both share their arrays."""
    if known.slots.account is not None or vars(known.scene) | {"f": scene.f} != vars(scene):
        return scale_chain(scene)
    beta = 2 * math.pi * scene.f / known.scales.phi
    driver = known.slots.driver._replace(beta=beta)
    scaled = replace(known, scene=scene, slots=known.slots._replace(driver=driver), beta=beta).with_own_tension()
    vars(scaled)["slot_types"] = known.slot_types  # the arrays are the same ones, or of the same types
    return scaled


_TITLES = ALWAYS | {effect.slot: effect.title for effect in (*EFFECTS, ACCOUNT)}


def slots_of(scene: Scene, account: bool) -> list[tuple[str, str, str | None]]:
    """Return every slot of the scene's kernel: name, title, and the compiled type, or None if it is absent."""
    slots = scale_chain(scene, account=account).slots
    named = zip(slots._fields, slots, strict=True)
    return [(name, _TITLES[name], None if slot is None else type(slot).__name__) for name, slot in named]
