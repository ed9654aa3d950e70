"""The states of the contacts, and the search for the first contact event within a step."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from ref_scene import LD, Array, Model, contact_forces, overlaps

OPEN, PRESSED, CUT = 0, 1, 2
Dense = Callable[[Array], tuple[Array, Array]]


@dataclass(frozen=True)
class Event:
    """Contact `contact` changes to `state` at the point `where` of the step."""

    where: LD
    contact: int
    state: int


@dataclass
class Contacts:
    """The state of every contact; `touch` is its onset threshold, `fresh` the contact that has just closed or -1.

    From rest without preload, every contact but the first starts at d = 0 and closes tangentially.  Its force is
    switched on when d first reaches a threshold far below the accuracy. The omitted impulse, D times the threshold, is
    also far below it.
    """

    state: Array
    touch: Array
    fresh: int = -1
    still: int = 0

    @classmethod
    def at_rest(cls, model: Model, touch: float) -> "Contacts":
        """Return the contacts of the chain at rest at t = 0."""
        size = model.beads + 1
        if model.static[0] > 0:
            return cls(np.full(size, PRESSED), np.zeros(size, dtype=LD))
        state, threshold = np.full(size, OPEN), np.full(size, LD(touch))
        state[0], threshold[0] = PRESSED, 0
        return cls(state, threshold, fresh=0)

    def apply(self, event: Event | None) -> None:
        """Change the state after an event, or after a step without one."""
        self.fresh = -1
        if event is None:
            self.still = 0
            return
        self.still = self.still + 1 if event.where < 1e-15 else 0
        if self.still > 20:
            raise RuntimeError(f"contact {event.contact} opens and closes without end")
        c = event.contact
        if self.state[c] == OPEN and self.touch[c] == 0:
            self.fresh = c
        self.touch[c] = 0
        self.state[c] = event.state


@dataclass
class Flow:
    """The dense solution of one step, and the sub-points at which it is examined."""

    model: Model
    dense: Dense
    points: Array

    def signals(self, s: Array, contacts: Contacts) -> tuple[Array, Array, Array]:
        """Return, per point and contact, the signal to leave its state, its rate, and that of a cut contact to press.
        """
        x, v = self.dense(s)
        d, rate = overlaps(self.model, x), v[:, :-1] - v[:, 1:]
        is_open = contacts.state == OPEN
        leave = np.where(is_open, d - contacts.touch, -d)
        slope = np.where(is_open, rate, -rate)
        press = np.full(d.shape, LD(-1))
        if self.model.cut:
            elastic, damping = contact_forces(self.model, x, v)
            force = elastic + damping
            leave = np.where(contacts.state == PRESSED, -force, leave)
            slope = np.where(contacts.state == PRESSED, 0, slope)
            press = np.where(contacts.state == CUT, force, press)
        return leave, slope, press


def target(state: int, model: Model) -> int:
    """Return the state to which a contact changes when its leaving signal becomes positive."""
    if state == OPEN:
        return PRESSED
    return CUT if state == PRESSED and model.cut else OPEN


def root(g: Callable[[LD], LD], a: LD, b: LD) -> LD:
    """Return the root of g in [a, b], where g(a) <= 0 < g(b), by the Illinois method to working precision."""
    fa, fb = g(a), g(b)
    if fa >= 0:
        return a
    side, last = 0, b
    for _ in range(100):
        c = b - fb * (b - a) / (fb - fa)
        if not a < c < b:
            break
        fc = g(c)
        if fc == 0:
            return c
        if fc > 0:
            b, fb, fa, side = c, fc, fa / 2 if side == 1 else fa, 1
        else:
            a, fa, fb, side = c, fc, fb / 2 if side == -1 else fb, -1
        if abs(c - last) <= 1e-18:
            return c
        last = c
    return b if abs(fb) < abs(fa) else a


def first_event(flow: Flow, contacts: Contacts) -> Event | None:
    """Return the first event of the step, or None."""
    leave, slope, press = flow.signals(flow.points, contacts)
    hidden = hidden_peaks(flow, contacts, leave, slope)
    hits = (leave > 0) | (press > 0)
    for i in range(flow.points.size):
        found = [locate(flow, contacts, int(c), i, None) for c in np.flatnonzero(hits[i])]
        found += [locate(flow, contacts, c, i, s) for j, c, s in hidden if j == i]
        if found:
            return min(found, key=lambda e: e.where)
    return None


def locate(flow: Flow, contacts: Contacts, c: int, i: int, peak: LD | None) -> Event:
    """Return the event at the root of contact c's signal between sub-points i - 1 and i (or the inner peak)."""
    a = flow.points[i - 1] if i else LD(0)
    b = flow.points[i] if peak is None else peak
    leave, _, press = flow.signals(np.array([b]), contacts)
    again = bool(press[0, c] > 0 and leave[0, c] <= 0)

    def g(s: LD) -> LD:
        signals = flow.signals(np.array([s]), contacts)
        return signals[2 if again else 0][0, c]

    return Event(root(g, a, b), int(c), PRESSED if again else target(int(contacts.state[c]), flow.model))


def rise(flow: Flow, contacts: Contacts, c: int, s: LD) -> LD:
    """Return minus the rate of contact c's leaving signal: negative while it rises."""
    return -flow.signals(np.array([s]), contacts)[1][0, c]


def hidden_peaks(flow: Flow, contacts: Contacts, leave: Array, slope: Array) -> list[tuple[int, int, LD]]:
    """Return touches (or separations) that begin and end between two sub-points, as (sub-point, contact, place)."""
    points = np.concatenate([[LD(0)], flow.points])
    first = flow.signals(points[:1], contacts)
    leave, slope = np.concatenate([first[0], leave]), np.concatenate([first[1], slope])
    turning = (leave[:-1] <= 0) & (leave[1:] <= 0) & (slope[:-1] > 0) & (slope[1:] < 0)
    out = []
    for i, c in zip(*np.nonzero(turning), strict=True):
        s = root(partial(rise, flow, contacts, int(c)), points[i], points[i + 1])
        if flow.signals(np.array([s]), contacts)[0][0, c] > 0:
            out.append((int(i), int(c), s))
    return out
