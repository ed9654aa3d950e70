"""The state of a chain at one instant, in SI."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .scene import Scene


@dataclass(frozen=True, eq=False)
class State:
    """The state of a chain at one instant.

    Attributes
    ----------
    displacement : numpy.ndarray, shape (N,)
        Displacement of each bead from its rest position [m]: under preload from the compressed rest, else from where
        neighbours first touch.
    velocity : numpy.ndarray, shape (N,)
        Velocity of each bead [m/s].
    phase : float
        Drive phase as a fraction of a period, 0 to 1.

    Examples
    --------
    >>> import numpy as np
    >>> from granchain_core import State
    >>> State(np.zeros(2), np.array([0.01, 0.0])).phase
    0.0
    """

    displacement: np.ndarray
    velocity: np.ndarray
    phase: float = 0.0


def rest(scene: Scene) -> State:
    """The scene's start: at rest at drive phase 0, except for beads that are given a velocity."""
    return State(np.zeros(scene.N), scene.velocities_at_start())
