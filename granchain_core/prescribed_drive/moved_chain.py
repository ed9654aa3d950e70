"""A chain whose driver follows a signal."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..execution.stop import Stop
from ..integrate import Counts
from ..integrate.chain_in_pieces import ChainInPieces
from ..integrate.scaling import scale_chain
from ..kernels.effects.driver import PrescribedMotion
from ..scene import Scene
from .signal import Signal


class MovedChain(ChainInPieces):
    """A scene's chain whose driver follows a signal, with the energy account."""

    def __init__(self, scene: Scene, signal: Signal, stop: Stop, counts: Counts | None = None) -> None:
        driven = scale_chain(scene, account=True)
        scaled = replace(driven, slots=driven.slots._replace(driver=PrescribedMotion(np.zeros(3))))
        pieces = driven.scales.scaled_displacements(signal.quadratics()) / driven.scales.phi ** np.arange(3)
        overlap = driven.scales.scaled_displacements(float(np.ptp(signal.displacement)))
        super().__init__(scaled, signal.time, pieces, overlap, stop, counts)

    def moved_by(self, signal: Signal) -> MovedChain:
        """The chain with another signal; both count their steps together."""
        return MovedChain(self.scaled.scene, signal, self._stop, self.counts)
