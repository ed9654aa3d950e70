"""Drift: an observer that nothing holds moves away as a whole.

The observer of model (4), Zhang et al. 2016, is pushed by a given force; without a foundation its beads are held by the
wall alone, and only while they touch it. A multiplier outside the unit circle that is real and whose mode moves all
beads the same way is not an instability of the shape but a drift: to one side if it is positive, alternating between
the sides if it is negative (at 200 Hz).
"""

from __future__ import annotations

from ..orbits import Orbit
from ..orbits.flow import StroboscopicMap
from ..orbits.modes import eigenpair

#: A multiplier this near to the unit circle counts as on it: the error of the tangents.
_NEAR = 1e-6


def observer_drift(orbit: Orbit) -> str | None:
    """A sentence if the observer of `orbit` drifts, else None; the orbit must have its observer's multipliers."""
    found = orbit.observer_multipliers
    if found is None or abs(found[0]) < 1.0 - _NEAR:
        return None
    stroboscopic_map = StroboscopicMap(orbit.scene, orbit.period)
    x = stroboscopic_map.inner(stroboscopic_map.engine.lowered.scaled(orbit.state))
    value, vector = eigenpair(stroboscopic_map, x, 0, observer=True)
    moved = vector[: orbit.scene.N].real
    if value.imag != 0.0 or not ((moved > 0.0).all() or (moved < 0.0).all()):
        return None
    way = "the same way" if value.real > 0.0 else "the same way, alternating between the sides"
    return (f"The observer drifts: its leading multiplier {value.real:.4g} is real and moves all beads "
            f"{way}, because nothing holds them in place (k = {orbit.scene.k:g} N/m); give it a foundation.")
