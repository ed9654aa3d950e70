"""Bifurcation curves in the plane of two knobs: loci of folds, period doublings and Neimark–Sacker points.

The curves bound regions of stability only where no other multiplier is outside the unit circle. Each point is found at
a fixed value of the second knob y, on the orbit's branch over the first knob x (point.py). From one y to the next, the
curve is extrapolated, and a step that fails is halved.

Source: Kuznetsov 2004, chapter 10.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np

from ..errors import BadInput, Cancelled, ComputationError
from ..execution.stop import Stop
from ..scene import Scene
from ..scene.hertz import RATE_POWER
from ..scene.quantities import QUANTITIES
from ..scene.state import State
from .point import BifurcationPoint, KnobBranch, bifurcation_point, nearest_point

#: Smallest fraction of the way to the next y that is tried as one step.
_LEAST_FRACTION = 1.0 / 32.0
# Both limits are chosen, not measured: a step beyond them is rejected and halved, down to `_LEAST_FRACTION`. So smaller
# limits cost time, and with larger ones a point of a neighbouring curve may be mistaken for one of this curve.
#: Largest change of the critical multiplier's angle in one step [rad].
_LARGEST_TURN = 0.15
#: Largest relative change of the first knob in one step.
_LARGEST_JUMP = 0.25

#: Why a curve ends: it has reached the last requested value, or is lost in one of three ways.
REACHED, BRANCH_LOST, MULTIPLIER_LOST, ANOTHER_CURVE = CURVE_ENDS = (
    "reached", "branch lost", "multiplier lost", "another curve")
END_WORDS = {
    REACHED: "the last value was reached",
    BRANCH_LOST: "Newton's method loses the branch, as where a curve turns back",
    MULTIPLIER_LOST: "no multiplier meets the condition any more",
    ANOTHER_CURVE: "the next point is on another curve",
}


def points_of_curve(scene: Scene, kind: str, state: State | np.ndarray, values: Iterable[float], period: int = 1,
                    x: str = "f", y: str = "A0", stop: Stop | None = None,
                    on_point: Callable[[BifurcationPoint], None] | None = None) -> list[BifurcationPoint]:
    """Continue the curve of `kind` through the point near the orbit `state` of `scene`, to the `values` of knob y.

    The curve is continued to both sides of the scene's own y. It ends where the branch or the critical multiplier is
    lost; values beyond its ends have no point. The points are in ascending y and include the point at the scene's own
    y. Raises `BadInput`, `Cancelled`, and `ComputationError` if there is no such point at the scene's y.
    """
    return follow_curve(scene, kind, state, values, period, x, y, stop, on_point)[0]


def follow_curve(scene: Scene, kind: str, state: State | np.ndarray, values: Iterable[float], period: int = 1,
                 x: str = "f", y: str = "A0", stop: Stop | None = None,
                 on_point: Callable[[BifurcationPoint], None] | None = None
                 ) -> tuple[list[BifurcationPoint], str, str]:
    """Like `points_of_curve`; also return why the curve ends at its least and at its largest y, from `CURVE_ENDS`."""
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
    """The curve's point at y = `value`, by smaller steps if one is too large; the reason if the curve ends."""
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
        branch = KnobBranch(scene.evolve(**{x: guess, y: end}), x, guess, period, stop, last_two[-1].multiplier)
        along = _inwards(branch, state) if kind == "fold" else np.append(np.zeros(len(state)), 1.0)
        point = nearest_point(branch, kind, np.append(state, 1.0), along, y)
    except ComputationError as problem:
        return MULTIPLIER_LOST if problem.status == "no-point" else BRANCH_LOST
    except BadInput:
        return BRANCH_LOST
    return point if _continues(last_two[-1], point) else ANOTHER_CURVE


def _inwards(branch: KnobBranch, state: np.ndarray) -> np.ndarray:
    """The direction (2N + 1,) of state and knob along which a branch passes its fold, from the fold's state (2N,).

    It is the null vector of the map's derivative minus the identity; the knob does not change along it.
    """
    flow, _ = branch.map(np.append(state, 1.0))
    _, _, rows = np.linalg.svd(flow.derivative - np.eye(len(state)))
    return np.append(rows[-1], 0.0)


def _extrapolated(last_two: list[BifurcationPoint], y: float, x_knob: str, y_knob: str) -> tuple[float, np.ndarray]:
    """Knob x and state at y, on the line through the last two points, or from a single point.

    A single point gives f ∝ A0^{1/4} if the knobs are f and A0: (A0, f) → (s A0, s^{1/4} f) leaves the scaled orbit
    unchanged if D and k are scaled too, and almost unchanged if they are not. For other knobs, it gives its own x. The
    line is in logarithms, except to or from a knob value of 0.
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
    """Whether the critical multiplier and the first knob continue smoothly; otherwise the point is on another curve."""
    turned = abs(abs(np.angle(after.multiplier)) - abs(np.angle(before.multiplier)))
    return bool(turned <= _LARGEST_TURN and abs(after.x / before.x - 1.0) <= _LARGEST_JUMP)
