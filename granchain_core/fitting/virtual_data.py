"""Curves and series of a model with known parameters and normal noise, marked as virtual, for testing fits.

granchain_core/virtual_experiment also simulates sensors and writes files.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..experiment import Measured, Series
from ..experiment.measured import VIRTUAL
from ..scene import Scene
from ..steady.curve.resonance_curve import resonance_curve
from ..steady.settling.settle import settle
from .trains import Train

#: Samples of the model per sample of a series.
_FINER = 16


def virtual_curve(scene: Scene, frequencies: Sequence[float] | np.ndarray, error: float,
                  random: np.random.Generator) -> Measured:
    """Compute the model's curve and add normal noise, a fraction `error` of each force."""
    curve = resonance_curve(scene, frequencies)
    exact = curve.column("max_output_force")
    force = np.maximum(exact * (1.0 + error * random.standard_normal(len(exact))), 1e-12)
    return Measured(curve.column("frequency"), force, error * exact,
                    f"virtual: {scene.name} with noise of {100 * error:g} %", note=VIRTUAL,
                    units={"frequency": "Hz", "force": "N"})


def virtual_series(scene: Scene, periods: int, samples: int, error: float, random: np.random.Generator) -> Series:
    """Compute the model's forces over `periods` drive periods from a random phase; add normal noise of `error` [N]."""
    motion = settle(scene, samples=_FINER * samples).run
    time = np.arange(periods * samples) / (samples * scene.f)
    begun, width = random.random() * float(motion.time[-1] - motion.time[0]), 1.0 / (samples * scene.f)
    forces = [Train.of(motion, name).mean_over(time + begun, width) + error * random.standard_normal(len(time))
              for name in ("input_force", "output_force")]
    return Series(time, None, forces[0], forces[1], f"virtual: {scene.name} with noise of {error:g} N", note=VIRTUAL)
