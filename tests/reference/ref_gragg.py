"""Method B: extrapolated modified midpoint rule (Gragg, Bulirsch, Stoer) on the (u, v) equations in long double.

It shares the scaled parameters and the bookkeeping of contact states with method A, but not the force evaluation, the
integrator or the dense solution: a step is repeated with different lengths until it ends on the event.  After an onset,
the independent variable is s with t = t0 + s^p, so that d^{3/2} is smooth.  Before a release, the step shrinks under
error control.
"""

from dataclasses import dataclass

import numpy as np
from ref_events import PRESSED, Contacts, Event, Flow, first_event
from ref_scene import LD, PI, SAMPLES, Array, Model, driver
from ref_taylor import Counters

ROUNDING = LD(2e-18)


@dataclass(frozen=True)
class GraggSettings:
    """Columns of the extrapolation (order twice that), tolerance and first-touch threshold."""

    columns: int = 9
    tol: float = 1e-17
    touch: float = 1e-17
    points: int = 4


class Piece:
    """The equations between two events, in s: t = t0 + s^p."""

    def __init__(self, model: Model, contacts: Contacts, phase: LD) -> None:
        """Freeze the set of pressed contacts and the drive phase at s = 0."""
        self.model, self.phase = model, phase
        self.p = model.root if contacts.fresh >= 0 else 1
        self.pressed = (contacts.state == PRESSED).astype(LD)
        self.strength = model.strength * self.pressed
        self.lam = model.lam * self.pressed

    def bodies(self, y: Array, s: Array) -> tuple[Array, Array]:
        """Return displacement and velocity of driver, beads and wall for states y (rows) at s (column)."""
        n = self.model.beads
        x, v = (np.zeros((y.shape[0], n + 2), dtype=LD) for _ in range(2))
        x[:, 1:-1], v[:, 1:-1] = y[:, :n], y[:, n:]
        x[:, 0], v[:, 0] = driver(self.model, self.phase + self.model.beta * s[:, 0] ** self.p)
        return x, v

    def slope(self, y: Array, s: Array) -> Array:
        """Return dy/ds."""
        x, v = self.bodies(y, s)
        force = self.force(x[:, :-1] - x[:, 1:] + self.model.static, v[:, :-1] - v[:, 1:])
        a = force[:, :-1] - force[:, 1:] - self.model.kappa * x[:, 1:-1]
        return np.concatenate([v[:, 1:-1], a], axis=1) * (self.p * s ** (self.p - 1))

    def force(self, d: Array, rate: Array) -> Array:
        """Return the force of every contact from its overlap and overlap rate."""
        depth = np.sqrt(np.where(d > 0, d, LD(0)))
        elastic = self.strength * depth * depth * depth
        if self.model.exponent == 0:
            return elastic + self.lam * rate
        if self.model.exponent == LD(0.25):
            return elastic + self.lam * np.sqrt(depth) * rate
        return elastic + self.lam * depth * rate


class Extrapolation:
    """One extrapolated step with all midpoint sequences side by side."""

    def __init__(self, columns: int) -> None:
        """Prepare sequences of 2J, ..., 4, 2 substeps."""
        self.counts = 2 * np.arange(columns, 0, -1)
        self.parts = self.counts[:, None].astype(LD)

    def step(self, piece: Piece, y: Array, s: LD, h: LD) -> tuple[Array, LD, Array]:
        """Return the state at s + h, its error estimate, and the coarse states along the finest sequence."""
        width = h / self.parts
        old = np.repeat(y[None, :], self.counts.size, axis=0)
        start = np.full((1, 1), s)
        now = old + width * piece.slope(y[None, :], start)
        ends = np.empty_like(old)
        path = []
        for m in range(1, int(self.counts[0])):
            live = int(np.count_nonzero(self.counts > m))
            rate = piece.slope(now[:live], s + m * width[:live])
            old, now = now[:live], old[:live] + 2 * width[:live] * rate
            done = self.counts[:live] == m + 1
            ends[:live][done] = now[done]
            if m % 2:
                path.append(now[0])
        value, error = self.extrapolate(ends[::-1], self.counts[::-1].astype(LD))
        return value, error, np.array(path)

    @staticmethod
    def extrapolate(rows: Array, counts: Array) -> tuple[Array, LD]:
        """Extrapolate by Aitken-Neville in the squared substep; the error is the change in the last column."""
        table = rows
        for k in range(1, counts.size):
            ratio = (counts[k:] / counts[:-k]) ** 2 - 1
            previous = table
            table = table[1:] + (table[1:] - table[:-1]) / ratio[:, None]
        return table[-1], np.max(np.abs(table[-1] - previous[-1]))


class Walker:
    """Carries a state through pieces and events."""

    def __init__(self, model: Model, settings: GraggSettings) -> None:
        """Start at rest at t = 0."""
        self.model, self.settings = model, settings
        self.rule = Extrapolation(settings.columns)
        self.contacts, self.count = Contacts.at_rest(model, settings.touch), Counters()
        self.y, self.h = np.zeros(2 * model.beads, dtype=LD), LD(1e-3)

    def interval(self, start: LD) -> None:
        """Advance by one sampling interval, which begins at the drive phase `start`."""
        done = LD(0)
        while done < self.model.interval:
            piece = Piece(self.model, self.contacts, start + self.model.beta * done)
            done += self.run(piece, self.model.interval - done)

    def run(self, piece: Piece, room: LD) -> LD:
        """Advance until the next event or until `room` is used up; return the time advanced."""
        s, end = LD(0), room ** (LD(1) / piece.p)
        while s < end:
            h = min(self.h, end - s)
            y, error, path = self.rule.step(piece, self.y, s, h)
            if not error <= self.settings.tol:
                self.h = h * self.factor(error, LD(0.5))
                continue
            event = self.event(piece, s, h, y, path)
            self.contacts.apply(event)
            self.count.steps += 1
            if event is not None:
                self.y = self.rule.step(piece, self.y, s, event.where)[0]
                self.count.events += 1
                self.h = LD(0.01)
                return (s + event.where) ** piece.p
            self.y, s = y, end if h == end - s else s + h
            self.h = max(self.h if h < self.h else LD(0), h * self.factor(error, LD(4)))
        return room

    def factor(self, error: LD, most: LD) -> LD:
        """Return the factor that adapts the step to the tolerance; errors near round-off do not limit the step."""
        if not np.isfinite(error):
            return LD(0.1)
        if error < ROUNDING:
            return most
        power = LD(1) / (2 * self.settings.columns - 1)
        return LD(min(most, max(LD(0.1), LD(0.8) * (LD(self.settings.tol) / error) ** power)))

    def event(self, piece: Piece, s: LD, h: LD, y: Array, path: Array) -> Event | None:
        """Return the first event in an accepted step: a coarse check, then exact sub-steps if there may be one."""
        coarse = np.concatenate([self.y[None, :], path[:-1], y[None, :]])
        places = h * np.arange(coarse.shape[0], dtype=LD) / (coarse.shape[0] - 1)
        look = Flow(self.model, lambda _: piece.bodies(coarse, s + places[:, None]), places)
        leave, slope, press = look.signals(places, self.contacts)
        turning = (slope[:-1] > 0) & (slope[1:] < 0)
        if not (np.any(leave[1:] > 0) or np.any(press[1:] > 0) or np.any(turning)):
            return None
        grid = np.arange(1, self.settings.points + 1, dtype=LD) / self.settings.points
        return first_event(Flow(self.model, lambda w: self.dense(piece, s, w), grid * h), self.contacts)

    def dense(self, piece: Piece, s: LD, offsets: Array) -> tuple[Array, Array]:
        """Return exact states at some offsets, each from a separate step."""
        rows = np.array([self.y if w == 0 else self.rule.step(piece, self.y, s, w)[0] for w in offsets])
        return piece.bodies(rows, s + offsets[:, None])


def integrate(model: Model, periods: int, settings: GraggSettings) -> tuple[Array, Array, Counters]:
    """Return displacement and velocity of all bodies at every sample, both ends included."""
    walker = Walker(model, settings)
    states = [walker.y]
    for n in range(periods * SAMPLES):
        walker.interval(2 * PI * (n % SAMPLES) / SAMPLES)
        states.append(walker.y)
    y = np.array(states)
    x, v = (np.zeros((y.shape[0], model.beads + 2), dtype=LD) for _ in range(2))
    x[:, 1:-1], v[:, 1:-1] = y[:, : model.beads], y[:, model.beads :]
    phases = 2 * PI * (np.arange(y.shape[0]) % SAMPLES) / SAMPLES
    x[:, 0], v[:, 0] = driver(model, phases)
    return x, v, walker.count
