"""An independent solver for comparison: SciPy in (u, v), restarted at every contact event.

It shares no equation and no variable with the kernels. Contacts are gated by flags that events flip, forces are those
of Zhang et al. 2016, eq. (1), in scaled units, and the method may be implicit (Radau) where a dashpot is stiff. Only
`restitution` uses something from the kernels, the exponents of the damping laws, so that it covers every law.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import ComputationError
from ..scene import Scene
from ..scene.laws import LAWS

#: Minimum number of steps per drive period, so that no push of the driver is stepped over.
_LEAST_STEPS = 16.0
#: Largest number of contact events in one solution; more mean that something has gone wrong.
_MOST_EVENTS = 20_000


@dataclass(frozen=True, eq=False)
class PlainChain:
    """A chain in scaled units, with the linear dashpot only.

    `masses` has shape (N,); `springs`, the stiffnesses of the contacts, and `static`, their overlaps at rest, have
    shape (N+1,). `damping` is that of a contact, `foundation` the stiffness of a bead's on-site spring, and `beta` the
    drive frequency. A state (2N,) has displacements, then velocities; times are scaled.
    """

    masses: np.ndarray
    springs: np.ndarray
    static: np.ndarray
    damping: float
    foundation: float
    beta: float

    @classmethod
    def of(cls, scene: Scene) -> PlainChain:
        """Return the plain form of a scene, whose damping must be the linear dashpot or none, with tension allowed."""
        mass, stiffness, length = scene.bead(1).mass, scene.K, scene.A0
        phi = np.sqrt(stiffness * np.sqrt(length) / mass)
        damping = scene.D / (mass * phi) if scene.dissipation == "linear" else 0.0
        return cls(scene.masses() / mass, scene.contact_stiffness() / stiffness, scene.static_overlap() / length,
                   damping, scene.k / (stiffness * np.sqrt(length)), 2.0 * np.pi * scene.f / phi)

    @property
    def period(self) -> float:
        """Drive period in scaled time."""
        return 2.0 * np.pi / self.beta

    def overlaps(self, t: float, state: np.ndarray) -> np.ndarray:
        """Return the overlap of every contact (N+1,) at scaled time t in a state (2N,)."""
        bodies = np.concatenate([[np.sin(self.beta * t)], state[: len(self.masses)], [0.0]])
        return bodies[:-1] - bodies[1:] + self.static

    def rates(self, t: float, state: np.ndarray) -> np.ndarray:
        """Return the rates of the overlaps (N + 1,)."""
        bodies = np.concatenate([[self.beta * np.cos(self.beta * t)], state[len(self.masses) :], [0.0]])
        return bodies[:-1] - bodies[1:]

    def slope(self, t: float, state: np.ndarray, closed: np.ndarray) -> np.ndarray:
        """Return (u̇, v̇) (2N,) while exactly the contacts in the boolean mask `closed` (N+1,) act."""
        n = len(self.masses)
        pressed = np.maximum(self.overlaps(t, state), 0.0)
        force = closed * (self.springs * pressed**1.5 + self.damping * self.rates(t, state))
        return np.concatenate([state[n:], (force[:-1] - force[1:] - self.foundation * state[:n]) / self.masses])


def solved(chain: PlainChain, start: np.ndarray, times: np.ndarray, method: str = "DOP853",
           rtol: float = 1e-12) -> np.ndarray:
    """Return displacements and velocities (T, 2N) at scaled `times` (T,), from `start` (2N,) at the first time.

    Raises `ComputationError` if SciPy gives up.
    """
    from scipy.integrate import solve_ivp

    n = len(chain.masses)
    out = np.zeros((len(times), 2 * n))
    out[0], row = start, 1
    t, state = float(times[0]), np.array(start, dtype=float)
    gaps = chain.overlaps(t, state)
    closed = (gaps > 0.0) | ((gaps == 0.0) & (chain.rates(t, state) > 0.0))
    for _ in range(_MOST_EVENTS):
        solution: Any = solve_ivp(lambda s, y, c=closed: chain.slope(s, y, c), (t, times[-1]), state, method=method,
                                  rtol=max(rtol, 3e-14), atol=1e-2 * rtol, dense_output=True,
                                  max_step=chain.period / _LEAST_STEPS,
                                  events=[_event(chain, c, bool(closed[c])) for c in range(n + 1)])
        if solution.status < 0:
            raise ComputationError(f"SciPy's {method} gave up at scaled time {t:.6g}: {solution.message}",
                                   "solver-gave-up")
        end = float(solution.t[-1])
        while row < len(times) and times[row] <= end:
            out[row] = solution.sol(times[row])
            row += 1
        if solution.status == 0:
            return out
        changed = next(c for c in range(n + 1) if len(solution.t_events[c]))
        closed = closed.copy()
        closed[changed] = not closed[changed]
        t, state = end, solution.y[:, -1]
    raise ComputationError(f"SciPy's {method} met more than {_MOST_EVENTS} contact events.", "chatter")


def _event(chain: PlainChain, contact: int, closed: bool) -> Callable[[float, np.ndarray], float]:
    def gap(t: float, state: np.ndarray) -> float:
        return float(chain.overlaps(t, state)[contact])

    gap.terminal, gap.direction = True, -1.0 if closed else 1.0  # type: ignore[attr-defined]
    return gap


def restitution(law: str, strength: float, cut: bool) -> float:
    """Return the restitution of a bead of mass 1 that meets a contact of K = 1 at speed 1.

    The force is δ^{3/2} + strength·g(δ)·δ̇ with g = δ^a. The motion is integrated in s = t^{1/4}, in which it is smooth
    after the closing. With a tension cut, it ends when the force vanishes, otherwise when the overlap does.
    """
    from scipy.integrate import solve_ivp

    power = LAWS[law].exponent

    def force(state: np.ndarray) -> float:
        d = max(state[0], 0.0)
        return float(d**1.5 + strength * d**power * state[1])

    def slope(s: float, state: np.ndarray) -> np.ndarray:
        return 4.0 * s**3 * np.array([state[1], -force(state)])

    def over(s: float, state: np.ndarray) -> float:
        if s < 1e-3:
            return 1.0
        # the forces of Tsuji's and of Kuwabara and Kono's laws vanish with the overlap; divided by d^power, a force has
        # a simple root at its end
        d = max(state[0], 0.0)
        return float(d ** (1.5 - power) + strength * state[1]) if cut and state[1] < 0.0 else float(state[0])

    over.terminal, over.direction = True, -1.0  # type: ignore[attr-defined]
    solution: Any = solve_ivp(slope, (0.0, 10.0), [0.0, 1.0], method="DOP853", rtol=3e-14, atol=1e-16, events=over,
                              max_step=0.02)
    return -float(solution.y[1, -1])
