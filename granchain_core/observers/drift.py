"""Drift of an observer: without a foundation it may move away as a whole.

The observer of model (4), Zhang et al. 2016, is driven by a given force. Without a foundation, its beads are held only
by the wall, and only while they touch it. If the leading multiplier is real and not inside the unit circle, and its
mode is nearly a common shift of all beads, the exponential instability along that shift is called a drift. The observer
then keeps its shape and moves to one side if the multiplier is positive, or alternates between the sides if it is
negative (at 200 Hz).
"""

from __future__ import annotations

import numpy as np

from ..integrate.scaling import scale_chain
from ..orbits import Orbit
from ..orbits.modes import eigenpair
from ..orbits.stroboscopic_map import MULTIPLIER_ERROR, StroboscopicMap
from ..scene import Scene

#: Least squared cosine between a difference and a common shift of all beads at which it is called a translation.
TRANSLATION = 0.7


def share_of_translation(difference: np.ndarray) -> float:
    """Squared cosine between a difference of displacements and a common shift of all beads."""
    size = float(difference @ difference)
    return float(difference.sum() ** 2 / (len(difference) * size)) if size > 0.0 else 0.0


def is_drift(scene: Scene, share: float, multiplier: complex | None) -> bool:
    """Whether a growing difference with this share of a translation is a drift; a force that holds beads prevents it.

    `multiplier` is the one by which it grows, None if it is not known. A complex multiplier turns the difference
    through shapes of which only some are a translation.
    """
    return share >= TRANSLATION and (multiplier is None or is_real(multiplier)) and not scale_chain(scene).holds_beads


def is_real(multiplier: complex) -> bool:
    """Whether a multiplier is exactly real; otherwise it is one of a conjugate pair, as the matrix is real."""
    return multiplier.imag == 0.0


def departure_words(drifts: bool, multiplier: complex | None) -> str:
    """In words, how an observer fails to synchronise: it drifts or leaves its chain, and alternates if μ < 0."""
    alternating = multiplier is not None and is_real(multiplier) and multiplier.real < 0.0
    sides = ", alternating between the sides" if alternating else ""
    if drifts:
        return (f"drifts{sides}: a common shift of all its beads grows exponentially, an instability, because nothing "
                "pulls them back")
    return f"leaves its chain{sides}"


def observer_drift(orbit: Orbit) -> str | None:
    """A sentence if the observer of `orbit` drifts, otherwise None; the orbit must have its observer's multipliers."""
    multipliers = orbit.observer_multipliers
    # a multiplier that is not known to be inside the unit circle counts as on it
    if multipliers is None or abs(multipliers[0]) < 1.0 - MULTIPLIER_ERROR:
        return None
    stroboscopic_map = StroboscopicMap(orbit.scene, orbit.period)
    x = stroboscopic_map.inner(stroboscopic_map.engine.scaled.from_si(orbit.state))
    value, vector = eigenpair(stroboscopic_map, x, 0, observer=True)
    if not is_drift(orbit.scene, share_of_translation(vector[: orbit.scene.N].real), value):
        return None
    addition = "" if value.real > 0.0 else ", alternating between the sides"
    return (f"The observer drifts: its leading multiplier {value.real:.4g} is real and moves all beads "
            f"together{addition}, because nothing holds them in place (k = {orbit.scene.k:g} N/m); give it a "
            "foundation.")
