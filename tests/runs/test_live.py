"""The live chain, which continues while its knobs are moved: the forces of one stretch, and how a stop ends it."""

from __future__ import annotations

import threading

import numpy as np
import pytest

from granchain_core import LiveChain, State, scene
from granchain_core.errors import Cancelled
from granchain_core.execution.stop import Stop


@pytest.mark.parametrize("beads", [3, 40])
def test_largest_forces_are_those_of_the_stretch(beads: int) -> None:
    """The last bead is thrown at the wall. The first period has an impact of newtons, later ones only the force that
    the driver transmits.
    """
    hit = State(np.zeros(beads), np.append(np.zeros(beads - 1), 1.0))
    live = LiveChain(scene("sec2").evolve(N=beads), samples=256, start=hit)
    first = live.advance(256)
    for _ in range(3):
        later = live.advance(256)
    assert first.max_output_force > 10.0 * later.output_force.max()
    # a smooth maximum lies between rows, at most (spacing/2)²/2 times its curvature above them
    assert later.max_output_force == pytest.approx(later.output_force.max(), rel=0.02)
    assert later.max_output_force >= later.output_force.max()
    assert later.max_input_force == pytest.approx(later.input_force.max(), rel=0.02)


def test_a_stop_ends_a_stretch() -> None:
    """A stop ends a stretch that would otherwise take hours."""
    stop, ended = Stop(), list[bool]()
    live = LiveChain(scene("sec2").evolve(f=0.1), samples=2, stop=stop)

    def advance() -> None:
        with pytest.raises(Cancelled):
            live.advance(20_000)
        ended.append(True)

    work = threading.Thread(target=advance, daemon=True)
    work.start()
    stop.set()
    work.join(60.0)
    assert ended == [True]
