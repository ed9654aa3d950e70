"""An independent computation of the motion and of its largest forces: it integrates the paper's equations in (u, v),
and a step ends at every contact event. It shares no code with the kernels.

Method    Dormand–Prince 8(5,3); the mode of each contact is constant within a step: no force because it is open, the
          force of the law, or no force although it is closed (the law would pull, and tension is cut)
Events    zeros of the overlap and, if tension is cut, of K δ^{3/2} + g(δ) δ̇, searched for on the step's polynomial at
          nine places and at the turning points between them, so that a touch shorter than a step is found; the step is
          then repeated so that it ends there
Forces    of contact 0, of contact N, and of the latter's spring: the supremum over the recorded time, that is, the
          largest of the values at the ends of steps, of the maxima between them, and of the right limits where a
          contact closes (D δ̇ with the linear law)
Scales    length A0, time 1/φ, so that the equations have the coefficients of the paper's equation (2)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from granchain_core import Scene
from granchain_core.scene.state import State
from tools.fuzzing.laws import EXPONENT

from .events import OVERLAP, after, begin, first_event, missing
from .step import (
    FORCES,
    NET_FORCE,
    Law,
    between,
    fill,
    gap_and_rate_of,
    jit,
    largest_in,
    law_force,
    slope,
    take_step,
    workspace,
)

#: A step is at most this fraction of a period; it grows and shrinks at most by these factors, with this safety factor.
_LONGEST, _GROWS, _SHRINKS, _SAFETY = 1.0 / 16.0, 6.0, 0.2, 0.9
#: After a closing, the first step is this many times as long as the first step after the previous event.
_AGAIN = 3.0
#: The allowed error of each bead is `tolerance` times its largest value so far, or this fraction of the chain's if that
#: is larger.
_QUIET = 1e-4
#: The chain's largest values, which are zero at rest, count as at least this fraction of the driver's.
_START = 1e-3
#: Shortest step, as a fraction of a period.
_SHORTEST = 1e-22
_ROUNDING = 1e-16
#: Outcomes of a computation.
DONE, TOO_LONG, NOT_FINITE = 0, 1, 2
#: Counts of steps, rejected steps, events and closings; then the lengths of the next step, of the last step after an
#: event, and of usual ones.
_STEPS, _REFUSED, _EVENTS, _CLOSINGS, _NEXT, _BEHIND, _USUAL = range(7)
#: Most events in a row at one instant: contacts that keep opening and closing there cannot be computed in this way.
_MOST_AT_ONCE = 1000
#: Maximum number of closings that are recorded.
_MOST_CLOSINGS = 100_000


class TooLong(Exception):
    """Raised if there are more steps than allowed, or if contacts keep opening and closing at one instant."""


@jit
def _scales(law, y, tolerance, most, scale):
    """Set the error allowed in a step, never below the rounding error of overlaps and of a preload's forces."""
    n = y.size // 2
    static = max(law.static.max(), 0.0)
    force = law.stiffness.max() * static * np.sqrt(static)
    for row in range(2):
        largest = _START * law.beta if row == 1 else _START * min(1.0, law.beta)
        for j in range(row * n, row * n + n):
            most[j] = max(most[j], abs(y[j]))
            largest = max(largest, most[j])
        for j in range(row * n, row * n + n):
            scale[j] = tolerance * max(most[j], _QUIET * largest)
            scale[j] = max(scale[j], _ROUNDING * (static if row == 0 else force * law.inverse_mass[j - n]))


@jit
def _landed(law, mode, t, y, h, step, c, what):
    """Repeat the step so that the watched quantity of contact c is zero at its end; return its length and error."""
    error = 0.0
    for _ in range(5):
        error = take_step(law, mode, t, y, h, step)
        fill(law, mode, t, y, h, step)
        more = missing(law, mode, t, y, h, step.polynomial, step.end, c, what)
        if more == 0.0:
            break
        h += more
    else:
        error = take_step(law, mode, t, y, h, step)
        fill(law, mode, t, y, h, step)
    return h, error


@jit
def _pass(law, mode, y, c, what, time, t, counts, closings):
    """Set the mode of contact c after its event; a closing is recorded with the right limit of its force."""
    counts[_EVENTS] += 1
    mode[c] = after(law, mode, c, what)
    counts[_NEXT] = counts[_USUAL]
    if what == OVERLAP and mode[c] == NET_FORCE:
        counts[_NEXT] = min(counts[_USUAL], _AGAIN * counts[_BEHIND])
        _keep_closing(law, y, c, time, t, counts, closings)


@jit
def _keep_closing(law, y, c, time, t, counts, closings):
    at = int(counts[_CLOSINGS])
    if at < len(closings):
        gap, rate = gap_and_rate_of(law, t, y, c)
        closings[at, 0], closings[at, 1], closings[at, 2] = time + t, c, law_force(law, c, gap, rate)
        counts[_CLOSINGS] += 1


@jit
def _sample(y, t, h, step, rows, row, period, samples):
    """Store displacements at the sampling times within the step and return the row of the next one."""
    n = y.size // 2
    while row <= samples and period * row / samples <= t + h:
        x = (period * row / samples - t) / h
        for j in range(n):
            rows[row, j] = step.end[j] if x >= 1.0 else between(y, step.polynomial, j, x)
        row += 1
    return row


@jit
def one_period(law, step, mode, y, watched, time, tolerance, most_steps, most, counts, rows, maxima, closings):
    """Integrate one drive period from phase 0, and leave y and mode at its end. If `watched`, update `rows` (samples +
    1, N) and `maxima`.
    """
    period, t, row, samples = 2.0 * np.pi / law.beta, 0.0, 1, len(rows) - 1
    kept, behind, at_once = np.empty(y.size), False, 0
    while t < period * (1.0 - 1e-15):
        if counts[_STEPS] + counts[_REFUSED] > most_steps:
            return TOO_LONG
        whole = min(counts[_NEXT], _LONGEST * period)
        rest = period - t
        h = rest if rest < whole * (1.0 + 1e-9) else whole
        slope(law, mode, t, y, step.slopes[0])
        _scales(law, y, tolerance, most, step.scale)
        error, where = take_step(law, mode, t, y, h, step), 2.0
        if error <= 1.0:
            fill(law, mode, t, y, h, step)
            where, c, what = first_event(law, mode, t, y, step.scale, h, step.polynomial)
            if where <= 0.0:
                _pass(law, mode, y, c, what, time, t, counts, closings)
                behind, at_once = True, at_once + 1
                if at_once > _MOST_AT_ONCE:
                    return TOO_LONG
                continue
            if where <= 1.0:
                h, error = _landed(law, mode, t, y, where * h, step, c, what)
        if error > 1.0:
            counts[_REFUSED] += 1
            counts[_NEXT] = h * (max(_SHRINKS, _SAFETY * error**-0.125) if error < np.inf else _SHRINKS)
            if counts[_NEXT] < _SHORTEST * period:
                return NOT_FINITE
            continue
        counts[_STEPS] += 1
        at_once = 0
        if watched:
            largest_in(law, mode, t, y, h, step, maxima, kept)
            row = _sample(y, t, h, step, rows, row, period, samples)
        y[:] = step.end
        if where > 1.0:
            t = period if h == rest else t + h
            grown = h * (_GROWS if error == 0.0 else min(_GROWS, _SAFETY * error**-0.125))
            counts[_NEXT] = max(grown, whole if h == rest else 0.0)
        else:
            t += h
        if behind:
            counts[_BEHIND] = h
        behind = where <= 1.0
        counts[_USUAL] = max(h, 0.8 * counts[_USUAL])
        if where <= 1.0:
            _pass(law, mode, y, c, what, time, t, counts, closings)
    while watched and row <= samples:
        rows[row] = y[: rows.shape[1]]
        row += 1
    return DONE


@jit
def _motion(law, step, mode, y, periods, record, tolerance, most_steps, most, counts, rows, maxima, closings):
    """Run `periods` periods, then record `record` periods in `rows` (record, samples + 1, N)."""
    begin(law, mode, 0.0, y)
    counts[_NEXT] = counts[_USUAL] = counts[_BEHIND] = 1e-3
    period, spare = 2.0 * np.pi / law.beta, np.zeros((2, y.size // 2))
    for number in range(periods + record):
        if number == periods:
            maxima[:], counts[_CLOSINGS] = -np.inf, 0.0
            for c in range(mode.size if periods == 0 else 0):
                gap, rate = gap_and_rate_of(law, 0.0, y, c)
                if mode[c] == NET_FORCE and gap <= 0.0 and rate > 0.0:
                    _keep_closing(law, y, c, 0.0, 0.0, counts, closings)
        seen = rows[number - periods] if number >= periods else spare
        seen[0] = y[: y.size // 2]
        ended = one_period(law, step, mode, y, number >= periods, (number - periods) * period, tolerance, most_steps,
                           most, counts, seen, maxima, closings)
        if ended != DONE:
            return ended
    return DONE


@dataclass(frozen=True, eq=False)
class Located:
    """A recorded motion in SI units: the largest input, output and elastic output forces [N], the closings as (time
    [s], contact, right limit of its force [N]), displacements (rows, N) [m], the final state, and the cost.
    """

    maxima: np.ndarray
    closings: np.ndarray
    displacement: np.ndarray
    state: State
    steps: int
    events: int


@dataclass(frozen=True, eq=False)
class Scaled:
    """A scene's constants in scaled units, and the units of length [m], rate [1/s] and force [N]."""

    law: Law
    length: float
    rate: float
    force: float

    @classmethod
    def of(cls, scene: Scene) -> Scaled:
        """Scale the constants of a scene."""
        mass, length = scene.bead(1).mass, scene.A0
        rate = np.sqrt(scene.K * np.sqrt(length) / mass)
        power = round(4.0 * EXPONENT[scene.dissipation]) if scene.has_dissipation else 0
        strength = scene.D / (mass * rate) * (length / scene.reference_overlap) ** (power / 4.0) if scene.has_dissipation else 0.0
        law = Law(mass / scene.masses(), scene.contact_stiffness() / scene.K, scene.static_overlap() / length, strength, power,
                  scene.k / (scene.K * np.sqrt(length)), 2.0 * np.pi * scene.f / rate, scene.cuts_tension)
        return cls(law, length, float(rate), float(scene.K * length**1.5))

    def start(self, scene: Scene, state: State | None) -> np.ndarray:
        """Return scaled u and v (2N): those of the state, or rest with the scene's initial velocities."""
        y = np.zeros(2 * scene.N)
        if state is None:
            for number, speed in scene.start_velocity:
                y[scene.N + number - 1] = speed / (self.length * self.rate)
        else:
            y[: scene.N], y[scene.N :] = state.displacement / self.length, state.velocity / (self.length * self.rate)
        return y


def located(scene: Scene, periods: int, record: int, samples: int = 16, tolerance: float = 1e-12,
            state: State | None = None, most_steps: int = 5_000_000, gaps: np.ndarray | None = None) -> Located:
    """Compute the motion from rest (or initial velocities), or from `state` at phase 0: discard `periods` periods, then
    record `record` periods.

    `gaps` (N + 1,) [m] are those between bodies at their rest positions. Raises `TooLong`, or `FloatingPointError` if
    numbers are not finite.
    """
    scaled = Scaled.of(scene)
    y, mode = scaled.start(scene, state), np.zeros(scene.N + 1, np.int64)
    law = scaled.law if gaps is None else scaled.law._replace(static=scaled.law.static - gaps / scaled.length)
    counts, maxima = np.zeros(7), np.full(FORCES, -np.inf)
    closings, rows = np.zeros((_MOST_CLOSINGS, 3)), np.zeros((record, samples + 1, scene.N))
    ended = _motion(law, workspace(scene.N), mode, y, periods, record, tolerance, most_steps, np.zeros(2 * scene.N), counts, rows,
                    maxima, closings)
    if ended == TOO_LONG:
        raise TooLong
    if ended == NOT_FINITE:
        raise FloatingPointError(f"step below {_SHORTEST} periods")
    kept = closings[: int(counts[_CLOSINGS])] * (1.0 / scaled.rate, 1.0, scaled.force)
    out = np.concatenate([rows[0, :1], *rows[:, 1:]]) if record else np.zeros((0, scene.N))
    end = State(y[: scene.N] * scaled.length, y[scene.N :] * scaled.length * scaled.rate)
    return Located(maxima * scaled.force, kept, out * scaled.length, end, int(counts[_STEPS]), int(counts[_EVENTS]))
