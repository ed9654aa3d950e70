"""The energy account of the picture on the screen: the same motion once more, with work and loss integrated along."""

from __future__ import annotations

from dataclasses import replace

from granchain_core import Settled
from granchain_core.integrate import Engine, certified
from granchain_core.result import residual

from ..serve.queues import Stop

_FINENESS = 0.01
"""The account's tolerance per step over the accuracy asked for: the residual must not be the account's own error."""


def with_account(picture: Settled, stop: Stop) -> Settled:
    """The picture with how far its energy is from closing over the periods shown. Raises `Cancelled`."""
    run = picture.run
    setting = certified(max(1e-13, _FINENESS * run.scene.accuracy))
    engine = Engine(run.scene, setting, 1, balance=True, stop=stop)
    engine.start(picture.state)
    samples = engine.record(max(1, round((len(run.time) - 1) / run.samples)))
    return replace(picture, run=replace(run, energy_residual=residual(samples.energy)))
