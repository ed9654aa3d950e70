"""The energy residual of the picture, found by computing its motion again with work and loss."""

from __future__ import annotations

from dataclasses import replace

from granchain_core import Settled
from granchain_core.execution.stop import Stop
from granchain_core.integrate import Engine, dop853_setting
from granchain_core.results.run import residual

#: Tolerance per step as a fraction of the accuracy asked for, small enough that the residual is not the account's own
#: error.
_TOLERANCE_FRACTION = 0.01


def with_account(settled: Settled, stop: Stop) -> Settled:
    """Return the picture with its energy residual over the periods shown. Raises `Cancelled`."""
    run = settled.run
    setting = dop853_setting(max(1e-13, _TOLERANCE_FRACTION * run.scene.accuracy))
    engine = Engine(run.scene, setting, 1, account=True, stop=stop)
    engine.start(settled.state)
    samples = engine.record(max(1, round((len(run.time) - 1) / run.samples)))
    return replace(settled, run=replace(run, energy_residual=residual(samples.energy, engine.scaled.static_energy)))
