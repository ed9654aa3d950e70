"""What an effect costs in a step: kernels with and without it, timed by turns."""

from __future__ import annotations

import pytest

from granchain_core import Cancelled, scene
from granchain_core.accuracy.compiled import COST_PIECE, METHODS_PIECE, compile_piece
from granchain_core.accuracy.effect_cost import CODE, Variant, effect_cost
from granchain_core.integrate.engine import new_stop
from granchain_core.warm import is_warm

CHAIN = scene("sec2")


def test_the_numbers_of_a_cost_fit_together() -> None:
    found = effect_cost(Variant(CHAIN), Variant(CHAIN.evolve(dissipation="none")), CODE)
    assert found.with_it > 0.0 and found.without > 0.0 and found.spread >= 0.0
    assert found.percent == pytest.approx(100.0 * found.difference / found.without)


def test_timing_stops_at_once_and_is_held_up() -> None:
    stop, held = new_stop(), []

    def pause() -> None:
        held.append(1)
        stop[0] = len(held) == 3

    with pytest.raises(Cancelled):
        effect_cost(Variant(CHAIN), Variant(CHAIN), CODE, stop, pause)
    assert len(held) == 3


@pytest.mark.parametrize("piece", [METHODS_PIECE, COST_PIECE])
def test_a_compiled_piece_is_known_as_that(piece: str) -> None:
    compile_piece(CHAIN, piece)
    assert is_warm(CHAIN, (piece,))
