"""The state of a chain at one instant, in SI units."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..errors import BadInput
from .model import Scene


@dataclass(frozen=True, eq=False)
class State:
    """The state of a chain at one instant.

    Attributes
    ----------
    displacement : numpy.ndarray, shape (N,)
        Displacement of each bead from its rest position [m]: under preload, from the compressed rest, otherwise from
        where neighbours first touch.
    velocity : numpy.ndarray, shape (N,)
        Velocity of each bead [m/s].
    phase : float
        Drive phase as a fraction of a period, 0 to 1. A recorded motion starts at one of its samples, so `run` accepts
        multiples of 1/samples; `settle` and others first advance to phase 0, and accept k/n with n up to 10,000.

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


def checked_start(scene: Scene, start: State) -> State:
    """Return `start` with arrays of floats, if a motion of the scene can start there.

    Raises `BadInput` for anything but a state, another number of beads, non-finite numbers, or a phase outside 0 to 1.
    """
    if not isinstance(start, State):
        raise BadInput(f"A start must be a State, not {type(start).__name__}.")
    try:
        rows = [np.asarray(row, dtype=float) for row in (start.displacement, start.velocity)]
        phase = float(start.phase)
    except (TypeError, ValueError):
        raise BadInput("A start must have displacements, velocities and a phase that are numbers.") from None
    for name, row in zip(("displacements", "velocities"), rows, strict=True):
        if row.shape != (scene.N,):
            raise BadInput(f"The start has {name} of shape {row.shape}; a chain of {scene.N} beads has ({scene.N},).")
        if not np.isfinite(row).all():
            bead = 1 + int(np.argmin(np.isfinite(row)))
            raise BadInput(f"The start has {name} that are not finite, the first at bead {bead}.")
    if not 0.0 <= phase <= 1.0:
        raise BadInput(f"The start has the drive phase {phase:g}, outside 0 to 1: it is a fraction of a period.")
    return replace(start, displacement=rows[0], velocity=rows[1], phase=phase)


def rest(scene: Scene) -> State:
    """Return the scene's start: at rest at drive phase 0, except for beads with a start velocity."""
    return State(np.zeros(scene.N), scene.velocities_at_start())
