"""A bifurcation point: where the critical multiplier of a branch over one knob meets its condition.

    fold             μ = +1
    period_doubling  μ = −1
    neimark_sacker   |μ| = 1, μ not real

The orbit's branch over the knob x is a curve in (state, x) with arclength s. On it, Newton's method solves
map(state, x) = state bordered by the arclength condition, so that folds need no special treatment. The root of the
condition along s is found by secants.

docs/parameter-map.md explains why Newton's method is that of a single orbit (orbits/damped_newton.py), not that of
orbits/branch.

Source: Kuznetsov 2004, chapter 10.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import BadInput, ComputationError
from ..execution.stop import Stop
from ..inputs.checks import unknown_name
from ..orbits.branch.special import BIFURCATIONS
from ..orbits.damped_newton import iterate
from ..orbits.stroboscopic_map import MULTIPLIER_ERROR, Flow, StroboscopicMap
from ..parameter_maps.grid import KNOBS
from ..scene import Scene
from ..scene.state import State

#: Distance from its condition within which the critical multiplier meets it: the error of a multiplier.
_CONDITION_ERROR = MULTIPLIER_ERROR
#: Relative change of a knob for its difference quotient; the map is smooth to 1e-12.
_DIFFERENCE = 1e-6
#: First step along a branch, relative to the state and the knob.
_FIRST_ARC = 1e-3
#: Longest secant step, in units of the last step.
_LONGEST_SECANT = 6.0
#: Maximum number of secant steps.
_MOST_SECANTS = 14
#: Maximum number of sizes tried for a step, each half of the previous one, where the branch is lost.
_MOST_HALVINGS = 3
#: Angle from +1 or −1 below which a critical pair is not distinguished from a real multiplier [rad].
_REAL_ANGLE = 1e-7


@dataclass(frozen=True, eq=False)
class BifurcationPoint:
    """A point of a bifurcation curve: both knobs, the critical multiplier, and the orbit's scaled state at phase 0."""

    x: float
    y: float
    multiplier: complex
    state: np.ndarray


@dataclass(frozen=True, eq=False)
class KnobBranch:
    """Orbits of `periods` drive periods over the knob x; a point is X = (scaled state, x / unit), (2N + 1,).

    `near` is the critical multiplier of the previous point, if there is one.
    """

    scene: Scene
    knob: str
    unit: float
    periods: int
    stop: Stop | None
    near: complex | None = None

    def at(self, ratio: float) -> Scene:
        """The scene at `ratio`, a point's last entry x / unit."""
        return self.scene.evolve(**{self.knob: float(ratio) * self.unit})

    def map(self, X: np.ndarray) -> tuple[Flow, float]:
        """The map from X with its derivative (2N, 2N), and the residual."""
        if not np.isfinite(X).all() or X[-1] <= 0.0:
            raise ComputationError("Newton's method left the range of the knob.", "no-convergence")
        stroboscopic_map = StroboscopicMap(self.at(X[-1]), self.periods, self.stop)
        flow = stroboscopic_map(X[:-1])
        return flow, stroboscopic_map.residual(flow.end, X[:-1])

    def slope(self, X: np.ndarray) -> np.ndarray:
        """Derivative (2N,) of the map's end with respect to x / unit."""
        ends = [StroboscopicMap(self.at(X[-1] * (1.0 + sign * _DIFFERENCE)), self.periods, self.stop).end(X[:-1])
                for sign in (1.0, -1.0)]
        return np.asarray((ends[0] - ends[1]) / (2.0 * _DIFFERENCE * X[-1]))

    def solve(self, guess: np.ndarray, direction: np.ndarray, slope: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Find the orbit in the plane through `guess` perpendicular to `direction`, and the map's derivative there.

        `slope` may be that of a nearby point: it only steers the iterations.
        """
        def step(X: np.ndarray, flow: Flow) -> np.ndarray:
            off = np.append(flow.end - X[:-1], direction @ (X - guess))
            return -np.linalg.solve(_bordered(flow.derivative, slope, direction), off)

        newton = iterate(self.map, step, guess)
        if not newton.converged:
            raise ComputationError("Newton's method lost the branch.", "no-convergence")
        return newton.z, newton.flow.derivative

    @staticmethod
    def tangent(derivative: np.ndarray, slope: np.ndarray, along: np.ndarray) -> np.ndarray:
        """Unit tangent of the branch, on the side of `along`."""
        tangent = np.linalg.solve(_bordered(derivative, slope, along), np.append(np.zeros(len(slope)), 1.0))
        return tangent / np.linalg.norm(tangent)


def _bordered(derivative: np.ndarray, slope: np.ndarray, border: np.ndarray) -> np.ndarray:
    """The matrix [[Φ_x − 1, Φ_ζ], [border]] (2N + 1, 2N + 1)."""
    return np.block([[derivative - np.eye(len(slope)), slope[:, None]], [border[None, :]]])


def critical(derivative: np.ndarray, kind: str, near: complex | None = None) -> tuple[float, complex]:
    """A smooth function that is 0 where the condition of `kind` is met, and the multiplier nearest to meeting it.

    The function is Π(μ − 1) for a fold and Π(μ + 1) for a period doubling, which remain smooth where pairs become real.
    For a Neimark–Sacker point it is |μ| − 1 of the critical pair: the one nearest to `near`, if given, otherwise to the
    unit circle.
    """
    multipliers = np.linalg.eigvals(derivative)
    if kind != "neimark_sacker":
        target = 1.0 if kind == "fold" else -1.0
        nearest = int(np.argmin(np.abs(multipliers - target)))
        return float(np.prod(multipliers - target).real), complex(multipliers[nearest])
    pairs = multipliers[np.abs(multipliers.imag) > _REAL_ANGLE]
    if len(pairs) == 0:
        raise ComputationError("The orbit has no complex multipliers, which a Neimark–Sacker point needs.", "no-point")
    away = np.abs(np.abs(pairs) - 1.0) if near is None else np.abs(pairs - complex(near.real, abs(near.imag)))
    nearest = int(np.argmin(np.where(pairs.imag > 0.0, away, np.inf)))
    return float(abs(pairs[nearest]) - 1.0), complex(pairs[nearest])


def _met(multiplier: complex, kind: str) -> bool:
    """Whether a critical multiplier meets the condition of `kind`."""
    away = abs(multiplier) - 1.0 if kind == "neimark_sacker" else multiplier - (1.0 if kind == "fold" else -1.0)
    return abs(away) <= _CONDITION_ERROR


def bifurcation_point(scene: Scene, kind: str, state: State | np.ndarray, period: int = 1, x: str = "f", y: str = "A0",
                      stop: Stop | None = None) -> BifurcationPoint:
    """Find the point of `kind` on the branch over knob x that is nearest to the orbit through `state`.

    `state` is at phase 0, in SI or as a scaled array (2N,) of displacements, then w. Raises `BadInput`, and
    `ComputationError` if there is no such point near.
    """
    _check(scene, kind, x, y)
    branch = KnobBranch(scene, x, value_of(scene, x), period, stop)
    stroboscopic_map = StroboscopicMap(scene, period, stop)
    inner = (state if isinstance(state, np.ndarray)
             else stroboscopic_map.inner(stroboscopic_map.engine.scaled.from_si(state)))
    along = np.append(np.zeros(len(inner)), 1.0)
    return nearest_point(branch, kind, np.append(inner, 1.0), along, y)


def value_of(scene: Scene, knob: str) -> float:
    """The numerical value of a knob; for the wall, which may be given by name, its stiffness factor."""
    return scene.wall_factor if knob == "wall" else float(scene.knobs[knob])


def _check(scene: Scene, kind: str, x: str, y: str) -> None:
    if kind not in BIFURCATIONS:
        raise unknown_name("kind of bifurcation curve", kind, BIFURCATIONS)
    for knob in (x, y):
        if knob not in KNOBS:
            raise unknown_name("knob of a bifurcation curve", knob, KNOBS)
        if not value_of(scene, knob) > 0.0:
            raise BadInput(f"A bifurcation curve over {knob} must begin at a value above 0; set {knob} in the scene.")
    if x == y:
        raise BadInput(f"Both knobs are {x}; give two different ones.")


def nearest_point(branch: KnobBranch, kind: str, guess: np.ndarray, along: np.ndarray, y: str) -> BifurcationPoint:
    """Find the branch's point at which the condition is met, by secants from a guess (2N + 1,) along `along`."""
    try:
        slope = branch.slope(guess)
        before, derivative = branch.solve(guess, along, slope)
        condition, mu = critical(derivative, kind, branch.near)
        step = _FIRST_ARC * float(np.linalg.norm(before)) * branch.tangent(derivative, slope, along)
        for _ in range(_MOST_SECANTS):
            if _met(mu, kind):
                return BifurcationPoint(float(before[-1]) * branch.unit, value_of(branch.scene, y), mu, before[:-1])
            X, condition_ahead, mu = _advanced(branch, kind, before, step, slope)
            gain = condition - condition_ahead
            factor = condition_ahead / gain if gain != 0.0 else _LONGEST_SECANT
            step = (X - before) * float(np.clip(factor, -_LONGEST_SECANT, _LONGEST_SECANT))
            before, condition = X, condition_ahead
    except (np.linalg.LinAlgError, BadInput) as problem:
        raise ComputationError(f"The branch could not be followed: {problem}.", "no-convergence") from None
    raise ComputationError(f"No {kind.replace('_', ' ')} was found on this branch near {branch.knob} = "
                           f"{guess[-1] * branch.unit:g}; start from an orbit nearer to it.", "no-point")


def _advanced(branch: KnobBranch, kind: str, before: np.ndarray, step: np.ndarray,
              slope: np.ndarray) -> tuple[np.ndarray, float, complex]:
    """The branch's point one step further, its condition and multiplier; a step that fails is halved."""
    shorter = step
    for _ in range(_MOST_HALVINGS):
        try:
            X, derivative = branch.solve(before + shorter, shorter / np.linalg.norm(shorter), slope)
            return X, *critical(derivative, kind, branch.near)
        except ComputationError:
            shorter = 0.5 * shorter
    raise ComputationError("Newton's method lost the branch.", "no-convergence")
