"""The energy residual of the picture, found by computing its motion again with work and loss."""

from __future__ import annotations

from dataclasses import replace

from granchain_core import Scene, Settled
from granchain_core.execution.stop import Stop
from granchain_core.integrate import Engine, MethodSetting, following_setting, method_for
from granchain_core.precompile.pieces import RUN_DOP853_KERNELS, RUN_KERNELS
from granchain_core.results.run import residual

#: Accuracy of the account as a fraction of the requested one, small enough that the residual is not the account's own
#: error.
_ACCURACY_FRACTION = 0.01


def _setting(scene: Scene) -> MethodSetting:
    return method_for(max(1e-13, _ACCURACY_FRACTION * scene.accuracy), scene.cuts_tension)


def account_piece(scene: Scene) -> str:
    """Return the piece of kernels that the account of a scene needs."""
    usual = following_setting(scene.cuts_tension).method
    return RUN_KERNELS if _setting(scene).method == usual else RUN_DOP853_KERNELS


def with_account(settled: Settled, stop: Stop) -> Settled:
    """Return the picture with its energy residual over the periods shown. Raises `Cancelled`."""
    run = settled.run
    engine = Engine(run.scene, _setting(run.scene), 1, account=True, stop=stop)
    engine.start(settled.state)
    samples = engine.record(max(1, round((len(run.time) - 1) / run.samples)))
    return replace(settled, run=replace(run, energy_residual=residual(samples.energy, engine.scaled.static_energy)))
