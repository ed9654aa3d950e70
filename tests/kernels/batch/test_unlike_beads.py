"""Batches of unequal beads move as with dop853."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from granchain_core import Scene, scene
from granchain_core.execution.stop import Stop
from granchain_core.integrate import Engine, MethodSetting
from granchain_core.integrate.batch import NEVER, Batch
from granchain_core.integrate.scaling import scale_chain
from granchain_core.scene.state import rest

PERIODS = 3


def dimer(f: float) -> Scene:
    """Return five beads at a rigid wall: steel beads alternating with light, stiff ones."""
    base = scene("sec2").evolve(N=5, f=f, wall="rigid")
    steel = base.bead(1)
    return replace(base, pattern=(steel, replace(steel, mass=0.4 * steel.mass, young=2.0 * steel.young)))


def test_unlike_beads_move_in_a_batch_as_alone() -> None:
    """The strobes of three periods from rest agree with dop853 to 1e-6 at a twelfth of the default step, where a batch
    of order 3 reaches about 2e-7.
    """
    scenes = [dimer(f) for f in (400.0, 900.0, 1500.0)]
    batch = Batch(scenes[0], Stop())
    assert batch.members.unequal is not None
    for member, one in enumerate(scenes):
        batch.put(member, scale_chain(one), scale_chain(one).from_si(rest(one)), 12.0, return_at=PERIODS, earliest=NEVER)
    for _ in scenes:
        member, finite = batch.run()
        assert finite
        true = Engine(scenes[member], MethodSetting("dop853", tolerance=1e-11), 1).periods(PERIODS, watch=False)[0][:, 0]
        found = batch.strobes(member)[: PERIODS + 1, 0]
        assert np.abs(found - true).max() < 1e-6 * np.abs(true).max()
        batch.state.schedule.return_at[member] = NEVER
