"""A force-driven chain: no driver, a measured force on bead 1. Model (3) of Zhang et al. 2016."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..execution.stop import Stop
from ..integrate import Counts
from ..integrate.chain_in_pieces import ChainInPieces
from ..integrate.scaling import scale_chain
from ..kernels.effects.given_force import Sampled
from ..scene import Scene
from ..scene.hertz import OVERLAP_POWER
from .record import ForceRecord


class ForceDrivenChain(ChainInPieces):
    """The chain of a scene without its driver; the force of a record acts on bead 1."""

    def __init__(self, scene: Scene, record: ForceRecord, stop: Stop, counts: Counts | None = None) -> None:
        driven = scale_chain(scene)
        scales = driven.scales
        scaled = replace(driven, slots=driven.slots._replace(driver=Sampled(np.zeros(4))))
        pieces = scales.scaled_forces(record.cubics()) / scales.phi ** np.arange(4)
        overlap = scales.scaled_forces(float(np.abs(record.force).max())) ** OVERLAP_POWER
        super().__init__(scaled, record.time, pieces, overlap, stop, counts)

    def driven_by(self, record: ForceRecord) -> ForceDrivenChain:
        """The chain driven by another record; both count their steps together."""
        return ForceDrivenChain(self.scaled.scene, record, self._stop, self.counts)
