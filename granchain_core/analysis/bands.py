"""Pass bands of a precompressed chain: the frequencies at which small waves propagate.

About the compressed rest, every contact is a spring k_c = dF/dδ = (3/2) K_c^{2/3} F0^{1/3}. Equal beads have one band,
from 0 to the cut-off f_c = (1/π) √(k_c/m), or on a foundation from √(k/m)/2π to √((4k_c + k)/m)/2π. Dimers have an
acoustic and an optical band with a gap between them (Nesterenko, Dynamics of Heterogeneous Materials, 2001, section
1.2). In one dimension, a band ends where neighbouring cells move in phase or in antiphase.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np

from ..errors import BadInput
from ..scene import Scene
from ..scene.description import hertz_stiffness
from ..scene.hertz import EXPONENT, OVERLAP_POWER


def bands(scene: Scene) -> list[tuple[float, float]]:
    """Compute the pass bands of small waves in an infinite chain of a scene's beads.

    Parameters
    ----------
    scene : Scene
        A chain with a preload; striker and impurity, which are single beads, are ignored.

    Returns
    -------
    list of (float, float)
        Lowest and highest frequency of each band [Hz], ascending, one band for each bead of the unit cell. The cell is
        the pattern, repeated to an even number of beads if `dimer` makes every second bead different. The upper edge of
        the last band is the cut-off.

    Raises
    ------
    BadInput
        The chain is not precompressed, or tapered.

    Examples
    --------
    >>> from granchain_core import bands, scene
    >>> [f"{low:.0f} to {high:.0f} Hz" for low, high in bands(scene("precompressed"))]
    ['0 to 7200 Hz']
    """
    if scene.F0 == 0.0:
        raise BadInput("Without a preload no small wave can travel, so there are no bands; set F0 above 0, for example "
                       "F0=10.")
    if scene.taper != 1.0:
        raise BadInput("A tapered chain is not periodic, so it has no bands; the nearest valid value is "
                       "taper = 1.")
    count = math.lcm(len(scene.pattern), 1 if scene.dimer == 1.0 else 2)
    host = replace(scene, striker=1.0, impurity=1.0, impurities=())
    cell = [host.bead(2 * count + 1 + i) for i in range(count + 1)]
    mass = np.array([bead.mass for bead in cell[:count]])
    spring = np.array([EXPONENT * hertz_stiffness(a, b) ** OVERLAP_POWER * scene.F0 ** (1.0 - OVERLAP_POWER)
                       for a, b in itertools.pairwise(cell)])
    edges = np.sort([_frequencies(mass, spring, scene.k, phase) for phase in (1.0, -1.0)], axis=0)
    return [(float(low), float(high)) for low, high in edges.T]


def _frequencies(mass: np.ndarray, spring: np.ndarray, ground: float, phase: float) -> np.ndarray:
    """Frequencies [Hz], ascending, of a cell whose motion is repeated in the next cell with the factor `phase`."""
    count = len(mass)
    matrix = np.diag(spring + np.roll(spring, 1) + ground)
    for i in range(count):
        j, factor = (i + 1, 1.0) if i + 1 < count else (0, phase)
        matrix[i, j] -= factor * spring[i]
        matrix[j, i] -= factor * spring[i]
    root = 1.0 / np.sqrt(mass)
    squares = np.linalg.eigvalsh(root[:, None] * matrix * root)
    rounding = 10.0 * count * np.finfo(float).eps * squares[-1]
    return np.asarray(np.sqrt(np.where(squares > rounding, squares, 0.0)) / (2.0 * np.pi))
