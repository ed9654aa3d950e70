"""An independent computation of the motion and of its largest forces: the paper's equations in (u, v), every contact
event landed on by a step of its own. It shares nothing with the kernels.

Method    Dormand–Prince 8(5,3); what acts in a contact is held fixed in a step: nothing, the law, or nothing although
          it touches (the law would pull, tension cut)
Events    the overlap's zero, and that of K δ^{3/2} + g(δ) δ̇ where tension is cut, looked for on the step's polynomial
          at nine places and at the turning points between them, so that a touch shorter than a step is seen; the step
          is then repeated to end there
Forces    of contact 0, of contact N, and of the latter's spring: the supremum over the recorded time, that is the
          largest of the values at steps' ends, of the maxima between them and of the right limits where a contact
          closes: D δ̇ with the linear law
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

#: A step is at most this part of a period. It grows and shrinks at most by these factors.
_LONGEST, _GROWS, _SHRINKS, _SAFETY = 1.0 / 16.0, 6.0, 0.2, 0.9
#: Behind an event a step begins so many times as long as the last such step was.
_AGAIN = 3.0
#: An error is allowed per body: `tolerance` times its largest value so far, no less than this part of the chain's.
_QUIET = 1e-4
#: The chain's largest values count as no less than these parts of the driver's: at rest they are zero.
_START = 1e-3
#: Shortest step, over a period's length.
_SHORTEST = 1e-22
_ROUNDING = 1e-16
#: How a computation ends.
DONE, TOO_LONG, NOT_FINITE = 0, 1, 2
#: What is counted: steps, refused steps, events and closings; then the lengths of the next step, of the last behind a
#: closing, and of usual ones.
_STEPS, _REFUSED, _EVENTS, _CLOSINGS, _NEXT, _BEHIND, _USUAL = range(7)
#: Most events in a row at one instant: contacts that change to and fro there have no truth in this computation.
_MOST_AT_ONCE = 1000
#: Most closings that are kept.
_MOST_CLOSINGS = 100_000


class TooLong(Exception):
    """More steps than allowed, or contacts that change to and fro at one instant."""


@jit
def _scales(law, y, tolerance, most, scale):
    """The error allowed in a step, never below what rounding makes of the overlaps and of a preload's forces."""
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
    """Repeat the step so that what is watched of contact c is zero at its end: its length and its error."""
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
    """What acts in contact c behind its event; a closing is kept with the right limit of its force."""
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
    """Displacements at the instants that lie in the step; the row of the next one."""
    n = y.size // 2
    while row <= samples and period * row / samples <= t + h:
        x = (period * row / samples - t) / h
        for j in range(n):
            rows[row, j] = step.end[j] if x >= 1.0 else between(y, step.polynomial, j, x)
        row += 1
    return row


@jit
def one_period(law, step, mode, y, watched, time, tolerance, most_steps, most, counts, rows, maxima, closings):
    """One drive period from phase 0, y and mode left at its end; where `watched`, `rows` (samples + 1, N) and `maxima`.
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
    """Run `periods` periods, then record `record`; rows (record, samples + 1, N)."""
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
    """A recorded motion in SI: the largest input, output and elastic output force [N], the closings in the recorded
    time as (time s, contact, right limit of its force N), displacements (rows, N) [m], the state at the end, and the
    cost.
    """

    maxima: np.ndarray
    closings: np.ndarray
    displacement: np.ndarray
    state: State
    steps: int
    events: int


@dataclass(frozen=True, eq=False)
class Scaled:
    """A scene's constants in scaled units and what they are measured in: m, 1/s, N."""

    law: Law
    length: float
    rate: float
    force: float

    @classmethod
    def of(cls, scene: Scene) -> Scaled:
        """The constants of a scene."""
        mass, length = scene.bead(1).mass, scene.A0
        rate = np.sqrt(scene.K * np.sqrt(length) / mass)
        power = round(4.0 * EXPONENT[scene.dissipation]) if scene.has_dissipation else 0
        strength = scene.D / (mass * rate) * (length / scene.reference_overlap) ** (power / 4.0) if scene.has_dissipation else 0.0
        law = Law(mass / scene.masses(), scene.contact_stiffness() / scene.K, scene.static_overlap() / length, strength, power,
                  scene.k / (scene.K * np.sqrt(length)), 2.0 * np.pi * scene.f / rate, scene.cuts_tension)
        return cls(law, length, float(rate), float(scene.K * length**1.5))

    def start(self, scene: Scene, state: State | None) -> np.ndarray:
        """u and v (2N): those of the state, or rest with the scene's initial velocities."""
        y = np.zeros(2 * scene.N)
        if state is None:
            for number, speed in scene.start_velocity:
                y[scene.N + number - 1] = speed / (self.length * self.rate)
        else:
            y[: scene.N], y[scene.N :] = state.displacement / self.length, state.velocity / (self.length * self.rate)
        return y


def located(scene: Scene, periods: int, record: int, samples: int = 16, tolerance: float = 1e-12,
            state: State | None = None, most_steps: int = 5_000_000, gaps: np.ndarray | None = None) -> Located:
    """The motion from rest (or initial velocities), or from `state` at phase 0: `periods` discarded, then `record`
    recorded.

    `gaps` (N + 1,) [m] are between bodies that are at their places. Raises `TooLong`, and `FloatingPointError` where
    the numbers are not finite.
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
