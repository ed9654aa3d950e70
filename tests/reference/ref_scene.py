"""The scenes of the reference, and their scaled form in extended precision.

Scaled units: length A0, time 1/phi with phi^2 = K sqrt(A0) / m, force K A0^{3/2}.  In them, every bead has mass one,
and contact c obeys

    F_c = s_c d^{3/2} + lambda (d / d_ref)^a d',   d = x_c - x_{c+1} + d_static,c > 0,   F_c = 0 otherwise,
    x_i'' = F_{i-1} - F_i - kappa x_i,               x_0 = sin(beta tau),   x_{N+1} = 0.

The exponent a is 0 (linear), 1/4 (tsuji) or 1/2 (kuwabara-kono).  With tension "cut" the force is max(0,
F_c).
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

LD = np.longdouble
Array = npt.NDArray[Any]

PI = 4 * np.arctan(LD(1))
SAMPLES = 8
EXPONENT = {"none": 0.0, "linear": 0.0, "tsuji": 0.25, "kuwabara-kono": 0.5}
#: Power p of the substitution t = t0 + s^p, which makes the motion after an onset analytic in s.
ROOT = {"none": 2, "linear": 2, "tsuji": 4, "kuwabara-kono": 2}


@dataclass(frozen=True)
class Scene:
    """A chain of equal beads in SI units, driven harmonically and started from rest."""

    name: str
    mass: float
    young: float
    poisson: float
    radius: float
    damping: float
    amplitude: float
    frequency: float
    periods: int
    beads: int = 11
    kappa: float = 0.0
    wall: float = 1.0
    law: str = "linear"
    tension: str = "allowed"
    preload: float = 0.0
    delta_ref: float = 5e-7

    def stiffness(self) -> LD:
        """Return K = E sqrt(2R) / (3 (1 - nu^2)) of a contact between beads [N/m^1.5]."""
        nu = LD(self.poisson)
        return LD(self.young) * np.sqrt(2 * LD(self.radius)) / (3 * (1 - nu * nu))


@dataclass(frozen=True)
class Model:
    """The scaled chain in long double."""

    beads: int
    beta: LD
    kappa: LD
    lam: LD
    exponent: LD
    root: int
    cut: bool
    strength: Array
    static: Array
    interval: LD
    length: LD
    speed: LD
    force: LD

    def damped(self) -> bool:
        """Return whether any contact dissipates energy."""
        return bool(self.lam != 0)


def scale(scene: Scene) -> Model:
    """Return the scaled model of a scene."""
    stiff, a0, mass = scene.stiffness(), LD(scene.amplitude), LD(scene.mass)
    phi = np.sqrt(stiff * np.sqrt(a0) / mass)
    unit = stiff * a0 * np.sqrt(a0)
    strength = np.ones(scene.beads + 1, dtype=LD)
    strength[-1] = LD(scene.wall)
    static = (LD(scene.preload) / unit / strength) ** (LD(2) / 3)
    exponent = LD(EXPONENT[scene.law])
    lam = LD(0) if scene.law == "none" else LD(scene.damping) / (mass * phi)
    lam = lam / (LD(scene.delta_ref) / a0) ** exponent
    beta = 2 * PI * LD(scene.frequency) / phi
    return Model(
        beads=scene.beads, beta=beta, kappa=LD(scene.kappa), lam=lam, exponent=exponent, root=ROOT[scene.law],
        cut=scene.tension == "cut", strength=strength, static=static, interval=2 * PI / beta / SAMPLES,
        length=a0, speed=a0 * phi, force=unit,
    )  # fmt: skip


def overlaps(model: Model, x: Array) -> Array:
    """Return the overlap of every contact; the last axis of x is driver, beads and wall."""
    return x[..., :-1] - x[..., 1:] + model.static


def contact_forces(model: Model, x: Array, v: Array) -> tuple[Array, Array]:
    """Return elastic and damping forces of every contact, gated by the strict H(d), without a tension cut."""
    d = np.maximum(overlaps(model, x), 0)
    rate = v[..., :-1] - v[..., 1:]
    root = np.sqrt(d)
    elastic = model.strength * d * root
    if model.exponent == 0:
        damping = model.lam * rate * (d > 0)
    elif model.exponent == LD(0.25):
        damping = model.lam * np.sqrt(root) * rate
    else:
        damping = model.lam * root * rate
    return elastic, damping


def driver(model: Model, phase: Any) -> tuple[Any, Any]:
    """Return the driver's scaled displacement and velocity at a phase [rad] (number or array)."""
    return np.sin(phase), model.beta * np.cos(phase)


def observe(model: Model, x: Array, v: Array) -> dict[str, Array]:
    """Return displacement, velocity, input and output forces in SI units for sampled states (samples, bodies)."""
    elastic, damping = contact_forces(model, x, v)
    total = elastic + damping
    if model.cut:
        total = np.maximum(total, 0)
    unit = model.force
    return {
        "displacement": x[:, 1:-1] * model.length,
        "velocity": v[:, 1:-1] * model.speed,
        "input_total": total[:, 0] * unit,
        "input_elastic": elastic[:, 0] * unit,
        "output_total": total[:, -1] * unit,
        "output_elastic": elastic[:, -1] * unit,
    }
