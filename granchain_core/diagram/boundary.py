"""Curves in the plane of two knobs on which an orbit loses its stability: folds, period doublings, Neimark–Sacker.

On such a curve the orbit's critical multiplier meets its condition:

    fold             μ = +1
    period_doubling  μ = −1
    neimark_sacker   |μ| = 1, μ not real

Each point is found at a fixed second knob y: the orbit's branch over the first knob x is a curve in (state, x) with
arclength s, on which Newton's method solves map(state, x) = state bordered by the arclength condition, so that a fold
is nothing special; the root of the condition along s is found by Illinois false position. From one y to the next the
curve is extrapolated, with steps that are halved where that fails.

Source: Kuznetsov, Elements of Applied Bifurcation Theory (2004), chapter 10.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from ..errors import BadInput, Cancelled, NumbersFailed, unknown_name
from ..integrate import State
from ..integrate.lane_block import scaled_state
from ..orbits.flow import StroboscopicMap
from ..quantities import QUANTITIES
from ..scene import Scene
from .grid import KNOBS

KINDS = ("fold", "period_doubling", "neimark_sacker")
#: The condition on the critical multiplier is met to this; the map's own tangents are good to about 1e-7.
_MET = 1e-6
#: Residual of an orbit, and Newton's iterations at most.
_CONVERGED, _ITERATIONS = 1e-10, 8
#: Relative change of a knob for its difference quotient; the map is smooth to 1e-12.
_DIFFERENCE = 1e-6
#: First step along a branch, relative to the state and the knob, by how much it grows, and how often it is tried.
_STEP, _GROWS, _TRIES = 2e-3, 1.6, 24
#: Steps of false position at most, and how often a step to the next y is halved.
_ROOT, _HALVINGS = 30, 6
#: Slower than this from +1 or −1 in angle a critical pair is not told from a real multiplier.
_REAL = 1e-7


@dataclass(frozen=True, eq=False)
class BoundaryPoint:
    """One point of a boundary: both knobs, the critical multiplier there, and the orbit's state at phase 0, scaled."""

    x: float
    y: float
    multiplier: complex
    state: np.ndarray


@dataclass(frozen=True, eq=False)
class _Branch:
    """Orbits of `periods` drive periods over the knob x; a point is X = (scaled state, x / x_unit), (2N + 1,)."""

    scene: Scene
    knob: str
    unit: float
    periods: int
    stop: np.ndarray | None

    def at(self, x: float) -> Scene:
        """The scene at a point's last entry."""
        return self.scene.evolve(**{self.knob: float(x) * self.unit})

    def map(self, X: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Where the map leads from X, and its derivative (2N, 2N)."""
        flow = StroboscopicMap(self.at(X[-1]), self.periods, self.stop)(X[:-1])
        return flow.end, flow.derivative

    def slope(self, X: np.ndarray) -> np.ndarray:
        """Derivative of the map's end by the knob, (2N,)."""
        ends = [self.map(np.append(X[:-1], X[-1] * (1.0 + sign * _DIFFERENCE)))[0] for sign in (1.0, -1.0)]
        return (ends[0] - ends[1]) / (2.0 * _DIFFERENCE * X[-1])

    def solve(self, guess: np.ndarray, direction: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The orbit on the plane through `guess` across `direction`, with the map's derivative there."""
        X, slope = guess.copy(), None
        for _ in range(_ITERATIONS):
            end, derivative = self.map(X)
            off = np.append(end - X[:-1], direction @ (X - guess))
            if np.abs(off).max() <= _CONVERGED * max(1.0, float(np.abs(X[:-1]).max())):
                return X, derivative
            slope = self.slope(X) if slope is None else slope
            matrix = np.block([[derivative - np.eye(len(end)), slope[:, None]], [direction[None, :]]])
            X = X - np.linalg.solve(matrix, off)
            if not np.isfinite(X).all() or X[-1] <= 0.0:
                break
        raise NumbersFailed("Newton's method lost the branch.", "no-convergence")

    def tangent(self, X: np.ndarray, derivative: np.ndarray, along: np.ndarray) -> np.ndarray:
        """Unit tangent of the branch, on the side of `along`."""
        matrix = np.block([[derivative - np.eye(len(X) - 1), self.slope(X)[:, None]], [along[None, :]]])
        tangent = np.linalg.solve(matrix, np.append(np.zeros(len(X) - 1), 1.0))
        return tangent / np.linalg.norm(tangent)


def critical(derivative: np.ndarray, kind: str) -> tuple[float, complex]:
    """The condition of `kind` and the multiplier that is nearest to meeting it."""
    multipliers = np.linalg.eigvals(derivative)
    real = np.abs(multipliers.imag) <= _REAL
    if kind == "neimark_sacker":
        chosen = multipliers[~real]
        distance = np.abs(chosen) - 1.0
    else:
        chosen = multipliers[real]
        distance = chosen.real - (1.0 if kind == "fold" else -1.0)
    if len(chosen) == 0:
        raise NumbersFailed(f"The orbit has no multiplier that could meet a {kind.replace('_', ' ')}.", "no-point")
    nearest = int(np.argmin(np.abs(distance)))
    return float(distance[nearest]), complex(chosen[nearest])


def boundary_point(scene: Scene, kind: str, state: State | np.ndarray, period: int = 1, x: str = "f", y: str = "A0",
                   stop: np.ndarray | None = None) -> BoundaryPoint:
    """The point of `kind` on the branch over knob x nearest to an orbit through `state`.

    `state` is at phase 0, in SI or scaled (2N,) of displacements, then w. Raises `BadInput`, and `NumbersFailed` where
    there is none near.
    """
    _check(scene, kind, x, y)
    branch = _Branch(scene, x, float(scene.knobs[x]), period, stop)
    strobe = StroboscopicMap(scene, period, stop)
    inner = state if isinstance(state, np.ndarray) else strobe.inner(scaled_state(strobe.engine.lowered, state))
    along = np.append(np.zeros(len(inner)), 1.0)
    return _nearest(branch, kind, np.append(inner, 1.0), along, y)


def _check(scene: Scene, kind: str, x: str, y: str) -> None:
    if kind not in KINDS:
        raise unknown_name("kind of boundary", kind, KINDS)
    for knob in (x, y):
        if knob not in KNOBS:
            raise unknown_name("knob for a boundary", knob, KNOBS)
        if not float(scene.knobs[knob] if knob != "wall" else scene.wall_factor) > 0.0:
            raise BadInput(f"A boundary over {knob} begins at a value above 0; give the scene one.")
    if x == y:
        raise BadInput(f"Both knobs are {x}; give two distinct ones.")


def _nearest(branch: _Branch, kind: str, guess: np.ndarray, along: np.ndarray, y: str) -> BoundaryPoint:
    """Step along the branch to both sides until the condition changes sign, then find its root."""
    try:
        start, derivative = branch.solve(guess, along)
        condition, _ = critical(derivative, kind)
        tangent = branch.tangent(start, derivative, along)
        bracket = _bracketed(branch, kind, start, condition, tangent)
        X, mu = _root(branch, kind, *bracket)
    except (np.linalg.LinAlgError, BadInput) as problem:
        raise NumbersFailed(f"The branch could not be followed: {problem}.", "no-convergence") from None
    return BoundaryPoint(float(X[-1]) * branch.unit, float(branch.scene.knobs[y]), mu, X[:-1])


def _bracketed(branch: _Branch, kind: str, start: np.ndarray, condition: float,
               tangent: np.ndarray) -> tuple[np.ndarray, float, np.ndarray, float]:
    """Two points of the branch between which the condition changes sign; the side on which it shrinks comes first."""
    if abs(condition) <= _MET:
        return start, condition, start, condition
    size = _STEP * max(1.0, float(np.linalg.norm(start)))
    sides = [(start, condition, sign * tangent) for sign in (1.0, -1.0)]
    for attempt in range(_TRIES):
        length = size * _GROWS ** (attempt // 2)
        before, value, direction = sides[attempt % 2]
        try:
            X, derivative = branch.solve(before + length * direction, direction)
            there, _ = critical(derivative, kind)
        except NumbersFailed:
            continue
        if (there > 0.0) != (value > 0.0) and abs(there - value) < 0.5:
            return before, value, X, there
        sides[attempt % 2] = X, there, branch.tangent(X, derivative, direction)
    raise NumbersFailed(f"No {kind.replace('_', ' ')} was found on this branch near {branch.knob} = "
                        f"{start[-1] * branch.unit:g}; give an orbit nearer to it.", "no-point")


def _root(branch: _Branch, kind: str, a: np.ndarray, at_a: float, b: np.ndarray,
          at_b: float) -> tuple[np.ndarray, complex]:
    """Where the condition is met between two points of the branch (Illinois false position)."""
    for _ in range(_ROOT):
        part = 0.5 if at_a == at_b else at_a / (at_a - at_b)
        chord = b - a
        length = float(np.linalg.norm(chord))
        direction = chord / length if length > 0.0 else np.append(np.zeros(len(a) - 1), 1.0)
        X, derivative = branch.solve(a + part * chord, direction)
        there, mu = critical(derivative, kind)
        if abs(there) <= _MET:
            return X, mu
        if (there > 0.0) == (at_b > 0.0):
            b, at_b, at_a = X, there, 0.5 * at_a
        else:
            a, at_a, b, at_b = b, at_b, X, there
    raise NumbersFailed(f"The {kind.replace('_', ' ')} near {branch.knob} = {a[-1] * branch.unit:g} is not sharp.",
                        "no-convergence")


def boundary_curves(scene: Scene, kind: str, state: State | np.ndarray, values: Iterable[float], period: int = 1,
                    x: str = "f", y: str = "A0", stop: np.ndarray | None = None,
                    on_point: Callable[[BoundaryPoint], None] | None = None) -> list[BoundaryPoint]:
    """The curve of `kind` through the point near the orbit `state` of `scene`, at the `values` of knob y.

    It is followed to both sides of the scene's own y, as far as it goes: where the branch or the critical multiplier is
    lost the curve ends, and points behind that are left out. Points come back in ascending y, that at the scene's own y
    included. Raises `BadInput`, `Cancelled`, and `NumbersFailed` where there is no such point to begin with.
    """
    first = boundary_point(scene, kind, state, period, x, y, stop)
    wanted = sorted({float(QUANTITIES[y].check(value)) for value in values} - {first.y})
    found = [first]
    if on_point is not None:
        on_point(first)
    for side in ([v for v in wanted if v > first.y], [v for v in reversed(wanted) if v < first.y]):
        points = [first]
        for value in side:
            if stop is not None and stop[0]:
                raise Cancelled
            following = _follow(scene, kind, points, value, period, x, y, stop)
            if following is None:
                break
            points.append(following)
            if on_point is not None:
                on_point(following)
        found += points[1:]
    return sorted(found, key=lambda point: point.y)


def _follow(scene: Scene, kind: str, points: list[BoundaryPoint], value: float, period: int, x: str, y: str,
            stop: np.ndarray | None) -> BoundaryPoint | None:
    """The curve's point at y = `value`, by smaller steps where one is too large; None where the curve ends."""
    path = points[-2:]
    for halving in range(_HALVINGS):
        way, ends = path.copy(), np.linspace(path[-1].y, value, 2**halving + 1)[1:]
        try:
            for end in ends:
                x_guess, state = _extrapolated(way, float(end))
                here = scene.evolve(**{x: x_guess, y: float(end)})
                branch = _Branch(here, x, x_guess, period, stop)
                along = np.append(np.zeros(len(state)), 1.0) if kind != "fold" else _inwards(branch, state)
                way.append(_nearest(branch, kind, np.append(state, 1.0), along, y))
        except (NumbersFailed, BadInput):
            continue
        if _continues(way):
            return way[-1]
    return None


def _inwards(branch: _Branch, state: np.ndarray) -> np.ndarray:
    """The direction along which a branch passes its fold: the null vector of the map's derivative less one."""
    _, derivative = branch.map(np.append(state, 1.0))
    _, _, rows = np.linalg.svd(derivative - np.eye(len(state)))
    return np.append(rows[-1], 0.0)


def _extrapolated(way: list[BoundaryPoint], y: float) -> tuple[float, np.ndarray]:
    if len(way) == 1:
        return way[0].x, way[0].state
    a, b = way[-2:]
    part = (y - b.y) / (b.y - a.y)
    return b.x + part * (b.x - a.x), b.state + part * (b.state - a.state)


def _continues(way: list[BoundaryPoint]) -> bool:
    """Whether the critical multiplier and the first knob go on evenly: else it is another curve that was met."""
    for before, after in itertools.pairwise(way):
        if abs(abs(np.angle(after.multiplier)) - abs(np.angle(before.multiplier))) > 0.3:
            return False
        if abs(after.x / before.x - 1.0) > 0.25 * max(0.2, abs(after.y / before.y - 1.0)):
            return False
    return True
