"""Method A: Taylor series of the (u, v) equations in long double, with contact events as roots of the series.

Between events, the set of pressed contacts is fixed and the motion is analytic.  Displacement and velocity are expanded
to a high order (the 3/2 power by the recurrence for a power of a series), and the step is chosen from the last
coefficients.  At an onset d = 0, the force contains d^{3/2}.  The motion is then analytic not in t but in s, where t =
t0 + s^p with p = 2 (p = 4 for the Tsuji law).  The first step after an onset is therefore a series in s, with the
overlap written as d = s^p g(s).  Before a release, the steps shrink geometrically with the radius of convergence until
the singular part is below the tolerance.
"""

from dataclasses import dataclass
from functools import partial

import numpy as np
from ref_events import PRESSED, Contacts, Flow, first_event
from ref_scene import LD, PI, SAMPLES, Array, Model, driver


@dataclass(frozen=True)
class Settings:
    """Settings that can be varied to estimate the error: order, tolerance, first-touch threshold, sub-points of a step.
    """

    order: int = 30
    tol: float = 1e-19
    touch: float = 1e-18
    points: int = 12


@dataclass
class Counters:
    """Steps and events of a run."""

    steps: int = 0
    events: int = 0


def power_weights(alpha: LD, order: int) -> Array:
    """Return W[k, j] = (alpha j - (k - j)) / k of y_k = sum_j W[k, j] g_j y_{k-j} / g_0 for y = g^alpha."""
    k = np.arange(order + 1, dtype=LD)[:, None]
    j = np.arange(order + 1, dtype=LD)[None, :]
    out = (alpha * j - (k - j)) / np.maximum(k, 1)
    return out[:, :, None]


class Series:
    """Expands the motion of a model about a state."""

    def __init__(self, model: Model, order: int) -> None:
        """Compute the tables that depend only on the order."""
        self.model, self.order = model, order
        self.elastic = power_weights(LD(3) / 2, order)
        self.damping = power_weights(model.exponent, order)

    def driver_rows(self, phase: LD, p: int, rows: int) -> tuple[Array, Array]:
        """Return the coefficients in s of the driver's displacement and velocity, where t = s^p."""
        x, v = np.zeros(rows, dtype=LD), np.zeros(rows, dtype=LD)
        sine, cosine, factor = np.sin(phase), np.cos(phase), LD(1)
        cycle = (sine, cosine, -sine, -cosine)
        for n, k in enumerate(range(0, rows, p)):
            x[k] = factor * cycle[n % 4]
            v[k] = factor * self.model.beta * cycle[(n + 1) % 4]
            factor = factor * self.model.beta / (n + 1)
        return x, v

    def expand(self, x0: Array, v0: Array, phase: LD, pressed: Array, fresh: int) -> tuple[Array, Array, int]:
        """Return the coefficients of x and v, one row per order, and p; `fresh` is the contact just closing or -1."""
        model, order = self.model, self.order
        p = model.root if fresh >= 0 else 1
        rows = order + 1 + p
        x, v = np.zeros((rows, x0.size), dtype=LD), np.zeros((rows, x0.size), dtype=LD)
        x[0], v[0] = x0, v0
        x[:, 0], v[:, 0] = self.driver_rows(phase, p, rows)
        force = ForceSeries(self, x0, v0, pressed, fresh, p)
        for k in range(order + 1):
            ratio = LD(p) / (k + p)
            x[k + p, 1:-1] = ratio * v[k, 1:-1]
            f = force.row(k, x, v)
            v[k + p, 1:-1] = ratio * (f[:-1] - f[1:] - model.kappa * x[k, 1:-1])
        return x, v, p


class ForceSeries:
    """The contact forces of a series, one order at a time."""

    def __init__(self, series: Series, x0: Array, v0: Array, pressed: Array, fresh: int, p: int) -> None:
        """Allocate the scaled overlap g = d / (g_0 s^shift), its powers and the velocity differences."""
        self.series, self.model, self.p = series, series.model, p
        self.cols = np.flatnonzero(pressed)
        self.new = np.flatnonzero(self.cols == fresh)
        shape = (series.order + 1, self.cols.size)
        self.g, self.el, self.da = (np.zeros(shape, dtype=LD) for _ in range(3))
        self.shifted, self.rate = np.zeros(shape, dtype=LD), np.zeros(shape, dtype=LD)
        lead = (x0[:-1] - x0[1:] + self.model.static)[self.cols]
        lead[self.new] = (v0[:-1] - v0[1:])[self.cols[self.new]]
        self.inverse = 1 / lead
        self.el_lead = self.model.strength[self.cols] * lead * np.sqrt(lead)
        self.da_lead = self.model.lam * lead**self.model.exponent

    def row(self, k: int, x: Array, v: Array) -> Array:
        """Return coefficient k of every contact force."""
        out = np.zeros(self.model.strength.size, dtype=LD)
        if self.cols.size == 0:
            return out
        left, right, p = self.cols, self.cols + 1, self.p
        self.g[k] = (x[k, left] - x[k, right]) * self.inverse
        if self.new.size:
            c = left[self.new]
            self.g[k, self.new] = (x[k + p, c] - x[k + p, c + 1]) * self.inverse[self.new]
        if k == 0:
            self.g[0] = 1
        self.rate[k] = v[k, left] - v[k, right]
        total = self.el_lead * self.delayed(self.el, self.series.elastic, k, 3 * p // 2)
        if self.model.damped():
            total += self.da_lead * self.damping_row(k)
        out[left] = total
        return out

    def delayed(self, y: Array, weights: Array, k: int, shift: int) -> Array:
        """Advance y = g^alpha to order k and return its coefficient, times s^shift for the new contact."""
        if k == 0:
            y[0] = 1
        else:
            y[k] = np.add.reduce(weights[k, 1 : k + 1] * self.g[1 : k + 1] * y[k - 1 :: -1], axis=0)
        out = y[k].copy()
        if self.new.size:
            out[self.new] = y[k - shift, self.new] if k >= shift else 0
        return out

    def damping_row(self, k: int) -> Array:
        """Return coefficient k of (d / lead)^a times the overlap rate."""
        if self.model.exponent == 0:
            return self.rate[k]
        shift = int(self.p * self.model.exponent) if self.new.size else 0
        self.shifted[k] = self.delayed(self.da, self.series.damping, k, shift)
        return np.add.reduce(self.shifted[: k + 1] * self.rate[k::-1], axis=0)


def step_size(v: Array, p: int, tol: float) -> LD:
    """Return the step in s at which the last 2p velocity coefficients fall below the tolerance."""
    size = np.max(np.abs(v[-2 * p :, 1:-1]), axis=1)
    order = np.arange(v.shape[0] - 2 * p, v.shape[0], dtype=LD)
    good = size > 0
    if not good.any():
        return LD(1)
    return LD(0.9) * np.min((LD(tol) / size[good]) ** (1 / order[good]))


def evaluate(coefficients: Array, s: Array) -> Array:
    """Return the value of the series at the points s."""
    powers = s[:, None] ** np.arange(coefficients.shape[0])
    return powers @ coefficients


def evaluate_both(cx: Array, cv: Array, s: Array) -> tuple[Array, Array]:
    """Return displacement and velocity at the points s."""
    return evaluate(cx, s), evaluate(cv, s)


def integrate(model: Model, periods: int, settings: Settings) -> tuple[Array, Array, Counters]:
    """Return displacement and velocity of all bodies at every sample, both ends included."""
    series, count = Series(model, settings.order), Counters()
    contacts = Contacts.at_rest(model, settings.touch)
    x, v = np.zeros(model.beads + 2, dtype=LD), np.zeros(model.beads + 2, dtype=LD)
    v[0] = model.beta
    xs, vs = [x], [v]
    for n in range(periods * SAMPLES):
        x, v = advance(series, contacts, x, v, 2 * PI * (n % SAMPLES) / SAMPLES, settings, count)
        x[0], v[0] = driver(model, 2 * PI * ((n + 1) % SAMPLES) / SAMPLES)
        xs.append(x)
        vs.append(v)
    return np.array(xs), np.array(vs), count


def advance(series: Series, contacts: Contacts, x: Array, v: Array, start: LD, settings: Settings,
            count: Counters) -> tuple[Array, Array]:  # fmt: skip
    """Advance the state by one sampling interval, stopping at every event."""
    model, done = series.model, LD(0)
    grid = np.arange(1, settings.points + 1, dtype=LD) / settings.points
    while done < model.interval:
        phase = start + model.beta * done
        cx, cv, p = series.expand(x, v, phase, contacts.state == PRESSED, contacts.fresh)
        room = (model.interval - done) ** (LD(1) / p)
        h = min(step_size(cv, p, settings.tol), room)
        flow = Flow(model, partial(evaluate_both, cx, cv), grid * h)
        event = first_event(flow, contacts)
        s = h if event is None else event.where
        ends = event is None and h == room
        x, v = evaluate(cx, np.array([s]))[0], evaluate(cv, np.array([s]))[0]
        done = model.interval if ends else done + s**p
        contacts.apply(event)
        count.steps += 1
        count.events += event is not None
    return x, v
