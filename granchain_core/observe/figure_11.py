"""Figure 11 of Zhang et al. 2016: multipliers of the coupled system (4), and the first bead of both chains over time.

Without foundation, (a) one multiplier lies outside the unit circle, (b) the chain's orbit is stable and (c) the
observer leaves it; with κ = 0.001, (d) all lie inside and (e, f) both beads move alike. The text does not name the
drive frequency: both 100 and 200 Hz show it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..scene import scene
from ..stop import Stop
from .twin import Twin, twin

#: First distance of the observer, in drive amplitudes: small enough for many periods of linear growth.
PERTURBATION = 1e-6


@dataclass(frozen=True, eq=False)
class Figure11:
    """One row of the figure, at one frequency [Hz] and κ."""

    frequency: float
    kappa: float
    twin: Twin

    @property
    def multipliers(self) -> np.ndarray:
        """Panel (a) or (d): the chain's and the observer's multipliers."""
        found = self.twin.multipliers
        assert found is not None  # the figure's orbits are periodic
        return found

    @property
    def outside(self) -> np.ndarray:
        """Those of them outside the unit circle."""
        return self.multipliers[np.abs(self.multipliers) > 1.0]

    @property
    def first_beads(self) -> tuple[np.ndarray, np.ndarray]:
        """Panels (b), (c) or (e), (f): displacement of bead 1 of chain and observer over `twin.time` [m]."""
        return self.twin.chain[:, 0], self.twin.observer[:, 0]


def figure_11(frequencies: tuple[float, ...] = (100.0, 200.0), periods: int = 40, perturbation: float = PERTURBATION,
              stop: Stop | None = None) -> tuple[Figure11, ...]:
    """The figure's two rows (κ = 0, then 0.001) at every frequency."""
    found = []
    for frequency in frequencies:
        for name in ("fig11-free", "fig11-founded"):
            shown = scene(name).evolve(f=frequency)
            found.append(Figure11(frequency, shown.kappa, twin(shown, perturbation, periods, stop=stop)))
    return tuple(found)
