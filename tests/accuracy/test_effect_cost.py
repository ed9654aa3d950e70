"""The cost of an effect per step: kernels with and without it are timed alternately."""

from __future__ import annotations

import pytest

from granchain_core import Cancelled, scene
from granchain_core.accuracy import effect_cost as module
from granchain_core.accuracy.effect_cost import CODE, Variant, effect_cost
from granchain_core.execution.stop import Stop
from granchain_core.precompile.pieces import ACCURACY_KERNELS, COST_KERNELS
from granchain_core.precompile.warm import compile_piece, is_warm

pytestmark = pytest.mark.quick

CHAIN = scene("sec2")


class Clocked:
    """A chain whose steps take a known time: 90 ns with the dashpot and 60 ns without, and more on a busy machine.

    In every third run, another process uses half of the processor, and every second chain is badly placed in memory.
    """

    made = 0

    def __init__(self, variant: Variant, method: str, stop: Stop) -> None:
        Clocked.made += 1
        self.own = 60.0 if variant.scene.dissipation == "none" else 90.0
        self.own += 12.0 if (Clocked.made - 1) // 2 % 2 else 0.0
        self.runs = 0

    def nanoseconds_per_step(self) -> float:
        """Return the time of one run."""
        self.runs += 1
        return self.own * (2.0 if self.runs % 3 == 0 else 1.0)


def test_an_effect_costs_the_difference_whatever_the_machine_does_meanwhile(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "_Stepper", Clocked)
    found = effect_cost(Variant(CHAIN), Variant(CHAIN.evolve(dissipation="none")))
    assert (found.with_it, found.without) == (90.0, 60.0)
    assert (found.difference, found.spread, found.percent) == (30.0, 0.0, 50.0)


def test_the_timed_steps_are_the_steps_taken() -> None:
    """With real kernels, a step takes a positive time, without an upper limit, and the numbers are consistent."""
    found = effect_cost(Variant(CHAIN), Variant(CHAIN.evolve(dissipation="none")), CODE)
    assert min(found.with_it, found.without) > 0.0
    assert found.percent == pytest.approx(100.0 * found.difference / found.without)


def test_timing_stops_at_once_and_pauses() -> None:
    stop, held = Stop(), []

    def pause() -> None:
        held.append(1)
        if len(held) == 3:
            stop.set()

    with pytest.raises(Cancelled):
        effect_cost(Variant(CHAIN), Variant(CHAIN), CODE, stop, pause)
    assert len(held) == 3


@pytest.mark.parametrize("piece", [ACCURACY_KERNELS, COST_KERNELS])
def test_a_compiled_piece_is_known_as_that(piece: str) -> None:
    compile_piece(CHAIN, piece)
    assert is_warm(CHAIN, (piece,))
