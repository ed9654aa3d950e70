"""Two ways to compute the same motion that share nothing with the kernels: the paper's equations in (u, v), and SciPy.

`located` is the careful way: SciPy's DOP853, restarted whenever a contact opens or closes. `as_a_user` is the obvious
first attempt: SI units, LSODA, a contact closed if `overlap > 0`, the default absolute tolerance.
"""

from __future__ import annotations

import time
import warnings
from dataclasses import dataclass
from typing import Any

import numba
import numpy as np
from scipy.integrate import DOP853, solve_ivp
from scipy.optimize import brentq

from granchain_core import ComputationError, Scene
from granchain_core.scene.state import rest

from .laws import EXPONENT

#: Fractions of a step at which contacts are checked, so that a brief touch is seen.
_LOOKS = np.linspace(0.0, 1.0, 9)[1:]


class TooLong(Exception):
    """The time allowed for a reference has been exceeded."""


@numba.njit
def _gaps(t, u, amplitude, omega, static):
    out = static.copy()
    out[0] += amplitude * np.sin(omega * t)
    out[:-1] -= u
    out[1:] += u
    return out


@numba.njit
def _slope(t, y, closed, masses, springs, static, strength, power, foundation, amplitude, omega, cut):
    n = masses.size
    gap = _gaps(t, y[:n], amplitude, omega, static)
    force = np.zeros(n + 1)
    for c in range(n + 1):
        if closed[c]:
            left = amplitude * omega * np.cos(omega * t) if c == 0 else y[n + c - 1]
            right = y[n + c] if c < n else 0.0
            d = max(gap[c], 0.0)
            force[c] = springs[c] * d**1.5 + strength * d**power * (left - right)
            if cut:
                force[c] = max(force[c], 0.0)
    out = np.empty(2 * n)
    out[:n] = y[n:]
    out[n:] = (force[:-1] - force[1:] - foundation * y[:n]) / masses
    return out


@dataclass(frozen=True, eq=False)
class Chain:
    """Constants of the equations in units of length and time, and the start (2N,)."""

    constants: tuple[Any, ...]
    start: np.ndarray
    period: float
    length: float

    @classmethod
    def of(cls, scene: Scene, scaled: bool) -> Chain:
        """Return the chain of a scene, in units of A0, the mass of bead 1 and its K, or in SI."""
        mass, stiffness, length = (scene.bead(1).mass, scene.K, scene.A0) if scaled else (1.0, 1.0, 1.0)
        rate = np.sqrt(stiffness * np.sqrt(length) / mass)
        power = EXPONENT[scene.dissipation] if scene.has_dissipation else 0.0
        strength = scene.D / (mass * rate) * (length / scene.reference_overlap) ** power if scene.has_dissipation else 0.0
        constants = (scene.masses() / mass, scene.contact_stiffness() / stiffness, scene.static_overlap() / length,
                     strength, power, scene.k / (stiffness * np.sqrt(length)), scene.A0 / length,
                     2.0 * np.pi * scene.f / rate, scene.cuts_tension)
        start = np.concatenate([np.zeros(scene.N), rest(scene).velocity / (length * rate)])
        return cls(constants, start, rate / scene.f, length)

    def gaps(self, t: float, state: np.ndarray) -> np.ndarray:
        """Return the overlap of every contact."""
        return _gaps(t, state[: len(state) // 2], *self.constants[6:8], self.constants[2])

    def slope(self, t: float, state: np.ndarray, closed: np.ndarray) -> np.ndarray:
        """Return (u̇, v̇) while exactly the contacts in `closed` act."""
        return _slope(t, state, closed, *self.constants)


def located(scene: Scene, periods: int, samples: int, rtol: float, seconds: float) -> np.ndarray:
    """Return displacements (periods·samples + 1, N) [m]. Raise `TooLong`, or `ComputationError` if SciPy gives up."""
    chain, deadline = Chain.of(scene, True), time.perf_counter() + seconds
    times = chain.period * np.arange(periods * samples + 1) / samples
    out = np.zeros((len(times), scene.N))
    t, state, row = 0.0, chain.start, 1
    gaps, rates = chain.gaps(t, state), np.diff(-np.concatenate([[2.0 * np.pi * chain.constants[6] / chain.period],
                                                                 state[scene.N :], [0.0]]))
    closed = (gaps > 0.0) | ((gaps == 0.0) & (rates > 0.0))
    one: Any = None
    while row < len(times):
        if time.perf_counter() > deadline:
            raise TooLong
        if one is None:
            one = DOP853(lambda s, y, c=closed: chain.slope(s, y, c), t, state, times[-1], rtol=rtol, atol=1e-2 * rtol,
                         max_step=chain.period / 16.0)
        one.step()
        if one.status == "failed":
            raise ComputationError(f"SciPy's DOP853 gave up at scaled time {one.t:.6g}.", "solver-gave-up")
        dense = one.dense_output()
        end, contact = _first(chain, dense, one.t_old, one.t, closed)
        while row < len(times) and times[row] <= end:
            out[row] = dense(times[row])[: scene.N]
            row += 1
        if contact >= 0:
            closed = closed.copy()
            closed[contact] = not closed[contact]
            t, state, one = end, dense(end), None
    return out * chain.length


def _first(chain: Chain, dense: Any, start: float, end: float, closed: np.ndarray) -> tuple[float, int]:
    """Return when and which contact first opens or closes in a step; the step's end and −1 if none does."""
    before = start
    sign = np.where(closed, -1.0, 1.0)
    for now in start + _LOOKS * (end - start):
        wrong = np.flatnonzero(sign * chain.gaps(now, dense(now)) > 0.0)
        if len(wrong):
            return min((_root(chain, dense, before, now, int(c), float(sign[c])), int(c)) for c in wrong)
        before = now
    return end, -1


def _root(chain: Chain, dense: Any, low: float, high: float, contact: int, sign: float) -> float:
    def gap(t: float) -> float:
        return float(sign * chain.gaps(t, dense(t))[contact])

    return low if gap(low) >= 0.0 else float(brentq(gap, low, high, xtol=1e-14))


def as_a_user(scene: Scene, periods: int, samples: int, seconds: float) -> np.ndarray:
    """Return displacements [m] from `solve_ivp(..., "LSODA", rtol=accuracy)`, even NaN, as long as it reports success.

    Raise `ComputationError` if SciPy reports a failure, or `TooLong`.
    """
    chain, deadline = Chain.of(scene, False), time.perf_counter() + seconds

    def slope(t: float, y: np.ndarray) -> np.ndarray:
        if time.perf_counter() > deadline:
            raise TooLong
        return chain.slope(t, y, chain.gaps(t, y) > 0.0)

    times = chain.period * np.arange(periods * samples + 1) / samples
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # only the returned result matters here
        found: Any = solve_ivp(slope, (0.0, times[-1]), chain.start, method="LSODA", rtol=scene.accuracy, t_eval=times)
    if not found.success or found.y.shape[1] != len(times):
        raise ComputationError(f"SciPy's LSODA: {found.message}", "solver-gave-up")
    return found.y[: scene.N].T
