"""The pictures in words: what becomes of the energy is said of a driven chain that loses some, and of no other."""

from __future__ import annotations

from app.pages.numbers.words import summary
from granchain_core import scene, settle


def test_where_the_energy_goes_is_said_of_a_driven_damped_chain_alone() -> None:
    lost = "On average, the damping of the contacts takes all the energy"
    assert lost in summary(settle(scene("sec2")).run)
    assert lost not in summary(settle(scene("impact")).run)
