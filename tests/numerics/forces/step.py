"""One step of Dormand–Prince 8(5,3) for a chain in (u, v), its dense output, and the largest forces within it.

The state y contains u_1..u_N, then v_1..v_N, in scaled units. The mode of each contact is constant within a step.
Coefficients: scipy.integrate._ivp.dop853_coefficients (Hairer, Nørsett & Wanner 1993, section II.5).
"""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numba import njit
from scipy.integrate._ivp import dop853_coefficients as table

from granchain_core.kernels.compiling.cache import KernelCache
from granchain_core.kernels.compiling.cache_folder import CACHE_FOLDER

#: Modes of a contact: open; the force of the law; closed but without force (tension cut).
OPEN, NET_FORCE, SLACK = 0, 1, 2
#: The forces examined: of contact 0, of contact N, and of the spring of contact N.
INPUT, OUTPUT, ELASTIC = 0, 1, 2
FORCES = 3

_A, _C = np.ascontiguousarray(table.A[1:12, :12]), np.ascontiguousarray(table.C[1:12])
_B, _E3, _E5 = (np.ascontiguousarray(x) for x in (table.B, table.E3, table.E5))
_A_MORE, _C_MORE = np.ascontiguousarray(table.A[13:]), np.ascontiguousarray(table.C[13:])
_D = np.ascontiguousarray(table.D)
#: Number of slopes, and of rows of the polynomial between a step's ends.
SLOPES, POLYNOMIAL = 16, 7
#: Intervals of a step at whose ends forces are evaluated to find a maximum.
_LOOKS = 8
_GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)


class _Kept(KernelCache):
    """Compiled versions on disk. The cache of the core's kernels notices an edit of a kernel's own file. The functions
    here call one another, so this cache notices an edit of any file of the folder that has compiled functions.
    """

    def __init__(self, function: Any) -> None:
        super().__init__(function)
        sources = [path.read_bytes() for path in sorted(Path(__file__).parent.glob("*.py"))]
        self._cache_file._stamp = hashlib.sha256(b"".join(one for one in sources if b"\n@jit\n" in one)).hexdigest()


def jit(function: Any) -> Any:
    """Compile a function of this folder (a decorator): once per machine, and by one process at a time."""
    compiled = njit(function)
    if CACHE_FOLDER is not None:
        compiled._cache = _Kept(function)
    return compiled


class Law(NamedTuple):
    """Constants of the scaled equations; `power` is 4q in g(δ) = strength·δ^q."""

    inverse_mass: np.ndarray
    stiffness: np.ndarray
    static: np.ndarray
    strength: float
    power: int
    foundation: float
    beta: float
    cut: bool


class Step(NamedTuple):
    """Workspace: slopes, state at a stage, state at the end, error scales, and the polynomial between the ends."""

    slopes: np.ndarray
    stage: np.ndarray
    end: np.ndarray
    scale: np.ndarray
    polynomial: np.ndarray


def workspace(beads: int) -> Step:
    """Allocate a workspace for this number of beads."""
    size = 2 * beads
    return Step(np.zeros((SLOPES, size)), np.zeros(size), np.zeros(size), np.zeros(size), np.zeros((POLYNOMIAL, size)))


@jit
def damping(law, d):
    """Return g(d) for an overlap d ≥ 0."""
    if law.power == 0:
        return law.strength
    if law.power == 1:
        return law.strength * np.sqrt(np.sqrt(d))
    if law.power == 2:
        return law.strength * np.sqrt(d)
    return law.strength * d ** (0.25 * law.power)


@jit
def law_force(law, c, gap, rate):
    """Return the law's force of contact c, even if it pulls."""
    d = max(gap, 0.0)
    return law.stiffness[c] * d * np.sqrt(d) + damping(law, d) * rate


@jit
def slope(law, mode, t, y, dy):
    """Compute (u̇, v̇) at time t of the period, with the contacts in these modes."""
    n = law.inverse_mass.size
    u, v = np.sin(law.beta * t), law.beta * np.cos(law.beta * t)
    pushed = 0.0
    for c in range(n + 1):
        right_u, right_v = (y[c], y[n + c]) if c < n else (0.0, 0.0)
        force = law_force(law, c, u - right_u + law.static[c], v - right_v) if mode[c] == NET_FORCE else 0.0
        if c > 0:
            dy[n + c - 1] = law.inverse_mass[c - 1] * (pushed - force - law.foundation * u)
        if c < n:
            dy[c] = right_v
        pushed, u, v = force, right_u, right_v


@jit
def _stages(law, mode, t, y, h, k, s, first, last, a, c):
    """Compute slopes `first` to `last − 1`, each from those before it."""
    for i in range(first, last):
        for j in range(y.size):
            s[j] = 0.0
        for m in range(i):
            weight = h * a[i - first, m]
            if weight != 0.0:
                for j in range(y.size):
                    s[j] += weight * k[m, j]
        for j in range(y.size):
            s[j] += y[j]
        slope(law, mode, t + c[i - first] * h, s, k[i])


@jit
def take_step(law, mode, t, y, h, step):
    """Take a step from y at t, leave the state in step.end, and return the error relative to the allowed one.

    step.slopes[0] must contain the slope at its beginning.
    """
    k, s, end = step.slopes, step.stage, step.end
    _stages(law, mode, t, y, h, k, s, 1, 12, _A, _C)
    for j in range(y.size):
        s[j] = 0.0
    for m in range(12):
        if _B[m] != 0.0:
            for j in range(y.size):
                s[j] += h * _B[m] * k[m, j]
    for j in range(y.size):
        end[j] = y[j] + s[j]
    slope(law, mode, t + h, end, k[12])
    five, three = 0.0, 0.0
    for j in range(y.size):
        e5, e3 = 0.0, 0.0
        for m in range(13):
            e5 += _E5[m] * k[m, j]
            e3 += _E3[m] * k[m, j]
        five, three = max(five, abs(e5) / step.scale[j]), max(three, abs(e3) / step.scale[j])
        if not (np.isfinite(e5) and np.isfinite(end[j])):
            return np.inf
    return 0.0 if five == 0.0 else abs(h) * five * five / np.sqrt(five * five + 0.01 * three * three)


@jit
def fill(law, mode, t, y, h, step):
    """Compute the polynomial between the ends of the step just taken."""
    k, end, f = step.slopes, step.end, step.polynomial
    _stages(law, mode, t, y, h, k, step.stage, 13, 16, _A_MORE, _C_MORE)
    for j in range(y.size):
        delta = end[j] - y[j]
        f[0, j] = delta
        f[1, j] = h * k[0, j] - delta
        f[2, j] = 2.0 * delta - h * (k[12, j] + k[0, j])
        for r in range(4):
            total = 0.0
            for m in range(16):
                total += _D[r, m] * k[m, j]
            f[3 + r, j] = h * total


@jit
def between(y, f, j, x):
    """Return component j at the fraction x of the step that began at y."""
    value = 0.0
    for r in range(POLYNOMIAL):
        value = (value + f[POLYNOMIAL - 1 - r, j]) * (x if r % 2 == 0 else 1.0 - x)
    return y[j] + value


@jit
def gap_and_rate(law, t, y, h, f, c, x):
    """Return the overlap of contact c and its rate at the fraction x of a step."""
    n = law.inverse_mass.size
    if c == 0:
        phase = law.beta * (t + x * h)
        u, v = np.sin(phase), law.beta * np.cos(phase)
    else:
        u, v = between(y, f, c - 1, x), between(y, f, n + c - 1, x)
    if c < n:
        u, v = u - between(y, f, c, x), v - between(y, f, n + c, x)
    return u + law.static[c], v


@jit
def gap_and_rate_of(law, t, y, c):
    """Return the overlap of contact c and its rate in state y."""
    n = law.inverse_mass.size
    u, v = (np.sin(law.beta * t), law.beta * np.cos(law.beta * t)) if c == 0 else (y[c - 1], y[n + c - 1])
    if c < n:
        u, v = u - y[c], v - y[n + c]
    return u + law.static[c], v


@jit
def _force(law, mode, which, gap, rate):
    """Return the force `which` of a contact with this overlap and rate."""
    c = 0 if which == INPUT else law.inverse_mass.size
    if which == ELASTIC:
        d = max(gap, 0.0)
        return law.stiffness[c] * d * np.sqrt(d)
    return law_force(law, c, gap, rate) if mode[c] == NET_FORCE else 0.0


@jit
def force_of(law, mode, which, t, y):
    """Return the force `which` in state y."""
    gap, rate = gap_and_rate_of(law, t, y, 0 if which == INPUT else law.inverse_mass.size)
    return _force(law, mode, which, gap, rate)


@jit
def _force_between(law, mode, which, t, y, h, f, x):
    gap, rate = gap_and_rate(law, t, y, h, f, 0 if which == INPUT else law.inverse_mass.size, x)
    return _force(law, mode, which, gap, rate)


@jit
def largest_in(law, mode, t, y, h, step, maxima, kept):
    """Raise `maxima` to the largest forces at the ends of the step from y and between them; its polynomial is filled.

    The place of a maximum is found on the polynomial; it need not be accurate, because the force is flat there. The
    value is that of a step that ends there. The polynomial remains valid; `kept` (2N) keeps the state at the end.
    """
    n = law.inverse_mass.size
    values = np.empty(_LOOKS + 1)
    for which in range(FORCES):
        if mode[0 if which == INPUT else n] == OPEN:
            continue
        for i in range(1, _LOOKS):
            values[i] = _force_between(law, mode, which, t, y, h, step.polynomial, i / _LOOKS)
        values[0], values[_LOOKS] = force_of(law, mode, which, t, y), force_of(law, mode, which, t + h, step.end)
        maxima[which] = max(maxima[which], values[0], values[_LOOKS])
        for i in range(_LOOKS + 1):
            low, high = max(i - 1, 0), min(i + 1, _LOOKS)
            if values[i] < values[low] or values[i] < values[high]:
                continue
            if values[i] + 2.0 * max(values[i] - values[low], values[i] - values[high]) <= maxima[which]:
                continue
            x = _top(law, mode, which, t, y, h, step.polynomial, low / _LOOKS, high / _LOOKS)
            if 0.0 < x < 1.0:
                kept[:] = step.end
                take_step(law, mode, t, y, x * h, step)
                maxima[which] = max(maxima[which], force_of(law, mode, which, t + x * h, step.end))
                step.end[:] = kept
    return 0


@jit
def _top(law, mode, which, t, y, h, f, a, b):
    """Return where the force is largest between a and b, by golden-section search."""
    c, d = b - _GOLDEN * (b - a), a + _GOLDEN * (b - a)
    at_c = _force_between(law, mode, which, t, y, h, f, c)
    at_d = _force_between(law, mode, which, t, y, h, f, d)
    while b - a > 1e-7:
        if at_c > at_d:
            b, d, at_d = d, c, at_c
            c = b - _GOLDEN * (b - a)
            at_c = _force_between(law, mode, which, t, y, h, f, c)
        else:
            a, c, at_c = c, d, at_d
            d = a + _GOLDEN * (b - a)
            at_d = _force_between(law, mode, which, t, y, h, f, d)
    return 0.5 * (a + b)
