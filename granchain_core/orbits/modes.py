"""Floquet modes: eigenvectors of the monodromy matrix as motions of the chain over one orbit.

A perturbation δx of an orbit of n drive periods obeys δx(n/f) = M δx(0). If it starts as an eigenvector v, with
M v = μ v, it returns as μ times itself. In between it is computed as the difference of two neighbouring motions, by
dop853:

    δu(t) = [u(t; x0 + ε v) − u(t; x0 − ε v)] / 2ε

Its error has two parts: the method's noise (about 1e-13) over ε, and the shift of contact events, which grows with ε.
At ε = 1e-5 the error is about 1e-8. The difference between δx(n/f) and μ δx(0) is measured for each mode (`closure`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..execution.stop import Stop
from ..inputs.checks import whole_number
from ..integrate import Engine, dop853_setting
from ..steady.poincare import Section
from ..steady.settling.nearby_orbit import MOST_BEADS_WITH_MULTIPLIERS
from .krylov import arnoldi
from .orbit import Orbit
from .stroboscopic_map import TOLERANCE, StroboscopicMap

#: Size of the carried perturbation relative to the motion.
_PERTURBATION = 1e-5
#: Fewest eigenpairs that Arnoldi iteration computes.
_FEWEST_EIGENPAIRS = 6


@dataclass(frozen=True, eq=False)
class Mode:
    """One mode of an orbit: the real motion is Re(c · displacement) for any complex c.

    `displacement` (n·samples + 1, N) is complex where the multiplier is, and its largest modulus is 1. `closure` is the
    largest difference between δx(n/f) and μ δx(0), in displacements and w, relative to the largest entry of δx(0).
    """

    multiplier: complex
    period: int
    samples: int
    displacement: np.ndarray
    closure: float


def mode(orbit: Orbit, rank: int = 0, samples: int = 48, stop: Stop | None = None) -> Mode:
    """Compute the mode of the multiplier of this `rank` by modulus, 0 being the largest.

    Of a complex pair, it is the mode of the multiplier with positive imaginary part.

    Raises `BadInput` for a rank beyond the last multiplier, `ComputationError`, `Cancelled`.
    """
    rank = whole_number("mode", rank, 0, len(orbit.multipliers) - 1)
    stroboscopic_map = StroboscopicMap(orbit.scene, orbit.period, stop)
    x = stroboscopic_map.inner(stroboscopic_map.engine.scaled.from_si(orbit.state))
    value, vector = eigenpair(stroboscopic_map, x, rank)
    if value.imag < 0.0:
        value, vector = value.conjugate(), vector.conj()
    beads = len(x) // 2
    vector = vector / vector[np.argmax(np.abs(vector))]
    size = _PERTURBATION * max(1e-300, float(np.abs(x[:beads]).max()))
    displacement, end = _carried(orbit, x, vector.real, size, samples, stop)
    if value.imag != 0.0:
        imaginary, imaginary_end = _carried(orbit, x, vector.imag, size, samples, stop)
        displacement, end = displacement + 1j * imaginary, end + 1j * imaginary_end
    closure = float(np.abs(end - value * vector).max() / np.abs(vector).max())
    return Mode(complex(value), period=orbit.period, samples=samples,
                displacement=displacement / np.abs(displacement).max(), closure=closure)


def eigenpair(stroboscopic_map: StroboscopicMap, x: np.ndarray, rank: int,
              observer: bool = False) -> tuple[complex, np.ndarray]:
    """Compute the multiplier of this `rank` by modulus and its eigenvector; for a long chain by Arnoldi iteration.

    With `observer`, the multiplier and eigenvector of the observer of model (4), Zhang et al. 2016.
    """
    if len(x) <= 2 * MOST_BEADS_WITH_MULTIPLIERS:
        values, vectors = np.linalg.eig(stroboscopic_map(x, observer=observer).derivative)
    else:
        values, vectors = arnoldi(stroboscopic_map, x, max(rank + 2, _FEWEST_EIGENPAIRS), observer, vectors=True)
    place = np.argsort(-np.abs(values), kind="stable")[rank]
    return complex(values[place]), vectors[:, place]


def _carried(orbit: Orbit, x: np.ndarray, direction: np.ndarray, size: float, samples: int,
             stop: Stop | None) -> tuple[np.ndarray, np.ndarray]:
    """The perturbation that starts as `direction`, as a central difference of two motions.

    Returns δu (n·samples + 1, N) along the orbit, and δx (2N,) at its end.
    """
    engine = Engine(orbit.scene, dop853_setting(TOLERANCE), samples, stop=stop)
    sides = []
    for sign in (1.0, -1.0):
        engine.start_scaled(x + sign * size * direction)
        record = engine.record(orbit.period * samples)
        sides.append((record.displacement, engine.scaled.beads_of(engine.y)))
    (u_plus, x_plus), (u_minus, x_minus) = sides
    return (u_plus - u_minus) / (2.0 * size), (x_plus - x_minus) / (2.0 * size)


def orbit_section(orbit: Orbit, samples: int = 48, stop: Stop | None = None) -> Section:
    """Compute the orbit's n points at every phase by dop853, which stays on an unstable orbit for n periods."""
    stroboscopic_map = StroboscopicMap(orbit.scene, orbit.period, stop)
    engine = Engine(orbit.scene, dop853_setting(TOLERANCE), samples, stop=stop)
    engine.start_scaled(stroboscopic_map.inner(stroboscopic_map.engine.scaled.from_si(orbit.state)))
    record, scales = engine.record(orbit.period * samples), engine.scaled.scales
    shape = (orbit.period, samples, -1)
    return Section(orbit.scene, scales.displacements(record.displacement[:-1].reshape(shape)),
                   scales.velocities(record.velocity[:-1].reshape(shape)))
