"""Bifurcation curves in the plane of two knobs: loci of folds, period doublings and Neimark–Sacker points.

The curves bound regions of stability only where no other multiplier is outside the unit circle. On a curve the orbit's
critical multiplier meets its condition:

    fold             μ = +1
    period_doubling  μ = −1
    neimark_sacker   |μ| = 1, μ not real

Each point is found at a fixed second knob y: the orbit's branch over the first knob x is a curve in (state, x) with
arclength s, on which Newton's method solves map(state, x) = state bordered by the arclength condition, so that folds
need no special treatment; the root of the condition along s is found by secants. From one y to the next the curve is
extrapolated, with steps that are halved where that fails.

docs/parameter-map.md says why Newton's method is that of a single orbit (orbits/damped_newton.py), not that of
orbits/branch.

Source: Kuznetsov 2004, chapter 10.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from ..errors import BadInput, Cancelled, ComputationError
from ..execution.stop import Stop
from ..inputs.checks import unknown_name
from ..orbits.branch.special import BIFURCATIONS
from ..orbits.damped_newton import iterate
from ..orbits.stroboscopic_map import MULTIPLIER_ERROR, Flow, StroboscopicMap
from ..parameter_maps.grid import KNOBS
from ..scene import Scene
from ..scene.hertz import RATE_POWER
from ..scene.quantities import QUANTITIES
from ..scene.state import State

#: Error of a multiplier: the critical one meets its condition to this.
_CONDITION_ERROR = MULTIPLIER_ERROR
#: Relative change of a knob for its difference quotient; the map is smooth to 1e-12.
_DIFFERENCE = 1e-6
#: First step along a branch, relative to the state and the knob.
_FIRST_ARC = 1e-3
#: Longest secant step, in units of the last step.
_LONGEST_SECANT = 6.0
#: Secant steps at most.
_MOST_SECANTS = 14
#: Halvings of a step at most, where the branch is lost.
_MOST_HALVINGS = 3
#: Smallest fraction of the way to the next y that is tried as one step.
_LEAST_FRACTION = 1.0 / 32.0
#: Largest change of the critical multiplier's angle [rad] and relative change of the first knob in one step; a point
#: beyond either is on another curve. Both are chosen, not measured: a step that is refused is halved, down to
#: `_LEAST_FRACTION`, so smaller ones cost time, and larger ones may take a neighbouring curve for this one.
_LARGEST_TURN, _LARGEST_JUMP = 0.15, 0.25
#: Angle from +1 or −1 below which a critical pair is not distinguished from a real multiplier [rad].
_REAL_ANGLE = 1e-7

#: Why a curve ends: the last value asked for, and the three ways in which it is lost, in words.
REACHED, BRANCH_LOST, MULTIPLIER_LOST, ANOTHER_CURVE = CURVE_ENDS = (
    "reached", "branch lost", "multiplier lost", "another curve")
END_WORDS = {
    REACHED: "the last value was reached",
    BRANCH_LOST: "Newton's method loses the branch, as where a curve turns back",
    MULTIPLIER_LOST: "no multiplier meets the condition any more",
    ANOTHER_CURVE: "the next point is on another curve",
}


@dataclass(frozen=True, eq=False)
class BifurcationPoint:
    """A point of a bifurcation curve: both knobs, the critical multiplier, and the orbit's scaled state at phase 0."""

    x: float
    y: float
    multiplier: complex
    state: np.ndarray


@dataclass(frozen=True, eq=False)
class _Branch:
    """Orbits of `periods` drive periods over the knob x; a point is X = (scaled state, x / unit), (2N + 1,).

    `near` is the critical multiplier of the point before, where there is one.
    """

    scene: Scene
    knob: str
    unit: float
    periods: int
    stop: Stop | None
    near: complex | None = None

    def at(self, ratio: float) -> Scene:
        """The scene at a point's last entry, x / unit."""
        return self.scene.evolve(**{self.knob: float(ratio) * self.unit})

    def map(self, X: np.ndarray) -> tuple[Flow, float]:
        """The map from X with its derivative (2N, 2N), and the residual."""
        if not np.isfinite(X).all() or X[-1] <= 0.0:
            raise ComputationError("Newton's method left the range of the knob.", "no-convergence")
        stroboscopic_map = StroboscopicMap(self.at(X[-1]), self.periods, self.stop)
        flow = stroboscopic_map(X[:-1])
        return flow, stroboscopic_map.residual(flow.end, X[:-1])

    def slope(self, X: np.ndarray) -> np.ndarray:
        """Derivative of the map's end by the knob, (2N,)."""
        ends = [StroboscopicMap(self.at(X[-1] * (1.0 + sign * _DIFFERENCE)), self.periods, self.stop).end(X[:-1])
                for sign in (1.0, -1.0)]
        return np.asarray((ends[0] - ends[1]) / (2.0 * _DIFFERENCE * X[-1]))

    def solve(self, guess: np.ndarray, direction: np.ndarray, slope: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The orbit on the plane through `guess` across `direction`, with the map's derivative there.

        `slope` may be that of a point near by: it only steers the iterations.
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
    """The matrix [[P_x − 1, P_p], [border]] (2N + 1, 2N + 1)."""
    return np.block([[derivative - np.eye(len(slope)), slope[:, None]], [border[None, :]]])


def critical(derivative: np.ndarray, kind: str, near: complex | None = None) -> tuple[float, complex]:
    """A smooth function that is 0 where `kind` is met, and the multiplier nearest to meeting it.

    Π(μ − 1) for a fold and Π(μ + 1) for a period doubling, which stay smooth where pairs become real; |μ| − 1 of
    the critical pair for Neimark–Sacker, which is the one nearest to `near`, else to the unit circle.
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
    """Whether a critical multiplier is where it has to be."""
    away = abs(multiplier) - 1.0 if kind == "neimark_sacker" else multiplier - (1.0 if kind == "fold" else -1.0)
    return abs(away) <= _CONDITION_ERROR


def bifurcation_point(scene: Scene, kind: str, state: State | np.ndarray, period: int = 1, x: str = "f", y: str = "A0",
                      stop: Stop | None = None) -> BifurcationPoint:
    """The point of `kind` on the branch over knob x nearest to an orbit through `state`.

    `state` is at phase 0, in SI or scaled (2N,) of displacements, then w. Raises `BadInput`, and `ComputationError`
    where there is none near.
    """
    _check(scene, kind, x, y)
    branch = _Branch(scene, x, value_of(scene, x), period, stop)
    stroboscopic_map = StroboscopicMap(scene, period, stop)
    inner = (state if isinstance(state, np.ndarray)
             else stroboscopic_map.inner(stroboscopic_map.engine.scaled.from_si(state)))
    along = np.append(np.zeros(len(inner)), 1.0)
    return _nearest(branch, kind, np.append(inner, 1.0), along, y)


def value_of(scene: Scene, knob: str) -> float:
    """The number that a knob stands at; of the wall, which may be named, its stiffness factor."""
    return scene.wall_factor if knob == "wall" else float(scene.knobs[knob])


def _check(scene: Scene, kind: str, x: str, y: str) -> None:
    if kind not in BIFURCATIONS:
        raise unknown_name("kind of bifurcation curve", kind, BIFURCATIONS)
    for knob in (x, y):
        if knob not in KNOBS:
            raise unknown_name("knob of a bifurcation curve", knob, KNOBS)
        if not value_of(scene, knob) > 0.0:
            raise BadInput(f"A bifurcation curve over {knob} begins at a value above 0; give the scene one.")
    if x == y:
        raise BadInput(f"Both knobs are {x}; give two distinct ones.")


def _nearest(branch: _Branch, kind: str, guess: np.ndarray, along: np.ndarray, y: str) -> BifurcationPoint:
    """Go along the branch by secants until the condition is met."""
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


def _advanced(branch: _Branch, kind: str, before: np.ndarray, step: np.ndarray,
              slope: np.ndarray) -> tuple[np.ndarray, float, complex]:
    """The point of the branch one step further, with its condition; a step that fails is halved."""
    shorter = step
    for _ in range(_MOST_HALVINGS):
        try:
            X, derivative = branch.solve(before + shorter, shorter / np.linalg.norm(shorter), slope)
            return X, *critical(derivative, kind, branch.near)
        except ComputationError:
            shorter = 0.5 * shorter
    raise ComputationError("Newton's method lost the branch.", "no-convergence")


def points_of_curve(scene: Scene, kind: str, state: State | np.ndarray, values: Iterable[float], period: int = 1,
                    x: str = "f", y: str = "A0", stop: Stop | None = None,
                    on_point: Callable[[BifurcationPoint], None] | None = None) -> list[BifurcationPoint]:
    """The curve of `kind` through the point near the orbit `state` of `scene`, at the `values` of knob y.

    It is followed to both sides of the scene's own y, as far as it goes: where the branch or the critical multiplier is
    lost the curve ends, and points beyond that are left out. Points come back in ascending y, that at the scene's own y
    included. Raises `BadInput`, `Cancelled`, and `ComputationError` where there is no such point to begin with.
    """
    return follow_curve(scene, kind, state, values, period, x, y, stop, on_point)[0]


def follow_curve(scene: Scene, kind: str, state: State | np.ndarray, values: Iterable[float], period: int = 1,
                 x: str = "f", y: str = "A0", stop: Stop | None = None,
                 on_point: Callable[[BifurcationPoint], None] | None = None
                 ) -> tuple[list[BifurcationPoint], str, str]:
    """`points_of_curve`, and why the curve ends at its least and at its largest y, each one of `CURVE_ENDS`."""
    first = bifurcation_point(scene, kind, state, period, x, y, stop)
    wanted = sorted({float(QUANTITIES[y].check(value)) for value in values} - {first.y})
    listed = [first]
    if on_point is not None:
        on_point(first)
    ends = []
    for side in ([v for v in reversed(wanted) if v < first.y], [v for v in wanted if v > first.y]):
        points, ended = [first], REACHED
        for value in side:
            if stop:
                raise Cancelled
            following = _follow(scene, kind, points, value, period, x, y, stop)
            if isinstance(following, str):
                ended = following
                break
            points.append(following)
            if on_point is not None:
                on_point(following)
        listed += points[1:]
        ends.append(ended)
    return sorted(listed, key=lambda point: point.y), ends[0], ends[1]


def _follow(scene: Scene, kind: str, points: list[BifurcationPoint], value: float, period: int, x: str, y: str,
            stop: Stop | None) -> BifurcationPoint | str:
    """The curve's point at y = `value`, by smaller steps where one is too large; the reason where the curve ends."""
    last_two, part = points[-2:], 1.0
    distance = abs(value - last_two[-1].y)
    while last_two[-1].y != value:
        y_now = last_two[-1].y
        end = value if abs(value - y_now) <= part * distance else y_now + part * (value - points[-1].y)
        following = _stepped(scene, kind, last_two, end, period, x, y, stop)
        if isinstance(following, BifurcationPoint):
            last_two = [last_two[-1], following]
            continue
        part *= 0.5
        if part < _LEAST_FRACTION:
            return following
    return last_two[-1]


def _stepped(scene: Scene, kind: str, last_two: list[BifurcationPoint], end: float, period: int, x: str, y: str,
             stop: Stop | None) -> BifurcationPoint | str:
    """The point at y = `end` by one step from the last two; the reason if no point continues the curve smoothly."""
    guess, state = _extrapolated(last_two, end, x, y)
    try:
        branch = _Branch(scene.evolve(**{x: guess, y: end}), x, guess, period, stop, last_two[-1].multiplier)
        along = _inwards(branch, state) if kind == "fold" else np.append(np.zeros(len(state)), 1.0)
        point = _nearest(branch, kind, np.append(state, 1.0), along, y)
    except ComputationError as problem:
        return MULTIPLIER_LOST if problem.status == "no-point" else BRANCH_LOST
    except BadInput:
        return BRANCH_LOST
    return point if _continues(last_two[-1], point) else ANOTHER_CURVE


def _inwards(branch: _Branch, state: np.ndarray) -> np.ndarray:
    """The direction (2N + 1,) of state and knob along which a branch passes its fold, from the fold's state (2N,).

    It is the null vector of the map's derivative less one; the knob does not change along it.
    """
    flow, _ = branch.map(np.append(state, 1.0))
    _, _, rows = np.linalg.svd(flow.derivative - np.eye(len(state)))
    return np.append(rows[-1], 0.0)


def _extrapolated(last_two: list[BifurcationPoint], y: float, x_knob: str, y_knob: str) -> tuple[float, np.ndarray]:
    """Knob x and state at y: on the line through the last two points; from one alone by f ∝ A0^{1/4}, else unchanged.

    (A0, f) → (s A0, s^{1/4} f) leaves the scaled orbit unchanged where D and k go along, and nearly where they do not.
    The line is one in logarithms, but on the way to or from a knob that is 0.
    """
    if len(last_two) == 1:
        power = {("f", "A0"): RATE_POWER, ("A0", "f"): 1.0 / RATE_POWER}.get((x_knob, y_knob), 0.0)
        return last_two[0].x * (y / last_two[0].y) ** power if y > 0.0 else last_two[0].x, last_two[0].state
    a, b = last_two[-2:]
    if min(y, a.y, b.y) <= 0.0:
        part = (y - b.y) / (b.y - a.y)
        return float(b.x + part * (b.x - a.x)), b.state + part * (b.state - a.state)
    part = np.log(y / b.y) / np.log(b.y / a.y)
    return float(b.x * (b.x / a.x) ** part), b.state + part * (b.state - a.state)


def _continues(before: BifurcationPoint, after: BifurcationPoint) -> bool:
    """Whether the critical multiplier and the first knob continue smoothly: else the point is on another curve."""
    turned = abs(abs(np.angle(after.multiplier)) - abs(np.angle(before.multiplier)))
    return bool(turned <= _LARGEST_TURN and abs(after.x / before.x - 1.0) <= _LARGEST_JUMP)
